// Balls.
#pragma once

#include "scene/shape/shape.h"

#include <cmath>

namespace touchstone::scene {

/// Distance from points inside a sphere along one direction to its surface.
class SphereExit {
 public:
  /// @param direction unit length
  SphereExit(const Vec3& center_m, double radius_m, const Vec3& direction) noexcept
      : center_m_(center_m), direction_(direction), radius2_m2_(radius_m * radius_m) {}
  /// [m]; zero for a point on the surface or outside.
  [[nodiscard]] TOUCHSTONE_INLINE double operator()(double x_m, double y_m, double z_m) const noexcept {
    const double x = x_m - center_m_.x(), y = y_m - center_m_.y(), z = z_m - center_m_.z();
    const double along_m = x * direction_.x() + y * direction_.y() + z * direction_.z();
    const double inside_m2 = radius2_m2_ - (x * x + y * y + z * z), root2_m2 = along_m * along_m + inside_m2;
    const double way_m = std::sqrt(root2_m2 > 0.0 ? root2_m2 : 0.0) - along_m;
    return inside_m2 > 0.0 ? way_m : 0.0;
  }
  [[nodiscard]] double operator()(const Vec3& p_m) const noexcept { return (*this)(p_m.x(), p_m.y(), p_m.z()); }

 private:
  Vec3 center_m_, direction_;
  double radius2_m2_;
};

/// Sphere; patches 0..7 are the octants (bit 0: x < 0, bit 1: y < 0, bit 2: z < 0), whose corners
/// are the six anchor points the paper names for a sphere.
class Sphere final : public Shape {
 public:
  /// @param radius_m > 0
  Sphere(const Vec3& center_m, double radius_m) : center_m_(center_m), radius_m_(radius_m) {}
  [[nodiscard]] int patch_count() const noexcept override { return 8; }
  [[nodiscard]] SurfacePoint at(int patch, double u, double v) const noexcept override;
  [[nodiscard]] SurfaceQuery query(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override;
  [[nodiscard]] Crossing crossing(const Vec3& from_m, const Vec3& to_m) const noexcept override;
  [[nodiscard]] double area_m2() const noexcept override;
  [[nodiscard]] double volume_m3() const noexcept override;
  [[nodiscard]] Bounds bounds() const noexcept override;
  [[nodiscard]] Surface tessellated(int triangles) const override;
  [[nodiscard]] const Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] double radius_m() const noexcept { return radius_m_; }

  /// Of any point. The centre is equally near to all: answer with the top.
  [[nodiscard]] TOUCHSTONE_INLINE Distance distance_at(double x_m, double y_m, double z_m) const noexcept {
    const double x = x_m - center_m_.x(), y = y_m - center_m_.y(), z = z_m - center_m_.z();
    const double distance_m = std::sqrt(x * x + y * y + z * z);
    const bool apart = distance_m > 0.0;
    return {distance_m - radius_m_, apart ? x / distance_m : 0.0, apart ? y / distance_m : 0.0,
            apart ? z / distance_m : 1.0};
  }
  [[nodiscard]] SphereExit exit_along(const Vec3& direction) const noexcept {
    return {center_m_, radius_m_, direction};
  }

 private:
  Vec3 center_m_;
  double radius_m_;
};

}  // namespace touchstone::scene
