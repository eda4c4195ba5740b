// The command line's options of a solve of the reference: what they are, their help, and the command that repeats them.
#pragma once

#include "fast/command/command.h"
#include "scene/model/scene.h"

#include <filesystem>
#include <optional>
#include <string>

namespace touchstone::compare {

/// Limit of one solve that refines until an error is reached.
constexpr double default_minutes = 60.0;

/// A new option is a member here, a line where it is added to the commands, and one in options_text().
struct ReferenceOptions {
  std::filesystem::path store = scene::FastSettings{}.store;  ///< stored results, shared by all runs
  std::optional<int> levels = {};                             ///< in place of the scene's levels or error
  std::optional<double> error = {};                           ///< in place of the scene's levels or error
  std::optional<double> memory_gib = {};                      ///< limit of one solve, as the next
  std::optional<double> minutes = {};  ///< absent: default_minutes, and no limit where a number of meshes is asked for
  bool volume = false;                 ///< also write the inside of the body
  std::optional<double> require_error = {};  ///< uncertainty of force and shape that the exit code depends on
};

/// The store alone; with the options of a solve; with those of a command that is about one solve. The variables must
/// outlive Program::run.
void add_store_option(fast::Command command, ReferenceOptions& options);
void add_solve_options(fast::Command command, ReferenceOptions& options);
void add_result_options(fast::Command command, ReferenceOptions& options);

/// The given options that affect the result, as typed: " --level 3 --minutes 20".
[[nodiscard]] std::string options_text(const ReferenceOptions& options);

/// The scene with the levels or the error that the command line asks for, and the store.
[[nodiscard]] scene::Scene asked(scene::Scene scene, const ReferenceOptions& options);

}  // namespace touchstone::compare
