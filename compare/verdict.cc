#include "compare/verdict.h"

#include "compare/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace touchstone::compare {
namespace {

/// The paper's Table I for rubber, read in millimetres and newtons: k1 = m w0^2, k3 = (3/4) m b0^2 eps (errata E2).
constexpr double table1_k1_n_per_m = 40.0, table1_k3_n_per_m3 = 3.0e8;

/// The law and the material disagree when one gives this many times the other's force.
constexpr double mismatch = 2.0;

/// A surface left inside the tool by more than this share of the depth is seen at once.
constexpr double large_penetration_share = 0.1;

std::string newtons(double force_n) { return quantity_text(force_n, "N"); }

/// "169.6 N ± 0.2 N": the value to the digit its uncertainty leaves.
std::string with_band(double force_n, double band_n) {
  if (!std::isfinite(band_n)) return newtons(force_n) + " (uncertainty unknown)";
  const int decimals = band_n > 0.0 ? std::clamp(-static_cast<int>(std::floor(std::log10(band_n))), 0, 6) : 3;
  return fmt::format("{:.{}f}{}N ± {:.{}f}{}N", force_n, decimals, no_break, band_n, decimals, no_break);
}

/// "78 % too low", "2.5 times too high".
std::string how_wrong(double ratio) {
  if (ratio >= 2.0) return number_text(ratio) + " times the reference's";
  const double off = std::abs(ratio - 1.0);
  return percent_text(off) + (ratio < 1.0 ? " too low" : " too high");
}

std::string force_paragraph(const Errors& errors) {
  const InstantErrors& deepest = errors.instants[errors.deepest];
  const std::string where = fmt::format("at the deepest instant ({} deep)", quantity_text(deepest.depth_m, "m"));
  const std::string numbers = fmt::format("{} against the reference's {}", newtons(deepest.force_fast_n),
                                          with_band(deepest.force_reference_n, deepest.force_uncertainty_n));
  std::string text;
  if (std::isfinite(deepest.force_uncertainty_n) && deepest.force_error_n <= deepest.force_uncertainty_n) {
    text = fmt::format("The fast model's force {} is not distinguishable from the reference's: {}.", where, numbers);
  } else if (!std::isfinite(deepest.force_fast_n)) {
    text = fmt::format("The fast model's force {} is not a finite number.", where);
  } else if (deepest.force_reference_n > 0.0) {
    text = fmt::format("The fast model's force {} is {}: {}.", where,
                       how_wrong(deepest.force_fast_n / deepest.force_reference_n), numbers);
    // Same size, other direction.
    if (std::abs(deepest.force_fast_n - deepest.force_reference_n) < 0.5 * deepest.force_error_n) {
      text += fmt::format(" Mostly its direction is wrong: the two force vectors are {} apart.",
                          newtons(deepest.force_error_n));
    }
  } else {
    text = fmt::format("{}: {}.", where, numbers);
  }
  if (errors.force_nrmse.value) {
    text += fmt::format(" Over the whole track the error is {} of the peak force (root mean square)",
                        percent_text(*errors.force_nrmse.value));
    if (errors.force_rel_deep.value) {
      text += fmt::format(", and {} of the force itself where the depth exceeds {} of its largest",
                          percent_text(*errors.force_rel_deep.value), percent_text(deep_share));
    }
    text += errors.force_nrmse.distinguishable() ? "." : "; both are not distinguishable from none.";
  }
  return text;
}

/// Why the force is off, as far as the scene's own numbers show; empty when they do not.
std::string reason_paragraph(const scene::Scene& scene, const Errors& errors) {
  const InstantErrors& deepest = errors.instants[errors.deepest];
  if (!errors.force_peak_rel.distinguishable() || !(deepest.force_fast_n > 0.0)) return "";
  const double d = deepest.depth_m;
  const double law_n = scene.contact.k1_n_per_m * d + scene.contact.k3_n_per_m3 * d * d * d;
  const std::optional<double> hertz_n = hertz_force_n(scene, d);
  std::string text;
  const bool too_low = hertz_n && law_n * mismatch < *hertz_n && deepest.force_fast_n < deepest.force_reference_n;
  const bool too_high = hertz_n && law_n > mismatch * *hertz_n && deepest.force_fast_n > deepest.force_reference_n;
  if (too_low || too_high) {
    text = fmt::format(
        "Reason: the scene's contact constants do not describe its material. The fast model's law "
        "F\u00a0=\u00a0k1\u00a0D\u00a0+\u00a0k3\u00a0D³ with k1 = {} N/m and k3 = {} N/m³ gives {} at D = {}; Hertz's "
        "formula with the scene's Young's modulus ({} MPa), "
        "Poisson's ratio ({}) and ball gives about {}. Nothing ties k1 and k3 to the modulus: they are inputs that "
        "must be tuned.",
        number_text(scene.contact.k1_n_per_m), number_text(scene.contact.k3_n_per_m3), newtons(law_n),
        quantity_text(d, "m"), number_text(1e-6 * scene.body.material.youngs_modulus_pa),
        number_text(scene.body.material.poissons_ratio), newtons(*hertz_n));
    if (scene.contact.k1_n_per_m == table1_k1_n_per_m && scene.contact.k3_n_per_m3 == table1_k3_n_per_m3) {
      text +=
          " These are the paper's Table I for rubber, read in millimetres and newtons; the paper tuned them to no "
          "measurement.";
    }
    if (deepest.force_fast_n < 0.95 * law_n) {
      text += fmt::format(
          " (Its force is {}, less than the law's at D, because it applies the law to a mean depth of the contact "
          "region.)",
          newtons(deepest.force_fast_n));
    }
  }
  // A constant factor could be scaled away; a factor that runs with the depth cannot.
  double least = std::numeric_limits<double>::infinity(), most = 0.0, at_least_m = 0.0, at_most_m = 0.0;
  for (const InstantErrors& e : errors.instants) {
    if (!e.deep || !(e.force_reference_n > 0.0)) continue;
    const double ratio = e.force_fast_n / e.force_reference_n;
    if (ratio < least) {
      least = ratio;
      at_least_m = e.depth_m;
    }
    if (ratio > most) {
      most = ratio;
      at_most_m = e.depth_m;
    }
  }
  if (most > 1.3 * least) {
    text += fmt::format(
        "{} the fast model gives {} of the reference's force at {} and {} at {}, so no "
        "single factor would put it right.",
        text.empty() ? "The law's form matters:" : " The law's form matters too:", percent_text(least),
        quantity_text(at_least_m, "m"), percent_text(most), quantity_text(at_most_m, "m"));
  }
  return text;
}

std::string shape_paragraph(const scene::Scene& scene, const fast::Run& run, const Errors& errors) {
  if (!errors.shape_rel_l2.value)
    return "The reference's body does not move, so a relative shape error has no meaning.";
  std::string text;
  if (!errors.shape_rel_l2.distinguishable()) {
    text = fmt::format(
        "The deformed shapes are not distinguishable: they differ by {} of the displacement, the reference itself is "
        "good to {}.",
        percent_text(*errors.shape_rel_l2.value), percent_text(*errors.shape_rel_l2.uncertainty));
  } else {
    text = fmt::format(
        "The fast model's shape is off by {} of the displacement (root mean square over the whole surface and the "
        "whole track; the reference {}).",
        percent_text(*errors.shape_rel_l2.value),
        errors.shape_rel_l2.uncertainty ? "is good to " + percent_text(*errors.shape_rel_l2.uncertainty)
                                        : "does not know its own uncertainty");
  }
  if (errors.shape_inside_r_rel_l2.value && errors.shape_outside_r_rel_l2.value) {
    text += fmt::format(" Nearer than {} to the contact it is {}, beyond that {}.",
                        quantity_text(scene.fast.r_R_m, "m"), percent_text(*errors.shape_inside_r_rel_l2.value),
                        percent_text(*errors.shape_outside_r_rel_l2.value));
    if (errors.shape_error_outside_share && *errors.shape_error_outside_share > 0.5) {
      text += fmt::format(" {} of the squared error lies away from the contact, where it is easily overlooked.",
                          percent_text(*errors.shape_error_outside_share));
    }
  }
  const auto worst =
      std::max_element(errors.instants.begin(), errors.instants.end(),
                       [](const InstantErrors& a, const InstantErrors& b) { return a.shape_max_m < b.shape_max_m; });
  if (worst->shape_max_m > 0.0 && worst->depth_m > 0.0) {
    const scene::Vec3 at_mm = 1e3 * run.surface.points_m.col(worst->shape_max_at);
    text += fmt::format(
        " The worst point, at rest at ({:.1f}, {:.1f}, {:.1f}) mm, is {} out of place when the tool is {} deep.",
        at_mm.x(), at_mm.y(), at_mm.z(), quantity_text(worst->shape_max_m, "m"), quantity_text(worst->depth_m, "m"));
  }
  if (errors.penetration_fast_rel.value_or(0.0) > large_penetration_share) {
    text += fmt::format(
        " The fast model's surface does not follow the tool: it is left inside it by up to {} of the depth.",
        percent_text(*errors.penetration_fast_rel));
  }
  return text;
}

std::string cost_paragraph(const fast::Run& run, const reference::Result& result) {
  const double wall_s =
      std::accumulate(result.levels.begin(), result.levels.end(), 0.0,
                      [](double sum, const reference::LevelRecord& level) { return sum + level.wall_s; });
  return fmt::format(
      "What that costs: one step of the fast model takes {} (median; 99.9 % of the steps below {}); the reference took "
      "{} for {} instants on {} mesh{}.",
      quantity_text(run.step.p50_us, "us"), quantity_text(run.step.p999_us, "us"), quantity_text(wall_s, "s"),
      result.instants.size(), result.levels.size(), result.levels.size() == 1 ? "" : "es");
}

}  // namespace

