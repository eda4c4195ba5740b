// For which contacts the response model was compared with the reference. Beyond, a step says so.
#pragma once

#include "fast/response/response_model.h"
#include "fast/step/status.h"

namespace touchstone::fast {

/// The extremes of the contacts in reports/response.md, "What it holds for", which has their errors: up to 1.5 % in
/// force and 10 % in shape. With a Poisson's ratio below 0.5 there are fewer, balls on flat faces; with friction flat
/// faces.
[[nodiscard]] CheckedRange checked_range(const scene::Scene& scene);

/// The same numbers of a contact.
struct ContactRange {
  double depth_over_radius = 0.0, size_rel = 0.0, edge_over_radius = 0.0, apart_over_radii = 0.0, curvature_rel = 0.0;
};
[[nodiscard]] ContactRange contact_range(const ResponseModel& model, const ResponseState& state,
                                         const ResponseContact& contact, const scene::ToolTip& tip) noexcept;

/// The bits of those that are beyond the checked range, and of what no contact of the scene is within; ok for none.
[[nodiscard]] StepStatus beyond(const CheckedRange& checked, const ContactRange& range) noexcept;

}  // namespace touchstone::fast
