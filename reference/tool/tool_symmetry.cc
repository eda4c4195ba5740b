#include "reference/tool/tool_symmetry.h"

#include "reference/tool/distance_grid.h"
#include "scene/shape/surface.h"

#include <algorithm>
#include <numeric>

namespace touchstone::reference {
namespace {

using scene::Vec3;

constexpr double same_share = 1e-6, same_mesh_share = 3e-5, same_normal = 0.15;

bool mesh_maps_to_itself(const scene::Tool& tool, const scene::Pose& pose, const scene::Mat3& map) {
  const scene::TriangleMesh mesh = scene::tool_mesh(tool);
  const scene::Bounds bounds = mesh.bounds();
  const double same_m = same_mesh_share * (bounds.upper_m - bounds.lower_m).norm();
  const scene::Mat3 turn = pose.orientation.toRotationMatrix();
  const Eigen::Matrix3Xd points_m = (turn * mesh.points_m).colwise() + pose.position_m;
  const Eigen::Matrix3Xd normals = turn * vertex_normals(mesh);
  std::vector<int> by_x(points_m.cols());
  std::iota(by_x.begin(), by_x.end(), 0);
  std::sort(by_x.begin(), by_x.end(), [&](int a, int b) { return points_m(0, a) < points_m(0, b); });
  for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
    const Vec3 image_m = map * points_m.col(i), normal = map * normals.col(i);
    auto other = std::lower_bound(by_x.begin(), by_x.end(), image_m.x() - same_m,
                                  [&](int a, double x_m) { return points_m(0, a) < x_m; });
    bool found = false;
    for (; !found && other != by_x.end() && points_m(0, *other) <= image_m.x() + same_m; ++other) {
      found = (points_m.col(*other) - image_m).norm() <= same_m &&
              (normals.col(*other) - normal).norm() <= same_normal * normal.norm();
    }
    if (!found) return false;
  }
  return true;
}

}  // namespace

bool maps_to_itself(const scene::Tool& tool, const scene::Pose& pose, const scene::Mat3& map) {
  if (tool.shape == scene::ToolShape::mesh) return mesh_maps_to_itself(tool, pose, map);
  const auto shape = scene::tool_shape(tool);
  const scene::Bounds bounds = shape->bounds();
  const double same_m = same_share * (bounds.upper_m - bounds.lower_m).norm();
  const Eigen::Matrix3Xd points_m = scene::tessellate(*shape, 400).points_m;
  return std::all_of(points_m.colwise().begin(), points_m.colwise().end(), [&](const auto& p_T_m) {
    const Vec3 image_m = map * (pose.orientation * Vec3(p_T_m) + pose.position_m);
    return std::abs(shape->signed_distance_m(pose.orientation.conjugate() * (image_m - pose.position_m))) <= same_m;
  });
}

bool moves_alike(const scene::Pose& from, const scene::Pose& to, const scene::Mat3& map) {
  constexpr double same_turn = 1e-9, same_place_m = 1e-12;
  const scene::Mat3 turn = (to.orientation * from.orientation.conjugate()).toRotationMatrix();
  const Vec3 shift_m = to.position_m - turn * from.position_m;
  return (map * turn * map.transpose() - turn).norm() <= same_turn && (map * shift_m - shift_m).norm() <= same_place_m;
}

}  // namespace touchstone::reference
