// `touchstone report`: one page over many result folders.
#pragma once

#include "fast/command/command.h"

#include <filesystem>
#include <vector>

namespace touchstone::compare {

struct ResultsOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path out = "out/report.html";
};

/// Writes the page. @returns exit code; @throws scene::InputError with every folder that cannot be read
int report_results(const ResultsOptions& options);

/// Adds the command; its variables must outlive Program::run.
fast::Command add_report_verb(fast::Command& program, ResultsOptions& options);

}  // namespace touchstone::compare
