#include "fast/response/checked_range.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::fast {

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
  out.apart_over_radii = std::numeric_limits<double>::infinity();
  for (const ResponseContact& other : state.contacts) {
    if (&other == &contact || !other.touches()) continue;
    const double apart_m = (contact.at.point_m - other.at.point_m).norm();
    out.apart_over_radii = std::min(out.apart_over_radii, apart_m / (radius_m + other.law.radius_m));
  }
  return out;
}

StepStatus beyond(const ContactRange& range) noexcept {
  StepStatus status = StepStatus::ok;
  if (range.depth_over_radius > CheckedRange::depth_over_radius) status |= StepStatus::depth_unchecked;
  if (range.size_rel > CheckedRange::size_rel) status |= StepStatus::size_unchecked;
  if (range.edge_over_radius < CheckedRange::edge_over_radius) status |= StepStatus::edge_unchecked;
  if (range.apart_over_radii < CheckedRange::apart_over_radii) status |= StepStatus::regions_unchecked;
  return status;
}

}  // namespace touchstone::fast
