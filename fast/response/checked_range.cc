#include "fast/response/checked_range.h"

#include "scene/response/find_tips.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace touchstone::fast {

CheckedRange checked_range(const scene::Scene& scene) {
  constexpr double flat = 1e-3;  // round-off of a plane's curvature
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const bool incompressible = scene.body.material.poissons_ratio == 0.5;
  CheckedRange out = incompressible ? CheckedRange{.depth_over_radius = 0.82,
                                                   .size_rel = 0.24,
                                                   .edge_over_radius = 1.6,
                                                   .apart_over_radii = 6.0,
                                                   .curvature_rel = 0.34}
                                    : CheckedRange{.depth_over_radius = 0.5,
                                                   .size_rel = 0.11,
                                                   .edge_over_radius = 5.0,
                                                   .apart_over_radii = infinite,
                                                   .curvature_rel = flat};
  if (scene.contact.friction) out.curvature_rel = flat;
  const std::vector<scene::ToolTip> tips = scene::tool_tips(scene).tips;
  const bool balls = std::all_of(tips.begin(), tips.end(), [](const auto& tip) { return tip.ball() && !tip.line(); });
  if (!incompressible && (scene.contact.friction || !balls)) out.scene |= StepStatus::material_unchecked;
  if (!scene.body.inclusions.empty()) out.scene |= StepStatus::inclusion_unchecked;
  return out;
}

ContactRange contact_range(const ResponseModel& model, const ResponseState& state, const ResponseContact& contact,
                           const scene::ToolTip& tip) noexcept {
  // Of a line the radius of a disc of its area, and the distance from its end.
  const LocalContact& law = contact.law;
  const double radius_m = std::sqrt(law.radius_m * (law.radius_m + 4.0 / std::numbers::pi * law.half_line_m));
  ContactRange out;
  out.depth_over_radius = contact.depth_m / tip.reach_m();
  out.size_rel = radius_m / model.body_size_m;
  const double edge_m = contact.weights.sum<double>([&](int k) { return model.edge_distance_m[k]; });
  out.edge_over_radius = (edge_m - law.half_line_m) / law.radius_m;
  out.curvature_rel =
      contact.weights.sum<double>([&](int k) { return model.largest_curvature_per_m[k]; }) * tip.reach_m();
  out.apart_over_radii = std::numeric_limits<double>::infinity();
  for (const ResponseContact& other : state.contacts) {
    if (&other == &contact || !other.touches()) continue;
    const double apart_m = (contact.at.point_m - other.at.point_m).norm();
    out.apart_over_radii = std::min(out.apart_over_radii, apart_m / (radius_m + other.law.radius_m));
  }
  return out;
}

StepStatus beyond(const CheckedRange& checked, const ContactRange& range) noexcept {
  StepStatus status = checked.scene;
  if (range.depth_over_radius > checked.depth_over_radius) status |= StepStatus::depth_unchecked;
  if (range.size_rel > checked.size_rel) status |= StepStatus::size_unchecked;
  if (range.edge_over_radius < checked.edge_over_radius) status |= StepStatus::edge_unchecked;
  if (range.apart_over_radii < checked.apart_over_radii) status |= StepStatus::regions_unchecked;
  if (range.curvature_rel > checked.curvature_rel) status |= StepStatus::curvature_unchecked;
  return status;
}

}  // namespace touchstone::fast
