#include "scene/surface.h"

#include <algorithm>
#include <cmath>

namespace touchstone::scene {
namespace {

class SurfaceBuilder {
 public:
  int add_vertex(const Vec3& point_m, const Vec3& normal) {
    points_.push_back(point_m);
    normals_.push_back(normal);
    return static_cast<int>(points_.size()) - 1;
  }
  void add_triangle(int a, int b, int c) { surface_.triangles.push_back({a, b, c}); }
  void begin_patch() { surface_.patch_begin.push_back(static_cast<std::int32_t>(points_.size())); }

  Surface finish() {
    begin_patch();
    const auto count = static_cast<Eigen::Index>(points_.size());
    surface_.points_m.resize(3, count);
    surface_.normals.resize(3, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      surface_.points_m.col(i) = points_[static_cast<std::size_t>(i)];
      surface_.normals.col(i) = normals_[static_cast<std::size_t>(i)];
    }
    surface_.vertex_area_m2.assign(points_.size(), 0.0);
    for (const auto& [a, b, c] : surface_.triangles) {
      const Vec3 ab = surface_.points_m.col(b) - surface_.points_m.col(a);
      const Vec3 ac = surface_.points_m.col(c) - surface_.points_m.col(a);
      const double third_m2 = ab.cross(ac).norm() / 6.0;
      for (const std::int32_t vertex : {a, b, c}) surface_.vertex_area_m2[static_cast<std::size_t>(vertex)] += third_m2;
    }
    return std::move(surface_);
  }

 private:
  Surface surface_;
  std::vector<Vec3> points_, normals_;
};

Surface tessellate_box(const Box& box, int triangles) {
  // Square cells of one size h: 2 * area / h^2 triangles.
  const double h = std::sqrt(2.0 * box.area_m2() / triangles);
  const auto cells = [&](int axis) { return std::max(1, static_cast<int>(std::lround(2.0 * box.half_m()[axis] / h))); };
  SurfaceBuilder builder;
  for (int patch = 0; patch < box.patch_count(); ++patch) {
    builder.begin_patch();
    const int axis = patch / 2;
    const bool positive = patch % 2 == 1;
    const int nu = cells((axis + (positive ? 1 : 2)) % 3);
    const int nv = cells((axis + (positive ? 2 : 1)) % 3);
    std::vector<int> vertex;
    for (int j = 0; j <= nv; ++j) {
      for (int i = 0; i <= nu; ++i) {
        const SurfacePoint p = box.at(patch, static_cast<double>(i) / nu, static_cast<double>(j) / nv);
        vertex.push_back(builder.add_vertex(p.point_m, p.normal));
      }
    }
    const auto at = [&](int i, int j) { return vertex[static_cast<std::size_t>(j * (nu + 1) + i)]; };
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        // Alternate the diagonal so that the pattern has no preferred direction.
        if ((i + j) % 2 == 0) {
          builder.add_triangle(at(i, j), at(i + 1, j), at(i + 1, j + 1));
          builder.add_triangle(at(i, j), at(i + 1, j + 1), at(i, j + 1));
        } else {
          builder.add_triangle(at(i, j), at(i + 1, j), at(i, j + 1));
          builder.add_triangle(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
      }
    }
  }
  return builder.finish();
}

Surface tessellate_sphere(const Sphere& sphere, int triangles) {
  const int n = std::max(1, static_cast<int>(std::lround(std::sqrt(triangles / 8.0))));
  SurfaceBuilder builder;
  for (int patch = 0; patch < sphere.patch_count(); ++patch) {
    builder.begin_patch();
    const Vec3 sign(patch & 1 ? -1.0 : 1.0, patch & 2 ? -1.0 : 1.0, patch & 4 ? -1.0 : 1.0);
    std::vector<std::vector<int>> row(static_cast<std::size_t>(n) + 1);
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n - j; ++i) {
        const Vec3 normal = sign.cwiseProduct(Vec3(n - i - j, i, j)).normalized();
        row[static_cast<std::size_t>(j)].push_back(
            builder.add_vertex(sphere.center_m() + sphere.radius_m() * normal, normal));
      }
    }
    const bool mirrored = sign.prod() < 0.0;
    const auto add = [&](int a, int b, int c) {
      mirrored ? builder.add_triangle(a, c, b) : builder.add_triangle(a, b, c);
    };
    for (int j = 0; j < n; ++j) {
      const auto& low = row[static_cast<std::size_t>(j)];
      const auto& high = row[static_cast<std::size_t>(j) + 1];
      for (std::size_t i = 0; i + 1 < low.size(); ++i) {
        add(low[i], low[i + 1], high[i]);
        if (i + 1 < high.size()) add(low[i + 1], high[i + 1], high[i]);
      }
    }
  }
  return builder.finish();
}

}  // namespace

Surface tessellate(const Shape& shape, int triangles) {
  if (const auto* box = dynamic_cast<const Box*>(&shape)) return tessellate_box(*box, triangles);
  return tessellate_sphere(dynamic_cast<const Sphere&>(shape), triangles);
}

}  // namespace touchstone::scene
