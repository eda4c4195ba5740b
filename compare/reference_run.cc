#include "compare/reference_run.h"

#include "compare/reference_quality.h"
#include "fast/command_line.h"

#include <fmt/format.h>

#include <algorithm>
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
  if (seconds < 90.0) return fmt::format(", {:.0f} s left", seconds);
  return fmt::format(", {:.0f} min left", seconds / 60.0);
}

std::string progress_text(const reference::Progress& p) {
  if (p.newton == 0 && !p.note.empty()) return "reference: " + p.note;
  std::string text = fmt::format("reference: mesh {}/{} ({} unknowns), load step {}/{} at {:.2f} mm", p.level, p.levels,
                                 p.unknowns, p.instant, p.instants, 1e3 * p.depth_m);
  if (p.newton > 0) text += fmt::format(", Newton {} residual {:.1e}", p.newton, p.residual_rel);
  text += time_left_text(p.seconds_left);
  if (!p.note.empty()) text += " - " + p.note;
  return text;
}

}  // namespace

reference::Result solve_with_progress(const scene::Scene& scene, const Eigen::Matrix3Xd& rest_points_m,
                                      const std::filesystem::path& store, bool quiet) {
  const StopOnSignal stop;
  fast::ProgressLine line(quiet);
  reference::Options options;
  options.store = store;
  options.stop = &stop_requested;
  options.progress = [&](const reference::Progress& p) {
    line.show(progress_text(p), p.step_finished || !p.note.empty());
  };
  return reference::solve(scene, rest_points_m, options);
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
  return fmt::format(
      "Force at the deepest instant ({:.3g} mm): {:.4g} N +- {:.2g} N\nModel: {}, {} unknowns on the finest mesh\n",
      1e3 * deepest->depth_m, deepest->force_n().norm(), result.force_uncertainty_n[at], result.model,
      result.levels.back().unknowns);
}

}  // namespace touchstone::compare
