#include "compare/solve/reference_options.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::compare {

void add_store_option(fast::Command command, ReferenceOptions& options) {
  command.option("--store", options.store, "folder of stored reference results, shared by all runs").shows_default();
}

void add_solve_options(fast::Command command, ReferenceOptions& options) {
  add_store_option(command, options);
  const fast::Option levels =
      command.option("--level", options.levels, "solve this number of meshes, in place of refining to an error")
          .range(1, 9);
  command
      .option("--error", options.error,
              "refine until the relative uncertainty of force and shape is at most this (default: the scene's)")
      .range(1e-4, 0.5)
      .excludes(levels);
  command
      .option("--memory-gib", options.memory_gib,
              "skip meshes that are estimated to need more memory (default 80 % of the machine's)")
      .range(0.1, 1e6);
  command
      .option("--minutes", options.minutes,
              "stop a solve after this time; finished steps are kept (default 60; no limit with --level)")
      .range(0.01, 1e6);
}

void add_result_options(fast::Command command, ReferenceOptions& options) {
  add_solve_options(command, options);
  command
      .option("--require-error", options.require_error,
              "exit 3 if the relative uncertainty of force or shape is larger; results are written anyway")
      .range(1e-4, 0.5);
  command.flag("--volume", options.volume,
               "also write stress, pressure, J - 1 and displacement inside the body: volume.pvd for ParaView");
}

std::string options_text(const ReferenceOptions& options) {
  std::string text;
  if (options.levels) text += fmt::format(" --level {}", *options.levels);
  if (options.error) text += fmt::format(" --error {}", *options.error);
  if (options.memory_gib) text += fmt::format(" --memory-gib {}", *options.memory_gib);
  if (options.minutes) text += fmt::format(" --minutes {}", *options.minutes);
  if (options.volume) text += " --volume";
  return text;
}

scene::Scene asked(scene::Scene scene, const ReferenceOptions& options) {
  scene.fast.store = options.store;
  if (options.levels) scene.reference.levels = options.levels;
  if (options.error) {
    scene.reference.error = *options.error;
    scene.reference.levels.reset();
  }
  if (options.require_error && !scene.reference.levels) {
    scene.reference.error = std::min(scene.reference.error, *options.require_error);
  }
  return scene;
}

}  // namespace touchstone::compare
