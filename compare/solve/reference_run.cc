#include "compare/solve/reference_run.h"

#include "compare/errors/reference_quality.h"
#include "compare/format/text.h"
#include "fast/command/command_line.h"
#include "fast/command/progress_line.h"
#include "fast/command/stop_signals.h"
#include "reference/run/cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace touchstone::compare {
namespace {

std::string time_left_text(const reference::Progress& p) {
  if (p.seconds_left < 0.0) return "";
  if (!std::isfinite(p.seconds_left)) return ", too long to estimate the time left";
  return ", about " + reference::duration_text(p.seconds_left) + " left";
}

}  // namespace

void refuse_unsupported(const scene::Scene& scene) {
  if (std::vector<scene::Fault> faults = reference::unsupported(scene); !faults.empty()) {
    throw scene::InputError(std::move(faults));
  }
}

std::string progress_text(const reference::Progress& p) {
  if (p.level == 0) return "reference: " + p.note + time_left_text(p);
  // The most important part comes first: a narrow terminal cuts off the rest.
  std::string text = fmt::format("mesh {} of {}{}", p.level, p.at_least ? "at least " : "", p.levels);
  if (p.event)
    return text + fmt::format(" {}: {} unknowns, instant {} of {}{}", p.note, p.unknowns, p.instant, p.instants,
                              time_left_text(p));
  text += fmt::format(", instant {} of {}{}", p.instant, p.instants, time_left_text(p));
  if (!p.note.empty()) return text + ", " + p.note;
  if (p.newton > 0) text += fmt::format(", Newton {}, residual {:.0e}", p.newton, p.residual_rel);
  return text + fmt::format(", {} unknowns", p.unknowns);
}

reference::Result solve_with_progress(const scene::Scene& scene, const scene::Surface& surface,
                                      const ReferenceOptions& options, bool quiet) {
  constexpr double gibibyte = 1024.0 * 1024.0 * 1024.0;
  const fast::StopSignals signals(fast::StopSignals::Again::end_at_once);
  fast::ProgressLine line(quiet);
  reference::Options solve_options;
  solve_options.store = options.store;
  solve_options.stop = &fast::StopSignals::asked();
  solve_options.rest_area_m2 = surface.vertex_area_m2;
  if (options.memory_gib) solve_options.memory_limit_bytes = *options.memory_gib * gibibyte;
  // The default limits do not apply if a number of meshes is given.
  if (options.minutes || !scene.reference.levels) {
    solve_options.seconds_limit = 60.0 * options.minutes.value_or(default_minutes);
  }
  solve_options.progress = [&](const reference::Progress& p) { line.show(progress_text(p), p.event); };
  return reference::solve(scene, surface.points_m, solve_options);
}

int with_reference_exits(const std::function<int()>& solve) {
  try {
    return solve();
  } catch (const reference::Interrupted& stopped) {
    std::cerr << stopped.what() << '\n';
    return fast::interrupted;
  } catch (const reference::LimitReached& limit) {
    std::cerr << limit.what() << " Limits are set with --minutes and --memory-gib.\n";
    return fast::not_converged;
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
  scene::write_summary(folder / "summary.json", reference_figures(result, reference_quality(result.instants)));
  scene::write_manifest(folder / "manifest.json", manifest);
}

std::string reference_text(const reference::Result& result) {
  const auto deepest = std::max_element(result.instants.begin(), result.instants.end(),
                                        [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  const auto at = static_cast<std::size_t>(deepest - result.instants.begin());
  const double uncertainty_n = result.instants[at].force_uncertainty_n;
  std::string text =
      fmt::format("Force at the deepest instant ({:.3g} mm): {:.4g} N, {}\nModel: {}, {} unknowns on the finest mesh\n",
                  1e3 * deepest->depth_m, deepest->force_n().norm(),
                  std::isfinite(uncertainty_n) ? fmt::format("+- {:.2g} N", uncertainty_n) : "uncertainty unknown",
                  result.model, result.levels.back().unknowns);
  for (std::size_t level = 0; level < result.levels.size(); ++level) {
    const reference::LevelRecord& mesh = result.levels[level];
    text +=
        fmt::format("  mesh {}: {:.3g} mm, {} unknowns, {} Newton iterations, {:.3g} s, {:.6g} N\n", level + 1,
                    1e3 * mesh.element_size_m, mesh.unknowns, mesh.newton_iterations, mesh.wall_s, mesh.force_n[at]);
  }
  return text + refinement_text(result);
}

bool known_to(const reference::Result& result, double error) {
  // Without force or displacement no uncertainty is needed; an unknown uncertainty is NaN and fails.
  const auto small = [&](const std::optional<double>& rel) { return !rel || *rel <= error; };
  return result.levels.size() >= 3 && small(result.force_uncertainty_rel) && small(result.shape_uncertainty_rel);
}

std::string refinement_text(const reference::Result& result) {
  const auto text_of = [](const std::optional<double>& rel, const char* norm) {
    if (!rel) return std::string("none");
    return std::isfinite(*rel) ? fmt::format("{:.2g} % ({})", 100.0 * *rel, norm) : std::string("unknown");
  };
  return fmt::format("Uncertainty of the reference: force {}, shape {}, from {} mesh{}\n{}\n",
                     text_of(result.force_uncertainty_rel, "worst instant"),
                     text_of(result.shape_uncertainty_rel, "root mean square"), result.levels.size(),
                     result.levels.size() == 1 ? "" : "es",
                     wrapped("Refinement ended: " + result.refinement.why_ended, 80));
}

int exit_of(const reference::Result& result, const ReferenceOptions& options) {
  if (!options.require_error || known_to(result, *options.require_error)) return fast::done;
  std::cerr << fmt::format("The reference is not known to {:.2g} %, which --require-error asks for: {}\n",
                           100.0 * *options.require_error, result.refinement.why_ended);
  return fast::not_converged;
}

}  // namespace touchstone::compare
