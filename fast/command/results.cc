#include "fast/command/results.h"

#include "fast/command/progress_line.h"
#include "fast/step/state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace touchstone::fast {

std::vector<scene::Column> beam_columns(const std::vector<BeamRecord>& beams) {
  std::vector<scene::Column> columns;
  const auto add = [&](const std::string& name, const auto& get) {
    scene::Column& column = columns.emplace_back(scene::Column{name, {}});
    for (const BeamRecord& beam : beams) column.values.push_back(get(beam));
  };
  const auto add_vector = [&](const std::string& name, const char* unit, const auto& get) {
    for (int axis = 0; axis < 3; ++axis) {
      add(name + "_" + "xyz"[axis] + unit, [&](const BeamRecord& beam) -> double { return get(beam)[axis]; });
    }
  };
  add("time_s", [](const BeamRecord& beam) { return beam.time_s; });
  add("region", [](const BeamRecord& beam) { return static_cast<double>(beam.region_id); });
  add("anchor", [](const BeamRecord& beam) { return static_cast<double>(beam.anchor); });
  add_vector("anchor", "_m", [](const BeamRecord& beam) { return beam.anchor_m; });
  add_vector("displacement", "_m", [](const BeamRecord& beam) { return beam.displacement_m; });
  add_vector("force", "_n", [](const BeamRecord& beam) { return beam.force_n; });
  add_vector("beam_x", "", [](const BeamRecord& beam) -> scene::Vec3 { return beam.end.axes.col(0); });
  add_vector("beam_y", "", [](const BeamRecord& beam) -> scene::Vec3 { return beam.end.axes.col(1); });
  constexpr std::array stresses{"sigma_x_pa", "sigma_y_pa", "sigma_z_pa", "tau_xy_pa", "tau_yz_pa", "tau_zx_pa"};
  constexpr std::array strains{"epsilon_x", "epsilon_y", "epsilon_z", "gamma_xy", "gamma_yz", "gamma_zx"};
  for (std::size_t c = 0; c < stresses.size(); ++c) {
    add(stresses[c], [c](const BeamRecord& beam) { return beam.end.stress_pa[c]; });
  }
  for (std::size_t c = 0; c < strains.size(); ++c) {
    add(strains[c], [c](const BeamRecord& beam) { return beam.end.strain[c]; });
  }
  return columns;
}

scene::Figures figures(const Run& run) {
  scene::Figures out;
  add_figures("fast.step_us", run.step, out);
  const scene::Figures rest = {
      {"fast.force_us.p50", run.force.p50_us, "", "us"},
      {"fast.force_us.p99", run.force.p99_us, "", "us"},
      {"fast.setup_s", run.setup_s, "", "s"},
      {"fast.memory_bytes", static_cast<double>(run.memory_bytes), "", "byte"},
      {"fast.triangles", static_cast<double>(run.surface.triangle_count()), "", ""},
      {"fast.regions_max", static_cast<double>(run.regions_max), "", ""},
      {"fast.status", 0.0, status_text(run.status), ""},
  };
  out.insert(out.end(), rest.begin(), rest.end());
  if (run.first_contact_s) out.push_back({"fast.first_contact_s", *run.first_contact_s, "", "s"});
  if (run.order_spread_rel) out.push_back({"fast.order_spread_rel", *run.order_spread_rel, "", ""});
  if (run.equilibrium_rel) out.push_back({"fast.equilibrium_rel", *run.equilibrium_rel, "", ""});
  return out;
}

Run run_into_folder(const scene::Scene& scene, const std::filesystem::path& folder, scene::Manifest manifest,
                    bool quiet) {
  const scene::Stopwatch watch;
  ProgressLine progress(quiet);
  Run result = run(scene, [&](double fraction) {
    progress.show(fmt::format("fast: {:3.0f} % of the track", 100.0 * fraction), fraction == 1.0);
  });
  progress.finish();
  manifest.times.push_back(watch.read("fast"));
  std::vector<scene::Column> columns = scene::track_columns(result.instants);
  for (scene::Column& c : scene::record_columns(result.instants, "")) columns.push_back(std::move(c));
  scene::write_csv(folder / "curve.csv", columns);
  if (scene.fast.formulation != scene::Formulation::response)
    scene::write_csv(folder / "beams.csv", beam_columns(result.beams));
  scene::write_summary(folder / "summary.json", figures(result));
  scene::write_manifest(folder / "manifest.json", manifest);
  return result;
}

std::string summary_text(const Run& run) {
  const auto deepest = std::max_element(run.instants.begin(), run.instants.end(),
                                        [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  return fmt::format(
      "Force at the deepest recorded instant ({:.3g} mm): {:.4g} N\n"
      "Step time over {} ticks: median {:.3g} us, 99 % below {:.3g} us, 99.9 % below {:.3g} us, longest {:.3g} us\n"
      "Status: {}\n",
      1e3 * deepest->depth_m, deepest->force_n().norm(), run.ticks, run.step.p50_us, run.step.p99_us, run.step.p999_us,
      run.step.max_us, status_text(run.status));
}

}  // namespace touchstone::fast
