// How a comparison is called: the options of `compare`, their help, and the command that repeats them.
#pragma once

#include "compare/solve/reference_options.h"

#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::compare {

/// A new option is a member here, a line in add_compare_options(), and one in command_text().
struct CompareOptions {
  std::filesystem::path
      parameters{};                   ///< that `tune` leaves, or empty; for the models, the reference keeps the scene's
  std::vector<std::string> models{};  ///< keys of further ones, for the table
  bool plots = false;                 ///< also every plot of the report as files
};

/// The options must outlive Program::run.
void add_compare_options(fast::Command command, CompareOptions& options);

/// For commands that can be typed again.
struct Call {
  std::filesystem::path scene_file{};
  std::vector<std::string> overrides{};  ///< of --set
  ReferenceOptions reference{};
  CompareOptions compare{};
  std::filesystem::path folder{};  ///< of the results
};

/// The command with its words quoted for a shell where they need it. @param options  more, with a space before
[[nodiscard]] std::string command_text(const Call& call, const std::string& options);

}  // namespace touchstone::compare
