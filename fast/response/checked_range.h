// For which contacts the response model was compared with the reference. Beyond, a step says so.
#pragma once

#include "fast/step/status.h"
#include "scene/model/scene.h"

#include <string_view>

namespace touchstone::fast {

/// Within which the model was compared with the reference.
struct CheckedRange {
  double depth_over_radius = 0.0;     ///< of the tip, at most
  double size_rel = 0.0;              ///< the contact's radius over the body's size, at most
  double edge_over_radius = 0.0;      ///< distance of p0 to an edge over the contact's radius, at least
  double apart_over_radii = 0.0;      ///< of two contacts' places over the sum of their radii, at least
  double curvature_rel = 0.0;         ///< the body's largest curvature times the tip's radius, at most
  double depth_curvature = 0.0;       ///< the depth times the body's largest curvature, at most
  StepStatus scene = StepStatus::ok;  ///< what holds for every contact of the scene
};

/// The extremes of the contacts in reports/response.md, "What it holds for", which has their errors: up to 1.5 % in
/// force and 10 % in shape. With a Poisson's ratio below 0.5 there are fewer, balls on flat faces; with friction flat
/// faces.
[[nodiscard]] CheckedRange checked_range(const scene::Scene& scene);

/// How far off the pressure was where it was compared with the reference (reports/response.md), of such a scene.
[[nodiscard]] std::string_view pressure_errors(const scene::Scene& scene);

/// The same numbers of a contact.
struct ContactRange {
  double depth_over_radius = 0.0, size_rel = 0.0, edge_over_radius = 0.0, apart_over_radii = 0.0, curvature_rel = 0.0;
};

/// The bits of those that are beyond the checked range, and of what no contact of the scene is within; ok for none.
[[nodiscard]] StepStatus beyond(const CheckedRange& checked, const ContactRange& range) noexcept;

}  // namespace touchstone::fast
