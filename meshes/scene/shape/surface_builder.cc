#include "scene/shape/surface_builder.h"

#include "scene/base/index.h"

namespace touchstone::scene {

Surface SurfaceBuilder::finish() {
  begin_patch();
  const auto count = static_cast<Eigen::Index>(points_.size());
  surface_.points_m.resize(3, count);
  surface_.normals.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    surface_.points_m.col(i) = nth(points_, i);
    surface_.normals.col(i) = nth(normals_, i);
  }
  surface_.vertex_area_m2.assign(points_.size(), 0.0);
  for (const auto& [a, b, c] : surface_.triangles) {
    const Vec3 ab = surface_.points_m.col(b) - surface_.points_m.col(a);
    const Vec3 ac = surface_.points_m.col(c) - surface_.points_m.col(a);
    const double third_m2 = ab.cross(ac).norm() / 6.0;
    for (const std::int32_t vertex : {a, b, c}) nth(surface_.vertex_area_m2, vertex) += third_m2;
  }
  points_.clear();
  normals_.clear();
  return std::exchange(surface_, {});
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
