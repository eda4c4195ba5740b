#include "scene/shape/surface_builder.h"

#include <algorithm>
#include <cmath>

namespace touchstone::scene {
namespace {

/// n^2 triangles in each octant, as a sphere over the flat octahedron gives them.
/// @param place takes a point of the unit sphere to a vertex
template <class Place>
Surface octants(int triangles, const Place& place) {
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
      const int low = row_begin[static_cast<std::size_t>(j)], high = row_begin[static_cast<std::size_t>(j) + 1];
      for (int i = 0; i < n - j; ++i) {
        add(low + i, low + i + 1, high + i);
        if (i + 1 < n - j) add(low + i + 1, high + i + 1, high + i);
      }
    }
  }
  return builder.finish();
}

}  // namespace

Surface Sphere::tessellated(int triangles) const {
  return octants(triangles, [&](const Vec3& unit) { return SurfacePoint{center_m_ + radius_m_ * unit, unit}; });
}

Surface Ellipsoid::tessellated(int triangles) const {
  return octants(triangles, [&](const Vec3& unit) {
    return SurfacePoint{center_m_ + semi_axes_m_.cwiseProduct(unit), unit.cwiseQuotient(semi_axes_m_).normalized()};
  });
}

}  // namespace touchstone::scene
