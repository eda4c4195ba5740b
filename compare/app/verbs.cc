#include "compare/app/verbs.h"

#include "compare/comparison/compare.h"
#include "compare/input/tuning_study.h"
#include "compare/model/engine_model.h"
#include "compare/model/skeleton_model.h"
#include "compare/report/fast_report.h"
#include "compare/report/inside_files.h"
#include "compare/report/plot_files.h"
#include "compare/report/vtk_out.h"
#include "compare/solve/reference_run.h"
#include "fast/command/results.h"
#include "reference/run/inside.h"
#include "reference/solver.h"
#include "scene/input/scene_io.h"
#include "scene/output/results.h"

#include <iostream>

namespace touchstone::compare {
namespace {

void refuse(std::vector<scene::Fault> faults) {
  if (!faults.empty()) throw scene::InputError(std::move(faults));
}

/// Lines about what takes long, on stderr.
std::function<void(const std::string&)> saying(bool quiet) {
  return [quiet](const std::string& line) {
    if (!quiet) std::cerr << line << '\n';
  };
}

}  // namespace

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

int run_fast(const fast::VerbOptions& options, const ReferenceOptions& reference) {
  const scene::Scene scene = asked(options.load(), reference);
  const std::filesystem::path folder = options.folder(scene, "fast");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  scene::Manifest manifest = scene::make_manifest(scene, "touchstone fast");
  prepare_missing(scene, saying(options.quiet));
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
  refuse(reference::unsupported(scene));
  const std::filesystem::path folder = options.folder(scene, "reference");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  return with_reference_exits([&] {
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
  });
}

int run_compare(const fast::VerbOptions& options, const ReferenceOptions& reference, const CompareOptions& more) {
  const std::filesystem::path& parameters = more.parameters;
  const scene::Scene given = asked(options.load(), reference);
  refuse(reference::unsupported(given));
  const scene::Scene scene = parameters.empty() ? given : with_parameters(given, parameters);
  const Contenders judged =
      contenders(given, parameters.empty() ? std::vector<std::filesystem::path>{} : std::vector{parameters},
                 more.models, reference.store, saying(options.quiet));
  const std::filesystem::path folder = options.folder(scene, "compare");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  const Call call{options.scene_file, options.overrides, reference, parameters, folder, more.models};
  return with_reference_exits([&] {
    scene::Manifest manifest = scene::make_manifest(scene, "touchstone compare");
    prepare_missing(scene, saying(options.quiet));
    const scene::Stopwatch fast_watch;
    const fast::Run run = fast_model().set_up(scene)->track().value();
    manifest.times.push_back(fast_watch.read("fast"));
    const scene::Stopwatch reference_watch;
    const reference::Result result = solve_with_progress(given, run.surface, reference, options.quiet);
    if (!parameters.empty()) manifest.entries.emplace_back("parameters", parameters.string());
    manifest.times.push_back(reference_watch.read("reference"));
    manifest.entries.emplace_back("linear_solver", result.linear_solver);
    manifest.entries.emplace_back("reference_key", result.key);
    manifest.entries.emplace_back("command_line", command_text(call, ""));
    const auto inside = reference::inside(given, result, reference.store);
    const Comparison comparison =
        write_comparison(folder, scene, run, result, manifest, judged, call, more.plots, inside.get());
    const std::string files = write_inside(folder, given, result, *inside, reference.volume);
    if (more.plots) {
      std::cout << "Plots: " << (folder / "plots").string() << " (SVG"
                << (has_pdf() ? " and PDF" : "; PDF needs a build with librsvg, Debian's librsvg2-dev") << ")\n";
    }
    std::cout << comparison.text << refinement_text(result) << files << "Report: " << (folder / "report.html").string()
              << '\n';
    return exit_of(result, reference);
  });
}

}  // namespace touchstone::compare
