// A point force on a half space in closed form, against its normal (J. Boussinesq 1885) and along it (V. Cerruti 1882):
// K. L. Johnson, Contact Mechanics (1985), 3.2 and 3.6. And a radial double force: Cerruti's along two directions, each
// drawn apart.
#pragma once

#include "scene/base/frames.h"
#include "scene/model/scene.h"

namespace touchstone::scene {

/// A force on a half space, against the outward normal of its plane and along it, and a radial double force.
struct PointLoad {
  Vec3 point_m;  ///< where it acts
  Vec3 normal;   ///< outward, unit length
  double force_n = 1.0;
  Vec3 along_n = Vec3::Zero();  ///< perpendicular to the normal
  double apart_nm = 0.0;        ///< force times distance of the double force, positive outwards
};

/// Displacement [m] at another point of the half space, world frame.
[[nodiscard]] Vec3 half_space_displacement_m(const PointLoad& load, const Material& material, const Vec3& x_m);

/// Cauchy stress [Pa] there, tension positive; at nu = 0.5 with its pressure.
[[nodiscard]] Mat3 half_space_stress_pa(const PointLoad& load, const Material& material, const Vec3& x_m);

}  // namespace touchstone::scene
