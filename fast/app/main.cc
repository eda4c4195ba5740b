// touchstone-fast: the real-time side alone, for the machine with the device. Links neither deal.II, VTK nor MPI.
#include "fast/app/completion.h"
#include "fast/app/new_verb.h"
#include "fast/bench/bench_verb.h"
#include "fast/command/command_line.h"
#include "fast/command/results.h"
#include "fast/live/live_verb.h"
#include "scene/input/scene_io.h"

#include <iostream>

using namespace touchstone;

namespace {

int plan(const fast::VerbOptions& options) {
  const scene::Scene scene = options.load();
  std::cout << scene::explained_toml(scene) << '\n' << fast::plan_text("The fast model computes", fast::plan(scene));
  return fast::done;
}

int run(const fast::VerbOptions& options) {
  const scene::Scene scene = options.load();
  const std::filesystem::path folder = options.folder(scene, "fast");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  const fast::Run run =
      fast::run_into_folder(scene, folder, scene::make_manifest(scene, "touchstone-fast fast"), options.quiet);
  std::cout << fast::summary_text(run) << "Results: " << folder.string() << '\n';
  return fast::done;
}

int run_program(int argc, char** argv) {
  fast::Program program("Real-time contact of a rigid tool with an elastic body.", "touchstone-fast");
  fast::VerbOptions options;
  live::LiveOptions live_options;
  bench::BenchVerbOptions bench_options;
  fast::NewOptions new_options;
  std::string shell;
  fast::add_new_verb(program, new_options);
  fast::add_verb(program, "plan", "show what the fast model computes for a scene, what it leaves out and why",
                 "meshes/scenes/ball-on-cube-press.toml --set fast.formulation=published", options,
                 [&] { return plan(options); });
  fast::add_verb_with_folder(program, "fast", "run the real-time model over the scene's track, in virtual time",
                             "meshes/scenes/ball-on-cube-press.toml --out out/press", options,
                             [&] { return run(options); });
  live::add_live_verb(program, options, live_options);
  bench::add_bench_verb(program, bench_options);
  fast::add_completion_verb(program, shell);
  program.footer("touchstone-fast COMMAND --help: options and an example");
  return program.run(argc, argv);
}

}  // namespace

int main(int argc, char** argv) {
  return fast::guarded([&] { return run_program(argc, argv); });
}
