#include "reference/run/contact_patch.h"

#include "reference/contact/regions.h"
#include "reference/tool/distance_grid.h"
#include "scene/shape/surface.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>

namespace touchstone::reference {
namespace {

using scene::Vec3;

/// Points on a lattice over every triangle. A triangle bends as much as the normals at its corners differ; an edge
/// that is sharp is as round as the grid makes it.
ToolPoints mesh_points(const scene::TriangleMesh& mesh, double spacing_m) {
  const double sharp_bend_m = grid_spacing_m(mesh);
  const Eigen::Matrix3Xd normals = vertex_normals(mesh).colwise().normalized();
  const auto angles = edge_angles(mesh);
  std::vector<Vec3> points_m;
  ToolPoints out;
  out.spacing_m = spacing_m;
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> corner_m;
    for (int k = 0; k < 3; ++k) corner_m[k] = mesh.points_m.col(t[k]);
    double longest_m = 0.0, bend_per_m = 0.0;
    std::array<bool, 3> is_sharp;  // the edge from corner k
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const double length_m = (corner_m[next] - corner_m[k]).norm();
      longest_m = std::max(longest_m, length_m);
      bend_per_m = std::max(bend_per_m, (normals.col(t[next]) - normals.col(t[k])).norm() / length_m);
      is_sharp[k] = angles.at(std::minmax(t[k], t[next])) > sharp_angle;
    }
    const int steps = static_cast<int>(std::ceil(longest_m / spacing_m));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        points_m.push_back(corner_m[0] + (corner_m[1] - corner_m[0]) * i / steps +
                           (corner_m[2] - corner_m[0]) * j / steps);
        const bool on_sharp = (j == 0 && is_sharp[0]) || (i + j == steps && is_sharp[1]) || (i == 0 && is_sharp[2]);
        out.bend_radius_m.push_back(on_sharp ? sharp_bend_m : 1.0 / std::max(bend_per_m, 1e-300));
      }
    }
  }
  out.points_m.resize(3, static_cast<Eigen::Index>(points_m.size()));
  for (std::size_t i = 0; i < points_m.size(); ++i) out.points_m.col(static_cast<Eigen::Index>(i)) = points_m[i];
  return out;
}

ContactPatch patch_of(const std::vector<scene::SurfaceQuery>& feet, const std::vector<double>& bend_radius_m,
                      double spacing_m) {
  ContactPatch patch;
  const auto deepest = std::min_element(
      feet.begin(), feet.end(), [](const auto& a, const auto& b) { return a.signed_distance_m < b.signed_distance_m; });
  patch.depth_m = -deepest->signed_distance_m;
  patch.normal = deepest->normal;
  std::vector<int> core;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (-feet[i].signed_distance_m >= 0.5 * patch.depth_m) core.push_back(static_cast<int>(i));
  }
  // Axes of the patch: the directions of largest and smallest spread in the tangent plane.
  Vec3 mean_m = Vec3::Zero();
  for (const int i : core) mean_m += feet[i].point_m / static_cast<double>(core.size());
  scene::Mat3 spread = scene::Mat3::Zero();
  for (const int i : core) {
    const Vec3 from_m = feet[i].point_m - mean_m;
    const Vec3 flat_m = from_m - from_m.dot(patch.normal) * patch.normal;
    spread += flat_m * flat_m.transpose();
  }
  const Vec3 long_axis = Eigen::SelfAdjointEigenSolver<scene::Mat3>(spread).eigenvectors().col(2);
  const Vec3 short_axis = patch.normal.cross(long_axis).normalized();
  const auto range = [&](const Vec3& axis) {
    Eigen::Vector2d r(INFINITY, -INFINITY);
    for (const int i : core) {
      const double x_m = (feet[i].point_m - mean_m).dot(axis);
      r = Eigen::Vector2d(std::min(r[0], x_m), std::max(r[1], x_m));
    }
    return r;
  };
  const Eigen::Vector2d length = range(long_axis), width = range(short_axis);
  patch.center_m = mean_m + 0.5 * length.sum() * long_axis + 0.5 * width.sum() * short_axis;
  // What the points miss between them counts half.
  const double half_length_m = 0.5 * (length[1] - length[0]) + 0.5 * spacing_m;
  patch.half_width_m = 0.5 * (width[1] - width[0]) + 0.5 * spacing_m;

  const int discs =
      half_length_m < 1.2 * patch.half_width_m ? 1 : static_cast<int>(std::ceil(half_length_m / patch.half_width_m));
  const double step_m = 2.0 * half_length_m / discs;
  for (int k = 0; k < discs; ++k) {
    patch.discs.push_back({patch.center_m + ((k + 0.5) * step_m - half_length_m) * long_axis, 0.0});
  }
  for (const int i : core) {
    const auto distance_m = [&](const ContactPatch::Disc& disc) {
      const Vec3 from_m = feet[i].point_m - disc.center_m;
      return (from_m - from_m.dot(patch.normal) * patch.normal).norm();
    };
    auto& nearest = *std::min_element(patch.discs.begin(), patch.discs.end(),
                                      [&](const auto& a, const auto& b) { return distance_m(a) < distance_m(b); });
    nearest.radius_m = std::max(nearest.radius_m, distance_m(nearest) + 0.5 * spacing_m);
    if (bend_radius_m[i] < 0.5 * patch.half_width_m) patch.rims.push_back({feet[i].point_m, bend_radius_m[i]});
  }
  return patch;
}

}  // namespace

