// What every verb of both executables shares: options, exit codes, how progress and plans are shown.
#pragma once

#include "scene/plan.h"
#include "scene/scene.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace touchstone::fast {

enum ExitCode { done = 0, answer_is_no = 1, bad_input = 2, not_converged = 3, interrupted = 130 };

/// Options of a verb that takes one scene and leaves one result folder.
struct VerbOptions {
  std::filesystem::path scene_file;
  std::filesystem::path out;  ///< empty: out/<scene>-<verb>
  std::vector<std::string> overrides;
  bool quiet = false;

  [[nodiscard]] std::filesystem::path folder(const scene::Scene& scene, const std::string& verb) const;
  /// Warns on stderr of a track on which the tool never touches the body. @throws scene::InputError
  [[nodiscard]] scene::Scene load() const;
};

/// Adds a verb with its options and an example for --help.
/// @param action  runs when the verb is chosen; its result is the exit code
/// @param exit_code  receives it
CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& what, VerbOptions& options,
                   std::function<int()> action, int& exit_code);

/// Parses and runs the chosen verb; turns every error into one message on stderr and an exit code.
/// @param exit_code  the variable given to add_verb
[[nodiscard]] int run_command_line(CLI::App& app, int argc, char** argv, int& exit_code);

/// "  yes  part   reason (cost)" lines under a title.
[[nodiscard]] std::string plan_text(const std::string& title, const scene::Plan& plan);

}  // namespace touchstone::fast
