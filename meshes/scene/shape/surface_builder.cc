#include "scene/shape/surface_builder.h"

#include <algorithm>
#include <cmath>

namespace touchstone::scene {

Surface SurfaceBuilder::finish() {
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
  points_.clear();
  normals_.clear();
  return std::exchange(surface_, {});
}

Surface Box::tessellated(int triangles) const {
  // Square cells of one size h: 2 * area / h^2 triangles.
  const double h = std::sqrt(2.0 * area_m2() / triangles);
  const auto cells = [&](int axis) { return std::max(1, static_cast<int>(std::lround(2.0 * half_m_[axis] / h))); };
  SurfaceBuilder builder;
  for (int patch = 0; patch < patch_count(); ++patch) {
    builder.begin_patch();
    const int axis = patch / 2;
    const bool positive = patch % 2 == 1;
    const int nu = cells((axis + (positive ? 1 : 2)) % 3);
    const int nv = cells((axis + (positive ? 2 : 1)) % 3);
    std::vector<int> vertex;
    for (int j = 0; j <= nv; ++j) {
      for (int i = 0; i <= nu; ++i) {
        const SurfacePoint p = this->at(patch, static_cast<double>(i) / nu, static_cast<double>(j) / nv);
        vertex.push_back(builder.add_vertex(p.point_m, p.normal));
      }
    }
    const auto vertex_at = [&](int i, int j) { return vertex[static_cast<std::size_t>(j * (nu + 1) + i)]; };
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        // Alternate the diagonal so that the pattern has no preferred direction.
        if ((i + j) % 2 == 0) {
          builder.add_triangle(vertex_at(i, j), vertex_at(i + 1, j), vertex_at(i + 1, j + 1));
          builder.add_triangle(vertex_at(i, j), vertex_at(i + 1, j + 1), vertex_at(i, j + 1));
        } else {
          builder.add_triangle(vertex_at(i, j), vertex_at(i + 1, j), vertex_at(i, j + 1));
          builder.add_triangle(vertex_at(i + 1, j), vertex_at(i + 1, j + 1), vertex_at(i, j + 1));
        }
      }
    }
  }
  return builder.finish();
}

Surface surface_of(const TriangleMesh& mesh) {
  SurfaceBuilder builder;
  builder.begin_patch();
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 pa = mesh.points_m.col(a), pb = mesh.points_m.col(b), pc = mesh.points_m.col(c);
    const Vec3 normal = (pb - pa).cross(pc - pa).normalized();
    const int first = builder.add_vertex(pa, normal);
    builder.add_vertex(pb, normal);
    builder.add_vertex(pc, normal);
    builder.add_triangle(first, first + 1, first + 2);
  }
  return builder.finish();
}

}  // namespace touchstone::scene
