// For which contacts the response model was compared with the reference. Beyond, a step says so.
#pragma once

#include "fast/response/response_model.h"
#include "fast/step/status.h"

namespace touchstone::fast {

/// The extremes of the contacts in reports/response.md, "What it holds for", which has their errors: up to 1.5 % in
/// force and 10 % in shape.
struct CheckedRange {
  static constexpr double depth_over_radius = 0.82;  ///< of the tip
  static constexpr double size_rel = 0.24;           ///< the contact's radius over the body's size
  static constexpr double edge_over_radius = 1.6;    ///< distance of p0 to an edge over the contact's radius, at least
  static constexpr double apart_over_radii = 6.0;    ///< of two contacts' places over the sum of their radii, at least
};

/// The same numbers of a contact.
struct ContactRange {
  double depth_over_radius = 0.0, size_rel = 0.0, edge_over_radius = 0.0, apart_over_radii = 0.0;
};
[[nodiscard]] ContactRange contact_range(const ResponseModel& model, const ResponseState& state,
                                         const ResponseContact& contact, const scene::ToolTip& tip) noexcept;

/// The bits of those that are beyond the checked range; ok for none.
[[nodiscard]] StepStatus beyond(const ContactRange& range) noexcept;

}  // namespace touchstone::fast
