// Common to all commands of both executables: options, exit codes, how progress and plans are shown.
#pragma once

#include "scene/model/plan.h"
#include "scene/model/scene.h"

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

/// Adds a verb with its options.
/// @param example  for --help: what follows the verb
/// @param action  runs when the verb is chosen; its result is the exit code
/// @param exit_code  receives it
CLI::App* add_verb(CLI::App& app, const std::string& name, const std::string& what, const std::string& example,
                   VerbOptions& options, std::function<int()> action, int& exit_code);

/// The verbs of --help under headings, in this order; the rest under "More".
void group_verbs(CLI::App& app, const std::vector<std::pair<std::string, std::vector<std::string>>>& groups);

/// The message for a misspelt command or option, with the nearest known one; empty when the fault is another.
[[nodiscard]] std::string misspelt(const CLI::App& app);

/// Parses and runs the chosen verb; a command that cannot be is one message on stderr and an exit code. Without any
/// argument it prints the help.
/// @param exit_code  the variable given to add_verb
/// @throws what the verb throws
[[nodiscard]] int run_command_line(CLI::App& app, int argc, char** argv, int& exit_code);

/// What a failure is to its user.
struct Failure {
  int exit_code;
  std::string message;  ///< a sentence; of an input's faults one each
};

/// Of the exception that is being handled.
[[nodiscard]] Failure failure_at_hand();

/// Runs a whole program, whatever happens in it: every exception, also of a thread, becomes a message on stderr and an
/// exit code, and so does text that standard output does not take. A file that may not grow is an error like a full
/// disk.
/// @returns the exit code
[[nodiscard]] int guarded(const std::function<int()>& program) noexcept;

/// A word quoted for a shell where it needs it.
[[nodiscard]] std::string shell_word(const std::string& word);

/// "  yes  part   reason (cost)" lines under a title.
[[nodiscard]] std::string plan_text(const std::string& title, const scene::Plan& plan);

}  // namespace touchstone::fast
