// The places on a body's surface for which a response is computed.
#pragma once

#include "scene/model/scene.h"

#include <array>
#include <optional>
#include <string>

namespace touchstone::scene {

/// A grid of points on one smooth face, even in the tangent plane of its middle; the first direction is the fastest.
struct LoadGrid {
  Vec3 middle_m = Vec3::Zero();
  Mat3 axes = Mat3::Identity();  ///< columns: two directions along the surface, and the outward normal, at the middle
  std::array<int, 2> counts{};   ///< at least 3 each
  std::array<double, 2> spacing_m{};
  Eigen::Matrix3Xd points_m;  ///< on the rest surface
  Eigen::Matrix3Xd normals;   ///< outward there

  [[nodiscard]] int count() const noexcept { return counts[0] * counts[1]; }
  /// The point nearest to the middle.
  [[nodiscard]] int middle() const noexcept { return counts[1] / 2 * counts[0] + counts[0] / 2; }
  /// Directions of the loads along the surface at a point, unit and perpendicular: the first is nearest to axes' first.
  [[nodiscard]] Eigen::Matrix<double, 3, 2> along(int point) const noexcept {
    const Vec3 normal = normals.col(point), first = axes.col(0) - axes.col(0).dot(normal) * normal;
    Eigen::Matrix<double, 3, 2> out;
    out << first.normalized(), normal.cross(first).normalized();
    return out;
  }
  /// A surface point in steps of the grid: 0 to counts - 1 in each direction where it is inside.
  [[nodiscard]] Eigen::Vector2d place(const Vec3& p_m) const noexcept {
    const Vec3 d_m = p_m - middle_m;
    return {d_m.dot(axes.col(0)) / spacing_m[0] + 0.5 * (counts[0] - 1),
            d_m.dot(axes.col(1)) / spacing_m[1] + 0.5 * (counts[1] - 1)};
  }
};

/// The grid under the scene's track with room for the load to shift, or in words why there is none.
struct FoundGrid {
  std::optional<LoadGrid> grid;
  std::string why;
};
[[nodiscard]] FoundGrid load_grid(const Scene& scene);

}  // namespace touchstone::scene
