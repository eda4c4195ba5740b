#include "compare/app/export_verb.h"

#include "compare/calculix/calculix.h"
#include "compare/calculix/time_to_error.h"
#include "compare/solve/reference_run.h"
#include "reference/calculix/deck.h"
#include "scene/output/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>

namespace touchstone::compare {
namespace {

/// Results of both codes at the instants that CalculiX reached, as a text table and as columns.
struct SideBySide {
  std::string text;
  std::vector<scene::Column> columns;
};

SideBySide side_by_side(const reference::Deck& deck, const CalculixRun& run, const reference::Result& result) {
  SideBySide both;
  both.text = fmt::format("{:>10} {:>12} {:>12} {:>12} {:>10} {:>10}\n", "depth [mm]", "ours [N]", "+- [N]",
                          "CalculiX [N]", "force", "surface");
  both.columns = {
      {"time_s", {}},           {"depth_m", {}},          {"force_n", {}},           {"force_uncertainty_n", {}},
      {"calculix_force_n", {}}, {"force_difference", {}}, {"surface_difference", {}}};
  for (std::size_t step = 0; step < run.steps.size(); ++step) {
    const int instant = deck.instants[step];
    const scene::InstantRecord& ours = result.instants[instant];
    const double ours_n = ours.force_n().norm(), theirs_n = run.steps[step].force_n.norm();
    const double force = theirs_n / ours_n - 1.0;
    const double surface =
        longest_m(run.steps[step].displacement_m - ours.displacement_m) / longest_m(ours.displacement_m);
    const double uncertainty_n = result.instants[instant].force_uncertainty_n;
    const double row[] = {ours.time_s, ours.depth_m, ours_n, uncertainty_n, theirs_n, force, surface};
    for (std::size_t k = 0; k < both.columns.size(); ++k) both.columns[k].values.push_back(row[k]);
    const std::string band = std::isfinite(uncertainty_n) ? fmt::format("{:.2g}", uncertainty_n) : "unknown";
    both.text += fmt::format("{:10.4g} {:12.5g} {:>12} {:12.5g} {:9.3f}% {:9.3f}%\n", 1e3 * ours.depth_m, ours_n, band,
                             theirs_n, 100.0 * force, 100.0 * surface);
  }
  return both;
}

}  // namespace

int export_deck(const fast::VerbOptions& options, const ExportOptions& export_options,
                const ReferenceOptions& reference) {
  const scene::Scene scene = options.load();
  std::vector<scene::Fault> faults = reference::unsupported_in_deck(scene);
  if (export_options.run || export_options.time_to_error > 0) {
    const std::vector<scene::Fault> more = reference::unsupported(scene);
    faults.insert(faults.end(), more.begin(), more.end());
  }
  if (!faults.empty()) throw scene::InputError(std::move(faults));
  const std::filesystem::path folder = options.folder(scene, "export");
  const scene::FolderLock lock = scene::prepare_result_folder(folder);
  if (export_options.time_to_error > 0) {
    const TimeToError times = time_to_error(scene, export_options.time_to_error, folder);
    scene::write_csv(folder / "time-to-error.csv", time_to_error_columns(times));
    scene::write_file(folder / "time-to-error.svg", time_to_error_svg(times, scene.title));
    std::cout << time_to_error_text(times);
    return fast::done;
  }
  const reference::Deck deck = reference::calculix_deck(
      scene,
      {.level = export_options.mesh - 1, .contact_stiffness_pa_per_m = export_options.contact_stiffness_pa_per_m});
  const std::filesystem::path file = folder / (scene.name + ".inp");
  scene::write_file(file, deck.text);
  std::cout << fmt::format("Deck: {}, {} steps, {} nodes of the body in {}\n", deck.model, deck.instants.size(),
                           deck.nodes, file.string());
  if (!export_options.run) {
    std::cout << fmt::format("Run it in that folder with: ccx -i {}\n", scene.name);
    return fast::done;
  }
  const CalculixRun run = run_calculix(folder, scene.name, deck);
  const bool complete = run.steps.size() == deck.instants.size();
  if (!complete) {
    std::cerr << fmt::format(
        "CalculiX ended after {} of {} steps; see {}. Smaller steps or a smaller "
        "--contact-stiffness may help\n",
        run.steps.size(), deck.instants.size(), (folder / (scene.name + ".log")).string());
    if (run.steps.empty()) return fast::not_converged;
  }
  const scene::Stopwatch watch;
  scene::Surface surface;
  surface.points_m = deck.surface_points_m;
  const reference::Result result = solve_with_progress(asked(scene, reference), surface, reference, options.quiet);
  const scene::StageTime time = watch.read("reference");
  const SideBySide both = side_by_side(deck, run, result);
  scene::write_csv(folder / "curve.csv", both.columns);
  std::cout << both.text
            << fmt::format("Ours: {}, {} unknowns on the finest mesh, {:.1f} s, CPU {:.1f} s{}\n", result.model,
                           result.levels.back().unknowns, time.wall_s, time.cpu_s,
                           result.from_store ? " (from the store)" : "")
            << fmt::format("CalculiX: {:.1f} s, CPU {:.1f} s\n", run.wall_s, run.cpu_s);
  return complete ? fast::done : fast::not_converged;
}

void add_export_verb(fast::Command& program, fast::VerbOptions& options, ExportOptions& export_options,
                     ReferenceOptions& reference) {
  fast::Command verb = fast::add_verb_with_folder(
      program, "export", "write the scene as an input deck for CalculiX, an independent finite element code",
      "meshes/scenes/ball-on-cube-press.toml --mesh 2 --run", options,
      [&options, &export_options, &reference] { return export_deck(options, export_options, reference); });
  verb.option("--mesh", export_options.mesh, "which of the reference's meshes; 1 is the coarsest")
      .range(1, 6)
      .shows_default();
  verb.option("--contact-stiffness", export_options.contact_stiffness_pa_per_m,
              "contact pressure per penetration [Pa/m] (default: changes the force by about 0.1 %)")
      .positive();
  verb.option("--time-to-error", export_options.time_to_error,
              "instead of one deck: solve this many meshes with both codes and print CPU time over force error")
      .range(2, 4);
  verb.flag("--run", export_options.run, "run CalculiX on it, solve the reference, and print both side by side");
  add_store_option(verb, reference);
}

}  // namespace touchstone::compare
