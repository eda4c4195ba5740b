// Ellipsoids with their axes along x, y, z.
#pragma once

#include "scene/shape/octants.h"
#include "scene/shape/shape.h"

#include <array>
#include <cmath>

namespace touchstone::scene {

/// The closest point of an ellipsoid, found in a few steps from near its surface: x_i = a_i q_i with q_i(t) = a_i y_i /
/// (t + a_i^2), where |q(t)| = 1, and t = 0 on the surface. 1 / |q| is concave and nearly straight; Halley's method
/// follows its curve. Begins at t = 0 and goes on until settled() or lost(); points (x, y, z) are from the centre.
class EllipsoidSearch {
 public:
  static constexpr int steps_max = 12;
  explicit EllipsoidSearch(const Vec3& a) noexcept
      : ax_(a.x()),
        ay_(a.y()),
        az_(a.z()),
        ax2_(ax_ * ax_),
        ay2_(ay_ * ay_),
        az2_(az_ * az_),
        deepest_(-0.9 * a.cwiseProduct(a).minCoeff()) {}
  struct Step {
    double over;  ///< |q| - 1 before it
    double next;  ///< t behind it
  };
  [[nodiscard]] TOUCHSTONE_INLINE Step step(double x, double y, double z, double t) const noexcept {
    const double px = 1.0 / (ax2_ + t), py = 1.0 / (ay2_ + t), pz = 1.0 / (az2_ + t);
    const double qx = ax_ * x * px, qy = ay_ * y * py, qz = az_ * z * pz;
    const double qx2 = qx * qx, qy2 = qy * qy, qz2 = qz * qz;
    const double rx = qx2 * px, ry = qy2 * py, rz = qz2 * pz;
    const double length2 = qx2 + qy2 + qz2, length = std::sqrt(length2), over = length - 1.0;
    const double s1 = rx + ry + rz, s2 = rx * px + ry * py + rz * pz;
    const double bent = 2.0 * s1 * s1 + 3.0 * over * (s1 * s1 - length2 * s2);
    // Far outside the curve leads astray; straight on is Newton's step.
    return {over, t + 2.0 * length2 * over * s1 / (bent > s1 * s1 ? bent : 2.0 * s1 * s1)};
  }
  /// A step from here is not reliable.
  [[nodiscard]] TOUCHSTONE_INLINE static bool stands(const Step& s) noexcept { return std::abs(s.over) < 4e-16; }
  /// Further in than this, towards the surface of points with two nearest sides, use Ellipsoid::query().
  [[nodiscard]] TOUCHSTONE_INLINE bool lost(const Step& s) const noexcept { return stands(s) | !(s.next > deepest_); }
  /// The next step would change the last digit only.
  [[nodiscard]] TOUCHSTONE_INLINE static bool settled(const Step& s) noexcept { return std::abs(s.over) < 1e-5; }
  [[nodiscard]] TOUCHSTONE_INLINE Distance answer(double x, double y, double z, double t) const noexcept {
    const double gx = x / (ax2_ + t), gy = y / (ay2_ + t), gz = z / (az2_ + t);
    const double length = std::sqrt(gx * gx + gy * gy + gz * gz);
    const double nx = gx / length, ny = gy / length, nz = gz / length;
    const double hx = ax_ * nx, hy = ay_ * ny, hz = az_ * nz;
    return {x * nx + y * ny + z * nz - std::sqrt(hx * hx + hy * hy + hz * hz), nx, ny, nz};
  }

 private:
  double ax_, ay_, az_, ax2_, ay2_, az2_, deepest_;
};

/// Distance from points inside an ellipsoid along one direction to its surface.
class EllipsoidExit {
 public:
  /// @param direction unit length
  EllipsoidExit(const Vec3& center_m, const Vec3& per_axis_per_m, const Vec3& direction) noexcept
      : center_m_(center_m),
        per_axis_per_m_(per_axis_per_m),
        direction_(direction.cwiseProduct(per_axis_per_m)),
        a_(direction_.squaredNorm()) {}
  /// [m]; zero for a point on the surface or outside.
  [[nodiscard]] TOUCHSTONE_INLINE double operator()(double x_m, double y_m, double z_m) const noexcept {
    // |s + t e| = 1 with both divided by the semi-axes.
    const double x = (x_m - center_m_.x()) * per_axis_per_m_.x(), y = (y_m - center_m_.y()) * per_axis_per_m_.y(),
                 z = (z_m - center_m_.z()) * per_axis_per_m_.z();
    const double inside = 1.0 - (x * x + y * y + z * z);
    const double along = x * direction_.x() + y * direction_.y() + z * direction_.z();
    const double root2 = along * along + a_ * inside, root = std::sqrt(root2 > 0.0 ? root2 : 0.0);
    const double way_m = along > 0.0 ? inside / (root + along) : (root - along) / a_;
    return inside > 0.0 ? way_m : 0.0;
  }
  [[nodiscard]] double operator()(const Vec3& p_m) const noexcept { return (*this)(p_m.x(), p_m.y(), p_m.z()); }