ToolPoints tool_points(const scene::Tool& tool, const ToolDistance& distance) {
  if (tool.shape == scene::ToolShape::mesh) {
    return mesh_points(scene::tool_mesh(tool), distance.half_width_m() / 20.0);
  }
  constexpr int triangles = 20000;
  const auto shape = scene::tool_shape(tool);
  ToolPoints out;
  out.points_m = scene::tessellate(*shape, triangles).points_m;
  out.spacing_m = std::sqrt(2.0 * shape->area_m2() / triangles);
  for (const auto& p_m : out.points_m.colwise()) {
    const Eigen::SelfAdjointEigenSolver<scene::Mat3> bends(distance.at(p_m).hessian_per_m, Eigen::EigenvaluesOnly);
    out.bend_radius_m.push_back(1.0 / std::max(bends.eigenvalues().cwiseAbs().maxCoeff(), 1e-300));
  }
  return out;
}

std::vector<ContactPatch> contact_patches(const scene::Shape& body, const ToolPoints& tool, const scene::Pose& pose,
                                          double gap_m) {
  const scene::Bounds bounds = body.bounds();
  std::vector<scene::SurfaceQuery> feet;
  std::vector<double> bend_radius_m;
  for (Eigen::Index i = 0; i < tool.points_m.cols(); ++i) {
    const Vec3 p_m = pose.orientation * Vec3(tool.points_m.col(i)) + pose.position_m;
    if ((p_m.array() < bounds.lower_m.array()).any() || (p_m.array() > bounds.upper_m.array()).any()) continue;
    const scene::SurfaceQuery foot = body.query(p_m);
    if (foot.signed_distance_m >= 0.0) continue;
    feet.push_back(foot);
    bend_radius_m.push_back(tool.bend_radius_m[i]);
  }
  Eigen::Matrix3Xd places_m(3, static_cast<Eigen::Index>(feet.size()));
  for (std::size_t i = 0; i < feet.size(); ++i) places_m.col(static_cast<Eigen::Index>(i)) = feet[i].point_m;
  const std::vector<int> region = region_of_points(places_m, {}, std::max(gap_m, 2.0 * tool.spacing_m));
  std::vector<ContactPatch> patches;
  for (int r = 0; std::find(region.begin(), region.end(), r) != region.end(); ++r) {
    std::vector<scene::SurfaceQuery> its_feet;
    std::vector<double> its_bends_m;
    for (std::size_t i = 0; i < feet.size(); ++i) {
      if (region[i] != r) continue;
      its_feet.push_back(feet[i]);
      its_bends_m.push_back(bend_radius_m[i]);
    }
    patches.push_back(patch_of(its_feet, its_bends_m, tool.spacing_m));
  }
  return patches;
}

}  // namespace touchstone::reference