std::optional<double> hertz_force_n(const scene::Scene& scene, double depth_m) {
  const scene::Body& body = scene.body;
  if (scene.tool.shape != scene::ToolShape::sphere || body.shape == scene::BodyShape::revolution ||
      !body.inclusions.empty())
    return std::nullopt;
  double curvature_per_m = 1.0 / scene.tool.radius_m;
  if (body.shape == scene::BodyShape::sphere) curvature_per_m += 1.0 / body.radius_m;
  if (body.shape == scene::BodyShape::ellipsoid)
    curvature_per_m += body.semi_axes_m.z() / (body.semi_axes_m.x() * body.semi_axes_m.y());
  return 4.0 / 3.0 * body.material.contact_modulus_pa() * std::sqrt(1.0 / curvature_per_m) * std::pow(depth_m, 1.5);
}

std::vector<std::string> verdict(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                                 const Errors& errors) {
  if (errors.force_peak_reference_n == 0.0) {
    std::string text = errors.depth_max_m == 0.0
                           ? "The tool never touches the body on this track, so there is no force or shape to compare."
                           : "The reference never feels a force on this track, so relative errors have no meaning.";
    if (errors.force_peak_fast_n > 0.0) {
      text += fmt::format(" Yet the fast model reports a force of up to {}.", newtons(errors.force_peak_fast_n));
    }
    return {text, cost_paragraph(run, result)};
  }
  std::vector<std::string> paragraphs{force_paragraph(errors)};
  if (std::string reason = reason_paragraph(scene, errors); !reason.empty()) paragraphs.push_back(std::move(reason));
  paragraphs.push_back(shape_paragraph(scene, run, errors));
  paragraphs.push_back(cost_paragraph(run, result));
  return paragraphs;
}

}  // namespace touchstone::compare
