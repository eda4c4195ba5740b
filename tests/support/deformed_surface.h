// Exact distance to a deformed shape, by the closest triangle of its displaced tessellation, refined around it.
#pragma once

#include "scene/shape/surface.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <vector>

namespace touchstone::test {

using scene::Vec3;

inline Vec3 closest_on_triangle(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  return a + vb / (va + vb + vc) * ab + vc / (va + vb + vc) * ac;
}

class DeformedSurface {
 public:
  using Field = std::function<Vec3(const Vec3&)>;

  DeformedSurface(const scene::Shape& shape, Field field, int triangles)
      : shape_(shape), field_(std::move(field)), surface_(scene::tessellate(shape, triangles)) {
    points_m_ = surface_.points_m;
    for (int i = 0; i < surface_.vertex_count(); ++i) points_m_.col(i) += field_(surface_.points_m.col(i));
    for (const auto& t : surface_.triangles) {
      const Vec3 center = (points_m_.col(t[0]) + points_m_.col(t[1]) + points_m_.col(t[2])) / 3.0;
      double radius = 0.0;
      for (const int v : t) radius = std::max(radius, (points_m_.col(v) - center).norm());
      balls_.push_back({center, radius});
    }
  }

  struct Answer {
    double signed_distance_m, facets_m;  ///< distance to the surface, and to its 20k flat triangles
  };
  [[nodiscard]] Answer query(const Vec3& p) const {
    Nearest coarse;
    for (std::size_t t = 0; t < balls_.size(); ++t) {
      if ((p - balls_[t].center_m).norm() - balls_[t].radius_m > coarse.distance_m + near_m) continue;
      const auto& v = surface_.triangles[t];
      coarse.add(points_m_.col(v[0]), points_m_.col(v[1]), points_m_.col(v[2]), p);
    }
    Nearest fine;
    for (std::size_t t = 0; t < balls_.size(); ++t) {
      if ((p - balls_[t].center_m).norm() - balls_[t].radius_m > coarse.distance_m + near_m) continue;
      const auto& v = surface_.triangles[t];
      const Vec3 a = points_m_.col(v[0]), b = points_m_.col(v[1]), c = points_m_.col(v[2]);
      if ((closest_on_triangle(a, b, c, p) - p).norm() > coarse.distance_m + near_m) continue;
      refine(v, p, fine);
    }
    return {fine.signed_m(), coarse.signed_m()};
  }

 private:
  static constexpr double near_m = 6e-5;  ///< more than the sagitta of a triangle
  struct Ball {
    Vec3 center_m;
    double radius_m;
  };
  struct Nearest {
    double distance_m = std::numeric_limits<double>::infinity(), cosine = 0.0;
    void add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
      const Vec3 off = p - closest_on_triangle(a, b, c, p);
      const double here = off.norm();
      if (here > distance_m * (1.0 + 1e-9)) return;
      const Vec3 normal = (b - a).cross(c - a).normalized();
      const double along = here > 0.0 ? off.dot(normal) / here : 0.0;
      // Of triangles with the same closest point, the one that faces the point most decides the side.
      if (here < distance_m * (1.0 - 1e-9) || std::abs(along) > std::abs(cosine)) cosine = along;
      distance_m = std::min(distance_m, here);
    }
    [[nodiscard]] double signed_m() const { return cosine < 0.0 ? -distance_m : distance_m; }
  };

  void refine(const std::array<std::int32_t, 3>& v, const Vec3& p, Nearest& nearest) const {
    constexpr int n = 12;
    const Vec3 a = surface_.points_m.col(v[0]), b = surface_.points_m.col(v[1]), c = surface_.points_m.col(v[2]);
    std::array<std::array<Vec3, n + 1>, n + 1> grid;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 rest = shape_.query(a + (b - a) * i / n + (c - a) * j / n).point_m;
        grid[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = rest + field_(rest);
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; i + j < n; ++j) {
        nearest.add(grid[i][j], grid[i + 1][j], grid[i][j + 1], p);
        if (i + j + 1 < n) nearest.add(grid[i + 1][j], grid[i + 1][j + 1], grid[i][j + 1], p);
      }
    }
  }

  const scene::Shape& shape_;
  Field field_;
  scene::Surface surface_;
  Eigen::Matrix3Xd points_m_;
  std::vector<Ball> balls_;
};

}  // namespace touchstone::test