 private:
  Vec3 center_m_, per_axis_per_m_, direction_;
  double a_;
};

/// Ellipsoid with its axes along x, y, z; patches as on a sphere, each octant the sphere's stretched by the semi-axes.
/// From a point on the middle plane that is equally near to two sides, the closest point is the one at larger
/// coordinates; from the centre it is the end of the shortest axis (of equal ones the last).
class Ellipsoid final : public Shape {
 public:
  /// @param semi_axes_m each > 0; equal ones are allowed
  Ellipsoid(const Vec3& center_m, const Vec3& semi_axes_m);
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
  [[nodiscard]] const Vec3& semi_axes_m() const noexcept { return semi_axes_m_; }

  /// Of any point: query()'s but for the last digits, and quicker near the surface.
  [[nodiscard]] Distance distance_at(double x_m, double y_m, double z_m) const noexcept {
    const EllipsoidSearch search(semi_axes_m_);
    const double x = x_m - center_m_.x(), y = y_m - center_m_.y(), z = z_m - center_m_.z();
    double t = 0.0;
    for (int k = 0; k < EllipsoidSearch::steps_max; ++k) {
      const EllipsoidSearch::Step step = search.step(x, y, z, t);
      if (search.lost(step)) break;
      t = step.next;
      if (EllipsoidSearch::settled(step)) return search.answer(x, y, z, t);
    }
    const SurfaceQuery safe = query({x_m, y_m, z_m});
    return {safe.signed_distance_m, safe.normal.x(), safe.normal.y(), safe.normal.z()};
  }
  /// The same as query() gives it.
  [[nodiscard]] SurfaceQuery closest(const Vec3& p_m) const noexcept {
    const Distance d = distance_at(p_m.x(), p_m.y(), p_m.z());
    const Vec3 normal(d.nx, d.ny, d.nz);
    return {d.signed_distance_m, p_m - d.signed_distance_m * normal, normal, octant_of(normal)};
  }
  /// Above 0 only if the whole ball about the point is outside: the half-space that touches the ellipsoid and whose
  /// normal is (x_i / a_i^2), which is nearly the nearest one. Without unit.
  [[nodiscard]] TOUCHSTONE_INLINE double beyond(double x_m, double y_m, double z_m, double radius_m) const noexcept {
    const double bx = per_axis_per_m_.x(), by = per_axis_per_m_.y(), bz = per_axis_per_m_.z();
    const double x = (x_m - center_m_.x()) * bx, y = (y_m - center_m_.y()) * by, z = (z_m - center_m_.z()) * bz;
    const double gx = x * bx, gy = y * by, gz = z * bz, ratio2 = x * x + y * y + z * z;
    return ratio2 - std::sqrt(ratio2) - radius_m * std::sqrt(gx * gx + gy * gy + gz * gz);
  }
  [[nodiscard]] EllipsoidExit exit_along(const Vec3& direction) const noexcept {
    return {center_m_, per_axis_per_m_, direction};
  }

 private:
  /// Closest surface point, each coordinate divided by its semi-axis. @param local_m from the centre
  [[nodiscard]] Vec3 closest_on_unit_sphere(const Vec3& local_m) const noexcept;

  Vec3 center_m_, semi_axes_m_;
  Vec3 per_axis_per_m_;  ///< 1 / semi-axes
  std::array<int, 3> longest_first_{0, 1, 2};
  Vec3 excess_;  ///< (a_i / a_min)^2 - 1, longest axis first
  double area_m2_;
};

}  // namespace touchstone::scene
