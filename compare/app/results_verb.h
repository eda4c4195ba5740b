// `touchstone report`: one page over many result folders.
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <vector>

namespace touchstone::compare {

struct ResultsOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path out = "out/report.html";
};

/// Writes the page. @returns exit code; @throws scene::InputError with every folder that cannot be read
int report_results(const ResultsOptions& options);

/// Adds the verb to the command line. @param options, exit_code  as for the other verbs
CLI::App* add_report_verb(CLI::App& app, ResultsOptions& options, int& exit_code);

}  // namespace touchstone::compare
