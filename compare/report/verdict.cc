#include "compare/report/verdict.h"

#include "compare/format/text.h"
#include "compare/report/comparison_drawings.h"
#include "fast/step/status.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

namespace touchstone::compare {
namespace {

/// A penetration above this fraction of the depth is mentioned.
constexpr double large_penetration_share = 0.1;

std::string newtons(double force_n) { return quantity_text(force_n, "N"); }

/// "169.6 N ± 0.2 N": rounded to the digits that the uncertainty allows, four at most.
std::string with_band(double force_n, double band_n) {
  if (!std::isfinite(band_n)) return newtons(force_n) + " (uncertainty unknown)";
  const auto exponent = [](double value) { return static_cast<int>(std::floor(std::log10(value))); };
  const int most = force_n > 0.0 ? std::max(0, 3 - exponent(force_n)) : 3;
  const int decimals = band_n > 0.0 ? std::clamp(-exponent(band_n), 0, most) : most;
  return fmt::format("{:.{}f}{}N ± {}{}N", force_n, decimals, no_break, number_text(band_n, 1), no_break);
}

/// "78 % too low", "2.5 times too high".
std::string how_wrong(double ratio) {
  if (ratio >= 2.0) return number_text(ratio) + " times the reference's";
  const double off = std::abs(ratio - 1.0);
  return percent_text(off) + (ratio < 1.0 ? " too low" : " too high");
}

std::string force_sentence(const Errors& errors) {
  const InstantErrors& deepest = errors.instants[errors.deepest];
  const std::string where = fmt::format("at the deepest instant ({} deep)", quantity_text(deepest.depth_m, "m"));
  const std::string numbers = fmt::format("{} against the reference's {}", newtons(deepest.force_fast_n),
                                          with_band(deepest.force_reference_n, deepest.force_uncertainty_n));
  if (std::isfinite(deepest.force_uncertainty_n) && deepest.force_error_n <= deepest.force_uncertainty_n) {
    return fmt::format("The fast model's force {} is not distinguishable from the reference's: {}.", where, numbers);
  }
  if (!std::isfinite(deepest.force_fast_n)) {
    return fmt::format("The fast model's force {} is not a finite number.", where);
  }
  if (!(deepest.force_reference_n > 0.0)) {
    return fmt::format("The reference has no force {}; the fast model's is {}.", where, newtons(deepest.force_fast_n));
  }
  return fmt::format("The fast model's force {} is {}: {}.", where,
                     how_wrong(deepest.force_fast_n / deepest.force_reference_n), numbers);
}

/// The force error over the whole track, and the error of its direction.
Reason force_paragraph(const Errors& errors) {
  if (!errors.force_nrmse.value) return {};
  std::string text = fmt::format("Over the whole track the error is {} of the peak force (root mean square)",
                                 percent_text(*errors.force_nrmse.value));
  if (errors.force_rel_deep.value) {
    text += fmt::format(". It is {} of the force itself where the depth exceeds {} of its largest",
                        percent_text(*errors.force_rel_deep.value), percent_text(deep_share));
  }
  text += errors.force_nrmse.distinguishable() ? "." : ". Neither exceeds the reference's uncertainty.";
  const InstantErrors& deepest = errors.instants[errors.deepest];
  // Equal magnitude, different direction.
  if (deepest.force_error_n > deepest.force_uncertainty_n && deepest.force_reference_n > 0.0 &&
      std::abs(deepest.force_fast_n - deepest.force_reference_n) < 0.5 * deepest.force_error_n) {
    text +=
        fmt::format(" At the deepest instant the error is mostly one of direction: the two force vectors differ by {}.",
                    newtons(deepest.force_error_n));
  }
  return {.about = "Force", .detail = text};
}

/// A sentence for every status bit of the fast model.
std::vector<Reason> status_paragraphs(std::uint32_t status) {
  std::vector<Reason> out;
  for (std::uint32_t left = status; left != 0; left &= left - 1) {
    std::string text = fast::status_text(1u << std::countr_zero(left));
    text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
    out.push_back({"Status", text + "."});
  }
  return out;
}

Reason friction_paragraph(const Errors& errors) {
  if (!errors.friction || !errors.force_friction_nrmse.value) return {};
  std::string text = fmt::format("The error is {} of the reference's peak friction (root mean square)",
                                 percent_text(*errors.force_friction_nrmse.value));
  if (errors.force_friction_work_rel.value) {
    const double work = *errors.force_friction_work_rel.value;
    text += fmt::format(", and the work against it is {} too {}", percent_text(std::abs(work)),
                        work < 0.0 ? "low" : "high");
  }
  return {"Friction", text + ".", slip_text(errors)};
}

/// Fewer points than this say little about a shape.
constexpr int few_points = 10;

/// On how many points the shape's error rests, where they are few.
std::string few_points_text(const Errors& errors) {
  const int moved = errors.shape_points_moved;
  if (moved >= few_points) return "";
  return fmt::format(
      " It rests on {} point{} of the surface: the others move by less than {} of the largest displacement. More "
      "fast.triangles give more points.",
      moved, moved == 1 ? "" : "s", percent_text(Errors::moved_share));
}

std::string shape_sentence(const Errors& errors) {
  if (!errors.shape_rel_l2.value)
    return "The reference's body does not move, so a relative shape error has no meaning.";
  const double error = *errors.shape_rel_l2.value;
  if (!errors.shape_rel_l2.distinguishable()) {
    return fmt::format(
               "The deformed shapes are not distinguishable: they differ by {} of the displacement, and the "
               "reference's "
               "uncertainty is "
               "{}.",
               percent_text(error), percent_text(*errors.shape_rel_l2.uncertainty)) +
           few_points_text(errors);
  }
  const std::string known = errors.shape_rel_l2.uncertainty ? " ± " + percent_text(*errors.shape_rel_l2.uncertainty)
                                                            : std::string(" (uncertainty unknown)");
  if (error > 1.0) {
    return fmt::format(
               "The fast model's shape error is {}{} of the displacement. That is worse than no deformation: a surface "
               "that "
               "never moves has an error of 100{}%.",
               percent_text(error), known, no_break) +
           few_points_text(errors);
  }
  return fmt::format(
             "The fast model's shape error is {}{} of the displacement; a surface that never moves has an error of "
             "100{}%.",
             percent_text(error), known, no_break) +
         few_points_text(errors);
}

/// Mean ratio of the fast model's displacement to the reference's: sum A u_f.u_r / sum A u_r.u_r. 1 for equal
/// displacements, 0 if the fast model's surface does not move.
double moved_share(const fast::Run& run, const reference::Result& result) {
  double along = 0.0, scale = 0.0;
  for (std::size_t t = 0; t < run.instants.size(); ++t) {
    const Eigen::Matrix3Xd &f = run.instants[t].displacement_m, &r = result.instants[t].displacement_m;
    for (Eigen::Index i = 0; i < r.cols(); ++i) {
      const double area_m2 = run.surface.vertex_area_m2[static_cast<std::size_t>(i)];
      along += area_m2 * f.col(i).dot(r.col(i));
      scale += area_m2 * r.col(i).squaredNorm();
    }
  }
  return along / scale;
}

Reason shape_paragraph(const scene::Scene& scene, const fast::Run& run, const reference::Result& result,
                       const Errors& errors) {
  if (!errors.shape_rel_l2.value) return {};
  std::string text;
  const double share = moved_share(run, result);
  if (errors.shape_rel_l2.distinguishable() && std::isfinite(share) && (share < 0.8 || share > 1.25)) {
    text += fmt::format(" On average the surface moves {} times as far as the reference's.", number_text(share, 2));
  }
  if (errors.shape_inside_r_rel_l2.value && errors.shape_outside_r_rel_l2.value) {
    text += fmt::format(" Within {} of the contact the error is {}, outside {}.", quantity_text(scene.fast.r_R_m, "m"),
                        percent_text(*errors.shape_inside_r_rel_l2.value),
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
        " The fast model's surface does not follow the tool: the tool still penetrates it by up to {} of the depth.",
        percent_text(*errors.penetration_fast_rel));
  }
  return {.about = "Shape", .detail = text.empty() ? text : text.substr(1)};
}

Reason cost_paragraph(const fast::Run& run, const reference::Result& result) {
  const double wall_s =
      std::accumulate(result.levels.begin(), result.levels.end(), 0.0,
                      [](double sum, const reference::LevelRecord& level) { return sum + level.wall_s; });
  return {.about = "Cost",
          .detail = fmt::format("One step of the fast model takes {} (median; 99.9{}% of the steps below {}). The "
                                "reference took {} for {} instants on {} mesh{}.",
                                quantity_text(run.step.p50_us, "us"), no_break, quantity_text(run.step.p999_us, "us"),
                                quantity_text(wall_s, "s"), result.instants.size(), result.levels.size(),
                                result.levels.size() == 1 ? "" : "es")};
}

}  // namespace

std::string reference_sentence(const reference::Result& result, const Errors& errors) {
  const std::optional<double> force = force_known_to(errors);
  const auto& shape = errors.shape_rel_l2.uncertainty;
  if (errors.force_peak_reference_n > 0.0 && !(force && shape)) {
    return "The reference's uncertainty is unknown. " + why_uncertainty_unknown(result);
  }
  std::string text;
  if (force && shape) {
    text = fmt::format("The reference's force is known to {}, its shape to {}.", percent_text(*force),
                       percent_text(*shape));
  }
  if (const std::string& why = result.refinement.why_ended; !why.empty()) {
    text += fmt::format("{}Refinement ended: {}.", text.empty() ? "" : " ", why);
  }
  return text;
}

Verdict verdict(const scene::Scene& scene, const fast::Run& run, const reference::Result& result, const Errors& errors,
                const Call& call, const ModelEntry& model) {
  Verdict out;
  const auto add = [&](Reason reason) {
    if (!reason.text().empty()) out.reasons.push_back(std::move(reason));
  };
  if (errors.force_peak_reference_n == 0.0) {
    out.force = errors.depth_max_m == 0.0
                    ? "The tool never touches the body on this track, so there is no force or shape to compare."
                    : "The reference never has a force on this track, so relative errors have no meaning.";
    if (errors.force_peak_fast_n > 0.0) {
      out.force += fmt::format(" Yet the fast model reports a force of up to {}.", newtons(errors.force_peak_fast_n));
    }
    add(cost_paragraph(run, result));
  } else {
    out.force = force_sentence(errors);
    out.shape = shape_sentence(errors);
    for (Reason& status : status_paragraphs(run.status)) add(std::move(status));
    if (model.account.cause) add(model.account.cause(scene, errors));
    add(force_paragraph(errors));
    add(friction_paragraph(errors));
    add(shape_paragraph(scene, run, result, errors));
    add({.about = "Reference", .detail = reference_sentence(result, errors)});
    add(cost_paragraph(run, result));
  }
  out.next = next_steps(scene, run, result, errors, call, model);
  return out;
}

std::string Verdict::text() const {
  constexpr std::size_t columns = 80, most_steps = 2;
  std::string out = wrapped(force, columns) + "\n";
  if (!shape.empty()) out += wrapped(shape, columns) + "\n";
  for (const Reason& reason : reasons) {
    if (!reason.brief.empty()) out += wrapped(reason.about + ": " + reason.brief, columns) + "\n";
  }
  out += "\n";
  for (std::size_t k = 0; k < std::min(most_steps, next.size()); ++k) {
    out += wrapped("Next: " + next[k].why, columns) + "\n";
    if (!next[k].command.empty()) out += "  " + next[k].command + "\n";
  }
  if (next.size() > most_steps) out += "More to do next is in the report.\n";
  return next.empty() ? out : out + "\n";
}

}  // namespace touchstone::compare
