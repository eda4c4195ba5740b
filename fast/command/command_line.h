// Common to all commands of both executables: options, exit codes, how failures and plans are shown.
#pragma once

#include "fast/command/command.h"
#include "fast/command/exit_code.h"
#include "scene/model/plan.h"
#include "scene/model/scene.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace touchstone::fast {

/// Options of a command that takes one scene and writes one result folder.
struct VerbOptions {
  std::filesystem::path scene_file;
  std::filesystem::path out;  ///< empty: `out/<scene>-<verb>`
  std::vector<std::string> overrides;
  bool quiet = false;
  /// Computes what a scene's formulation reads, in a program that can; empty in others.
  std::function<void(scene::Scene&)> prepare = {};

  [[nodiscard]] std::filesystem::path folder(const scene::Scene& scene, const std::string& verb) const;
  /// Warns on stderr of a track on which the tool never touches the body. @throws scene::InputError
  [[nodiscard]] scene::Scene load() const;
};

/// Adds a command with these options.
/// @param example  for --help: what follows the command
/// @param action  runs when the command is chosen; its result is the exit code
Command add_verb(Command& program, const std::string& name, const std::string& what, const std::string& example,
                 VerbOptions& options, std::function<int()> action);

/// The same for a command that writes a result folder: with --out.
Command add_verb_with_folder(Command& program, const std::string& name, const std::string& what,
                             const std::string& example, VerbOptions& options, std::function<int()> action);

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
