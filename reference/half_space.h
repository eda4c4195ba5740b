// Verification problem with a closed form: a rigid ball on a half space, as a cylinder so large that its end shows
// less than a thousandth. Free of deal.II.
#pragma once

#include "scene/scene.h"

namespace touchstone::reference {

struct HalfSpaceProblem {
  scene::Material material;
  double tool_radius_m = 0.0;
  double depth_m = 0.0;
  scene::Kinematics kinematics = scene::Kinematics::small;
  int cells_per_contact_radius = 30;
  /// Cylinder's radius and height over sqrt(R d). The far end adds about 1.13 / this to the force.
  double domain_over_contact_radius = 3000.0;
};

struct HalfSpaceAnswer {
  double force_n = 0.0;
  double contact_radius_m = 0.0;
  double equilibrium_rel = 0.0;
  double node_penetration_m = 0.0;
  int unknowns = 0;
  int newton_iterations = 0;
};

/// @throws NotConverged (solver.h)
[[nodiscard]] HalfSpaceAnswer indent_half_space(const HalfSpaceProblem& problem);

}  // namespace touchstone::reference
