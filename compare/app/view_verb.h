// `touchstone view`: a window on a result folder, or a picture of it.
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>

namespace touchstone::compare {

struct ViewOptions {
  std::filesystem::path folder;
  std::filesystem::path screenshot;  ///< empty: a window
  int instant = 0;                   ///< from 1; 0: the deepest
  std::string colour, side;          ///< empty: the first there is
};

/// @returns exit code; @throws scene::InputError for a folder that is no result, and without a display
int view_result(const ViewOptions& options);

/// Adds the verb to the command line. @param options, exit_code  as for the other verbs
CLI::App* add_view_verb(CLI::App& app, ViewOptions& options, int& exit_code);

}  // namespace touchstone::compare
