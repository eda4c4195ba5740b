// Cattaneo's and Mindlin's problem: a ball pressed on a half space, then moved along it.
#pragma once

#include "scene/model/scene.h"

#include <Eigen/Core>

#include <vector>

namespace touchstone::reference {

/// The ball is pressed without friction to its depth and then, at that depth, moved in equal steps with Coulomb's
/// friction; in small strain, on one half of a large block.
struct ShiftedBall {
  scene::Material material;
  double radius_m = 0.0;
  double depth_m = 0.0;  ///< far below the radius
  double friction = 0.0;
  double shift_m = 0.0;  ///< of the last step
  int steps = 1;
  double cells_per_radius = 6.0;  ///< of the contact
  double extent = 300.0;          ///< half the block's width, and its height, in contact radii
  Eigen::VectorXd places_m = {};  ///< along the shift from the middle: where the shear is wanted
};

/// One step's answer.
struct ShiftedBallStep {
  double shift_m = 0.0;
  double normal_n = 0.0, tangential_n = 0.0;  ///< P and Q on the body
  double stuck_share = 0.0;                   ///< of P, carried by what sticks
  Eigen::VectorXd shear_pa;                   ///< at places_m, along the shift
  double dissipated_j = 0.0;                  ///< since the first step
  int newton_iterations = 0;
};

/// @throws std::runtime_error when a step does not converge
[[nodiscard]] std::vector<ShiftedBallStep> shift_ball(const ShiftedBall& problem);

/// The closed form: Q / (mu P) at a shift [-] up to 1, and c / a. R. D. Mindlin, J. Appl. Mech. 16 (1949) 259-268;
/// K. L. Johnson, Contact Mechanics (1985), 7.2.
[[nodiscard]] double mindlin_force(const ShiftedBall& problem, double shift_m);
[[nodiscard]] double mindlin_stick_radius(double force);

/// q / (mu p0) at r / a, p0 Hertz's largest pressure, of the stick radius c / a. Johnson, as above.
[[nodiscard]] double mindlin_shear(double stick_radius, double r_over_a);

/// c / a from the fraction of P inside c under Hertz's pressure, 1 - (1 - (c/a)^2)^(3/2).
[[nodiscard]] double stick_radius_of_share(double stuck_share);

}  // namespace touchstone::reference
