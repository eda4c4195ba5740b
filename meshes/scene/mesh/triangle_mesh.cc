#include "scene/mesh/triangle_mesh.h"

namespace touchstone::scene {

double TriangleMesh::area_m2() const {
  double twice_m2 = 0.0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 pa = points_m.col(a);
    twice_m2 += (points_m.col(b) - pa).cross(points_m.col(c) - pa).norm();
  }
  return 0.5 * twice_m2;
}

double TriangleMesh::volume_m3() const {
  // Tetrahedra from one of the mesh's own points, so that far from the origin no digits are lost.
  if (triangles.empty()) return 0.0;
  const Vec3 from = points_m.col(0);
  double six_m3 = 0.0;
  for (const auto& [a, b, c] : triangles) {
    six_m3 += (points_m.col(a) - from).dot((points_m.col(b) - from).cross(points_m.col(c) - from));
  }
  return six_m3 / 6.0;
}

Vec3 TriangleMesh::centroid_m() const {
  if (triangles.empty()) return Vec3::Zero();
  const Vec3 from = points_m.col(0);
  double six_m3 = 0.0;
  Vec3 moment = Vec3::Zero();
  for (const auto& [a, b, c] : triangles) {
    const Vec3 pa = points_m.col(a) - from, pb = points_m.col(b) - from, pc = points_m.col(c) - from;
    const double part = pa.dot(pb.cross(pc));
    six_m3 += part;
    moment += part / 4.0 * (pa + pb + pc);
  }
  return from + moment / six_m3;
}

Bounds TriangleMesh::bounds() const { return {points_m.rowwise().minCoeff(), points_m.rowwise().maxCoeff()}; }

}  // namespace touchstone::scene
