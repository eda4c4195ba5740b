#include "fast/results.h"

#include "fast/command_line.h"
#include "fast/state.h"

#include <algorithm>
#include <cstdio>

namespace touchstone::fast {

scene::Figures figures(const Run& run) {
  scene::Figures out = {
      {"fast.step_us.p50", run.step.p50_us, "", "us"},
      {"fast.step_us.p99", run.step.p99_us, "", "us"},
      {"fast.step_us.p999", run.step.p999_us, "", "us"},
      {"fast.step_us.max", run.step.max_us, "", "us"},
      {"fast.force_us.p50", run.force.p50_us, "", "us"},
      {"fast.force_us.p99", run.force.p99_us, "", "us"},
      {"fast.setup_s", run.setup_s, "", "s"},
      {"fast.memory_bytes", static_cast<double>(run.memory_bytes), "", "byte"},
      {"fast.triangles", static_cast<double>(run.surface.triangle_count()), "", ""},
      {"fast.regions_max", static_cast<double>(run.regions_max), "", ""},
      {"fast.status", 0.0, status_text(run.status), ""},
  };
  if (run.order_spread_rel) out.push_back({"fast.order_spread_rel", *run.order_spread_rel, "", ""});
  if (run.equilibrium_rel) out.push_back({"fast.equilibrium_rel", *run.equilibrium_rel, "", ""});
  return out;
}

Run run_into_folder(const scene::Scene& scene, const std::filesystem::path& folder, scene::Manifest manifest,
                    bool quiet) {
  const scene::Stopwatch watch;
  ProgressLine progress(quiet);
  Run result = run(scene, [&](double fraction) {
    char text[64];
    std::snprintf(text, sizeof text, "fast: %3.0f %% of the track", 100.0 * fraction);
    progress.show(text);
  });
  progress.finish();
  manifest.times.push_back(watch.read("fast"));
  std::vector<scene::Column> columns = scene::track_columns(result.instants);
  for (scene::Column& c : scene::record_columns(result.instants, "")) columns.push_back(std::move(c));
  scene::write_csv(folder / "curve.csv", columns);
  scene::write_summary(folder / "summary.json", figures(result));
  scene::write_manifest(folder / "manifest.json", manifest);
  return result;
}

std::string summary_text(const Run& run) {
  const auto deepest = std::max_element(run.instants.begin(), run.instants.end(),
                                        [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  char text[400];
  std::snprintf(text, sizeof text,
                "Force at the deepest recorded instant (%.3g mm): %.4g N\n"
                "Step time over %d ticks: median %.3g us, 99 %% below %.3g us, 99.9 %% below %.3g us, longest %.3g us\n"
                "Status: %s\n",
                1e3 * deepest->depth_m, deepest->force_n().norm(), run.ticks, run.step.p50_us, run.step.p99_us,
                run.step.p999_us, run.step.max_us, status_text(run.status).c_str());
  return text;
}

}  // namespace touchstone::fast
