#include "scene/response/mesh_tips.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace touchstone::scene {
namespace {

/// How deep every vertex is below the rest surface, at most [m]; 0 where it never is.
std::vector<double> depths_m(const Scene& scene, const TriangleMesh& mesh, const std::vector<double>& times_s) {
  const auto body = body_shape(scene.body);
  const Bounds box = body->bounds();
  std::vector<double> out(static_cast<std::size_t>(mesh.points_m.cols()), 0.0);
  for (const double time_s : times_s) {
    const Pose pose = pose_at(scene.track, time_s);
    const Mat3 turn = pose.orientation.toRotationMatrix();
    for (std::size_t i = 0; i < out.size(); ++i) {
      const Vec3 p_m = turn * mesh.points_m.col(static_cast<Eigen::Index>(i)) + pose.position_m;
      if ((p_m.array() < box.lower_m.array()).any() || (p_m.array() > box.upper_m.array()).any()) continue;
      out[i] = std::max(out[i], -body->signed_distance_m(p_m));
    }
  }
  return out;
}

/// Triangles with a vertex below the surface, by connected parts of such vertices.
std::vector<std::vector<std::size_t>> parts(const TriangleMesh& mesh, const std::vector<double>& depth_m) {
  std::vector<std::int32_t> parent(depth_m.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t i) {
    while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
    return i;
  };
  const auto below = [&](std::int32_t i) { return depth_m[static_cast<std::size_t>(i)] > 0.0; };
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k], b = triangle[(k + 1) % 3];
      if (!below(a) || !below(b)) continue;
      const std::int32_t from = root(a), to = root(b);
      parent[static_cast<std::size_t>(std::max(from, to))] = std::min(from, to);
    }
  }
  std::map<std::int32_t, std::vector<std::size_t>> of_root;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const auto first = std::find_if(triangle.begin(), triangle.end(), below);
    if (first != triangle.end()) of_root[root(*first)].push_back(t);
  }
  std::vector<std::vector<std::size_t>> out;
  for (auto& [_, triangles] : of_root) out.push_back(std::move(triangles));
  return out;
}

/// The ball of a part, which is pressed in to a depth; nothing where it is none.
std::optional<ToolTip> ball_of(const TriangleMesh& mesh, const std::vector<std::size_t>& part, double depth_m) {
  Eigen::Matrix3Xd middle_m(3, 3 * static_cast<Eigen::Index>(part.size()));
  Eigen::VectorXd weight(middle_m.cols());
  Vec3 out_m2 = Vec3::Zero();
  std::vector<Vec3> area_m2;
  for (std::size_t t = 0; t < part.size(); ++t) {
    const auto& triangle = mesh.triangles[part[t]];
    const Vec3 a = mesh.points_m.col(triangle[0]), b = mesh.points_m.col(triangle[1]),
               c = mesh.points_m.col(triangle[2]);
    const auto column = 3 * static_cast<Eigen::Index>(t);
    middle_m.middleCols<3>(column) << 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a);
    area_m2.push_back(0.5 * (b - a).cross(c - a));
    weight.segment<3>(column).setConstant(area_m2.back().norm());
    out_m2 += area_m2.back();
  }
  // |p|^2 = 2 c.p + (R^2 - |c|^2), about the middle and in units of the part's size.
  const Vec3 middle = middle_m * weight / weight.sum();
  const double size_m = (middle_m.colwise() - middle).colwise().norm().maxCoeff();
  const Eigen::Matrix3Xd p = (middle_m.colwise() - middle) / size_m;
  Eigen::MatrixX4d rows(p.cols(), 4);
  rows << 2.0 * p.transpose(), Eigen::VectorXd::Ones(p.cols());
  const Eigen::VectorXd root = weight.cwiseSqrt();
  const Eigen::Vector4d x =
      (root.asDiagonal() * rows).colPivHouseholderQr().solve(root.cwiseProduct(p.colwise().squaredNorm().transpose()));
  ToolTip tip;
  tip.center_T_m = middle + size_m * x.head<3>();
  tip.radius_m = size_m * std::sqrt(std::max(x[3] + x.head<3>().squaredNorm(), 0.0));
  const double off_m = ((middle_m.colwise() - tip.center_T_m).colwise().norm().array() - tip.radius_m).abs().maxCoeff();
  // A hollow has its ball outside.
  if (!(off_m <= ball_tolerance_rel * depth_m) || !(out_m2.dot(middle - tip.center_T_m) > 0.0)) return std::nullopt;
  return tip;
}

}  // namespace

FoundTips mesh_tips(const Scene& scene, const std::vector<double>& times_s) {
  const TriangleMesh mesh = tool_mesh(scene.tool);
  const std::vector<double> depth_m = depths_m(scene, mesh, times_s);
  FoundTips out;
  for (const std::vector<std::size_t>& part : parts(mesh, depth_m)) {
    double deepest_m = 0.0;
    for (const std::size_t t : part) {
      for (const std::int32_t i : mesh.triangles[t]) {
        deepest_m = std::max(deepest_m, depth_m[static_cast<std::size_t>(i)]);
      }
    }
    const std::optional<ToolTip> ball = ball_of(mesh, part, deepest_m);
    if (!ball) return {{}, "every part of the tool's mesh that touches is part of a ball"};
    const bool known = std::ranges::any_of(out.tips, [&](const ToolTip& tip) {
      return (tip.center_T_m - ball->center_T_m).norm() < ball_tolerance_rel * tip.radius_m;
    });
    if (!known) out.tips.push_back(*ball);
  }
  return out;
}

}  // namespace touchstone::scene
