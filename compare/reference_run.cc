#include "compare/reference_run.h"

#include "compare/reference_quality.h"
#include "fast/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <iostream>

namespace touchstone::compare {
namespace {

std::atomic<bool> stop_requested = false;

extern "C" void request_stop(int signal) {
  stop_requested = true;
  std::signal(signal, SIG_DFL);
}

/// Raises stop_requested on Ctrl-C or a batch system's SIGTERM, for as long as it lives.
class StopOnSignal {
 public:
  StopOnSignal() {
    stop_requested = false;
    old_interrupt_ = std::signal(SIGINT, request_stop);
    old_terminate_ = std::signal(SIGTERM, request_stop);
  }
  ~StopOnSignal() {
    std::signal(SIGINT, old_interrupt_);
    std::signal(SIGTERM, old_terminate_);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  void (*old_interrupt_)(int);
  void (*old_terminate_)(int);
};

std::string time_left_text(double seconds) {
  if (seconds < 0.0) return "";
  if (seconds < 90.0) return fmt::format(", {:.0f} s left on it", seconds);
  return fmt::format(", {:.0f} min left on it", seconds / 60.0);
}

std::string progress_text(const reference::Progress& p) {
  if (p.newton == 0 && !p.note.empty()) return "reference: " + p.note;
  const std::string mesh = p.levels > 0 ? fmt::format("{}/{}", p.level, p.levels) : std::to_string(p.level);
  std::string text = fmt::format("reference: mesh {} ({} unknowns), load step {}/{} at {:.2f} mm", mesh, p.unknowns,
                                 p.instant, p.instants, 1e3 * p.depth_m);
  if (p.newton > 0) text += fmt::format(", Newton {} residual {:.1e}", p.newton, p.residual_rel);
  text += time_left_text(p.seconds_left);
  if (!p.note.empty()) text += " - " + p.note;
  return text;
}

}  // namespace

scene::Scene asked(scene::Scene scene, const ReferenceOptions& options) {
  if (options.levels) scene.reference.levels = options.levels;
  if (options.error) {
    scene.reference.error = *options.error;
    scene.reference.levels.reset();
  }
  return scene;
}

reference::Result solve_with_progress(const scene::Scene& scene, const scene::Surface& surface,
                                      const ReferenceOptions& options, bool quiet) {
  constexpr double gibibyte = 1024.0 * 1024.0 * 1024.0;
  const StopOnSignal stop;
  fast::ProgressLine line(quiet);
  reference::Options solve_options;
  solve_options.store = options.store;
  solve_options.stop = &stop_requested;
  solve_options.rest_area_m2 = surface.vertex_area_m2;
  if (options.memory_gib) solve_options.memory_limit_bytes = *options.memory_gib * gibibyte;
  solve_options.seconds_limit = 60.0 * options.minutes;
  solve_options.progress = [&](const reference::Progress& p) {
    line.show(progress_text(p), p.step_finished || !p.note.empty());
  };
  return reference::solve(scene, surface.points_m, solve_options);
}

int with_reference_exits(const std::function<int()>& solve) {
  try {
    return solve();
  } catch (const reference::Interrupted& stopped) {
    std::cerr << "\n" << stopped.what() << '\n';
    return fast::interrupted;
  } catch (const reference::NotConverged& failure) {
    std::cerr << failure.what() << '\n';
    return fast::not_converged;
  }
}

void write_reference(const std::filesystem::path& folder, const reference::Result& result,
                     const scene::Manifest& manifest) {
  std::vector<scene::Column> columns = scene::track_columns(result.instants);
  for (scene::Column& c : scene::record_columns(result.instants, "")) columns.push_back(std::move(c));
  for (scene::Column& c : reference_quality_columns(result, "")) columns.push_back(std::move(c));
  scene::write_csv(folder / "curve.csv", columns);
  scene::write_summary(folder / "summary.json", reference_figures(result, reference_quality(result)));
  scene::write_manifest(folder / "manifest.json", manifest);
}

std::string reference_text(const reference::Result& result) {
  const auto deepest = std::max_element(result.instants.begin(), result.instants.end(),
                                        [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  const auto at = static_cast<std::size_t>(deepest - result.instants.begin());
  const double band_n = result.force_uncertainty_n[at];
  std::string text =
      fmt::format("Force at the deepest instant ({:.3g} mm): {:.4g} N {}\nModel: {}, {} unknowns on the finest mesh\n",
                  1e3 * deepest->depth_m, deepest->force_n().norm(),
                  std::isfinite(band_n) ? fmt::format("+- {:.2g} N", band_n) : "(uncertainty unknown)", result.model,
                  result.levels.back().unknowns);
  for (std::size_t level = 0; level < result.levels.size(); ++level) {
    const reference::LevelRecord& mesh = result.levels[level];
    text +=
        fmt::format("  mesh {}: {:.3g} mm, {} unknowns, {} Newton iterations, {:.3g} s, {:.6g} N\n", level + 1,
                    1e3 * mesh.element_size_m, mesh.unknowns, mesh.newton_iterations, mesh.wall_s, mesh.force_n[at]);
  }
  if (std::isfinite(result.force_uncertainty_rel.value_or(INFINITY)) && result.shape_uncertainty_rel) {
    text += fmt::format("Uncertainty: {:.2g} of the force, {:.2g} of the displacement, from {} meshes\n",
                        *result.force_uncertainty_rel, *result.shape_uncertainty_rel, result.levels.size());
  }
  if (result.refinement.error_asked > 0.0) {
    text += fmt::format("Asked: {:.2g}; {}\n", result.refinement.error_asked, result.refinement.why_ended);
  }
  return text;
}

}  // namespace touchstone::compare
