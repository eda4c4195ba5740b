// The rest shape's exact distance, inlined per shape because contact detection asks it of every sample in every tick
// (section III). The same answers as scene::Shape gives, without the closest point.
#pragma once

#include "scene/shape.h"

#include <cmath>

namespace touchstone::fast {

/// Signed distance [m] of a point of the world, negative inside, and its gradient for an inside point: the outward
/// normal of the rest surface at the closest point.
struct RestDistance {
  double signed_distance_m;
  scene::Vec3 normal;
};

/// @param p_m inside the box; outside only the sign of the distance is right
[[nodiscard]] inline RestDistance rest_distance(const scene::Box& box, const scene::Vec3& p_m) noexcept {
  const scene::Vec3 local = p_m - box.center_m();
  const scene::Vec3 above_face = local.cwiseAbs() - box.half_m();
  const bool x = above_face.x() >= above_face.y() && above_face.x() >= above_face.z();
  const bool y = !x && above_face.y() >= above_face.z();
  const bool z = !x && !y;
  return {above_face.maxCoeff(),
          scene::Vec3(x ? std::copysign(1.0, local.x()) : 0.0, y ? std::copysign(1.0, local.y()) : 0.0,
                      z ? std::copysign(1.0, local.z()) : 0.0)};
}

[[nodiscard]] inline RestDistance rest_distance(const scene::Sphere& sphere, const scene::Vec3& p_m) noexcept {
  const scene::Vec3 local = p_m - sphere.center_m();
  const double distance_m = local.norm();
  return {distance_m - sphere.radius_m(), distance_m > 0.0 ? scene::Vec3(local / distance_m) : scene::Vec3::UnitZ()};
}

/// Way from inside points along one direction to the rest surface [m]; zero for a point on it or outside.
class BoxExit {
 public:
  /// @param direction unit length
  BoxExit(const scene::Box& box, const scene::Vec3& direction) noexcept : center_m_(box.center_m()) {
    for (int axis = 0; axis < 3; ++axis) {
      const double speed = std::abs(direction[axis]);
      // Never reached along an axis it does not move on.
      per_speed_[axis] = speed > 1e-300 ? 1.0 / speed : 1e300;
      sign_[axis] = std::copysign(1.0, direction[axis]);
      half_m_[axis] = box.half_m()[axis];
    }
  }
  [[nodiscard]] double operator()(const scene::Vec3& p_m) const noexcept {
    const scene::Vec3 way_m = half_m_ - sign_.cwiseProduct(p_m - center_m_);
    const double exit_m = way_m.cwiseProduct(per_speed_).minCoeff();
    return exit_m > 0.0 ? exit_m : 0.0;
  }

 private:
  scene::Vec3 center_m_, half_m_, sign_, per_speed_;
};

class SphereExit {
 public:
  /// @param direction unit length
  SphereExit(const scene::Sphere& sphere, const scene::Vec3& direction) noexcept
      : center_m_(sphere.center_m()), direction_(direction), radius2_m2_(sphere.radius_m() * sphere.radius_m()) {}
  [[nodiscard]] double operator()(const scene::Vec3& p_m) const noexcept {
    const scene::Vec3 local = p_m - center_m_;
    const double along_m = local.dot(direction_);
    const double inside_m2 = radius2_m2_ - local.squaredNorm();
    if (!(inside_m2 > 0.0)) return 0.0;
    return std::sqrt(along_m * along_m + inside_m2) - along_m;
  }

 private:
  scene::Vec3 center_m_, direction_;
  double radius2_m2_;
};

[[nodiscard]] inline BoxExit exit_along(const scene::Box& box, const scene::Vec3& direction) noexcept {
  return {box, direction};
}
[[nodiscard]] inline SphereExit exit_along(const scene::Sphere& sphere, const scene::Vec3& direction) noexcept {
  return {sphere, direction};
}

}  // namespace touchstone::fast
