#include "scene/shape/octants.h"

#include "scene/base/index.h"
#include "scene/shape/surface_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::scene {

Vec3 octant_point(int patch, double u, double v) noexcept {
  const double azimuth = 0.5 * std::numbers::pi * u;
  const double polar = 0.5 * std::numbers::pi * v;
  Vec3 point(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
  for (int axis = 0; axis < 3; ++axis) {
    if (patch >> axis & 1) point[axis] = -point[axis];
  }
  return point;
}

Surface octant_surface(int triangles, const std::function<SurfacePoint(const Vec3&)>& place) {
  const int n = std::max(1, static_cast<int>(std::lround(std::sqrt(triangles / 8.0))));
  SurfaceBuilder builder;
  for (int patch = 0; patch < 8; ++patch) {
    builder.begin_patch();
    const Vec3 sign(patch & 1 ? -1.0 : 1.0, patch & 2 ? -1.0 : 1.0, patch & 4 ? -1.0 : 1.0);
    std::vector<int> row_begin;
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n - j; ++i) {
        const SurfacePoint p = place(Vec3(sign.cwiseProduct(Vec3(n - i - j, i, j)).normalized()));
        const int vertex = builder.add_vertex(p.point_m, p.normal);
        if (i == 0) row_begin.push_back(vertex);
      }
    }
    const bool mirrored = sign.prod() < 0.0;
    const auto add = [&](int a, int b, int c) {
      mirrored ? builder.add_triangle(a, c, b) : builder.add_triangle(a, b, c);
    };
    for (int j = 0; j < n; ++j) {
      const int low = nth(row_begin, j), high = nth(row_begin, j + 1);
      for (int i = 0; i < n - j; ++i) {
        add(low + i, low + i + 1, high + i);
        if (i + 1 < n - j) add(low + i + 1, high + i + 1, high + i);
      }
    }
  }
  return builder.finish();
}

}  // namespace touchstone::scene
