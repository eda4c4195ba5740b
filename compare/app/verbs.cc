#include "compare/app/verbs.h"

#include "compare/comparison/compare.h"
#include "compare/input/tuning_study.h"
#include "compare/model/registry.h"
#include "compare/report/fast_report.h"
#include "compare/report/inside_files.h"
#include "compare/report/plot_files.h"
#include "compare/report/vtk_out.h"
#include "compare/solve/reference_run.h"
#include "fast/command/progress_line.h"
#include "fast/command/results.h"
#include "reference/run/inside.h"
#include "reference/solver.h"
#include "scene/input/scene_io.h"
#include "scene/output/results.h"

#include <iostream>

namespace touchstone::compare {
namespace {

int plan(const fast::VerbOptions& options, const ReferenceOptions& reference) {
  const scene::Scene scene = asked(options.load(), reference);
  std::cout << scene::explained_toml(scene) << '\n'
            << fast::plan_text("The fast model computes", fast::plan(scene)) << '\n';
  const std::vector<scene::Fault> faults = reference::unsupported(scene);
  if (faults.empty()) {
    std::cout << fast::plan_text("The reference solves", reference::plan(scene));
  } else {
    std::cout << "The reference cannot solve this scene:\n";
    for (const scene::Fault& fault : faults) std::cout << "  " << fault.text() << '\n';
  }
  return fast::done;
}

}  // namespace

int run_fast(const fast::VerbOptions& options, const ReferenceOptions& reference) {
  const scene::Scene scene = asked(options.load(), reference);
  const std::filesystem::path folder = options.folder(scene, "fast");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  scene::Manifest manifest = scene::make_manifest(scene, "touchstone fast");
  prepare_missing(scene, fast::progress_lines(options.quiet));
  const scene::Stopwatch watch;
  const fast::Run run = fast::run_into_folder(scene, folder, manifest, options.quiet);
  manifest.times.push_back(watch.read("fast"));
  write_fast_surfaces(folder, run);
  write_tool(folder, scene.tool, run.instants);
  write_fast_report(folder, scene, run, manifest);
  std::cout << fast::summary_text(run) << "Report: " << (folder / "report.html").string() << '\n';
  return fast::done;
}

int run_reference(const fast::VerbOptions& options, const ReferenceOptions& reference) {
  const scene::Scene scene = asked(options.load(), reference);
  refuse_unsupported(scene);
  const std::filesystem::path folder = options.folder(scene, "reference");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  const scene::Stopwatch watch;
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  const reference::Result result = solve_with_progress(scene, surface, reference, options.quiet);
  scene::Manifest manifest = scene::make_manifest(scene, "touchstone reference");
  manifest.times.push_back(watch.read("reference"));
  write_reference(folder, result, manifest);
  write_reference_surfaces(folder, surface, result);
  write_tool(folder, scene.tool, result.instants);
  const auto inside = reference::inside(scene, result, reference.store);
  const std::string files = write_inside(folder, scene, result, *inside, reference.volume);
  std::cout << reference_text(result) << files << "Results: " << folder.string() << '\n';
  return exit_of(result, reference);
}

int run_compare(const fast::VerbOptions& options, const ReferenceOptions& reference, const CompareOptions& more) {
  const std::filesystem::path& parameters = more.parameters;
  const scene::Scene given = asked(options.load(), reference);
  refuse_unsupported(given);
  const scene::Scene scene = parameters.empty() ? given : with_parameters(given, parameters);
  const Contenders judged =
      contenders(given, parameters.empty() ? std::vector<std::filesystem::path>{} : std::vector{parameters},
                 more.models, fast::progress_lines(options.quiet));
  const std::filesystem::path folder = options.folder(scene, "compare");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  const Call call{options.scene_file, options.overrides, reference, more, folder};
  scene::Manifest manifest = scene::make_manifest(scene, "touchstone compare");
  prepare_missing(scene, fast::progress_lines(options.quiet));
  const scene::Stopwatch fast_watch;
  const fast::Run run = fast_model(scene).set_up(scene)->track().value();
  manifest.times.push_back(fast_watch.read("fast"));
  const scene::Stopwatch reference_watch;
  const reference::Result result = solve_with_progress(given, run.surface, reference, options.quiet);
  if (!parameters.empty()) manifest.entries.emplace_back("parameters", parameters.string());
  manifest.times.push_back(reference_watch.read("reference"));
  manifest.entries.emplace_back("linear_solver", result.linear_solver);
  manifest.entries.emplace_back("reference_key", result.key);
  manifest.entries.emplace_back("command_line", command_text(call, ""));
  const auto inside = reference::inside(given, result, reference.store);
  const Comparison comparison = write_comparison(folder, scene, run, result, manifest, judged, call, inside.get());
  const std::string files = write_inside(folder, given, result, *inside, reference.volume);
  if (more.plots) {
    std::cout << "Plots: " << (folder / "plots").string() << " (SVG"
              << (has_pdf() ? " and PDF" : "; PDF needs a build with librsvg, Debian's librsvg2-dev") << ")\n";
  }
  std::cout << comparison.text << refinement_text(result) << files << "Report: " << (folder / "report.html").string()
            << '\n';
  return exit_of(result, reference);
}

void add_scene_verbs(fast::Command& program, fast::VerbOptions& options, ReferenceOptions& reference,
                     CompareOptions& more) {
  add_store_option(
      fast::add_verb(program, "plan", "show what each solver models of a scene, what it leaves out and why",
                     "meshes/scenes/ball-on-cube-press.toml --set fast.formulation=published", options,
                     [&] { return plan(options, reference); }),
      reference);
  add_store_option(
      fast::add_verb_with_folder(program, "fast", "run the real-time model over the scene's track, in virtual time",
                                 "meshes/scenes/ball-on-cube-press.toml --out out/press", options,
                                 [&] { return run_fast(options, reference); }),
      reference);
  add_result_options(
      fast::add_verb_with_folder(
          program, "reference", "solve offline; uses stored results, continues where it was interrupted",
          "meshes/scenes/hertz-sphere.toml --error 0.005", options, [&] { return run_reference(options, reference); }),
      reference);
  const fast::Command compared =
      fast::add_verb_with_folder(program, "compare", "run both solvers and report the errors in force and shape",
                                 "meshes/scenes/ball-on-cube-press.toml --set tool.radius_m=0.008 --error 0.02",
                                 options, [&] { return run_compare(options, reference, more); });
  add_compare_options(compared, more);
  add_result_options(compared, reference);
}

}  // namespace touchstone::compare
