#include "scene/response/mesh_tips.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>

namespace touchstone::scene {
namespace {

/// Beside a contact the body yields: a vertex that is less deep below the rest surface than this share of its part's
/// deepest one stays apart. On the rim of Hertz's contact it is a half, under a cone 0.36.
constexpr double touches_rel = 1.0 / 3.0;

/// Vertices of which a condition holds, by parts that the mesh's edges connect: a vertex of the part for each of them,
/// itself where the condition does not hold.
template <class Condition>
std::vector<std::int32_t> parts(const TriangleMesh& mesh, const Condition& holds) {
  std::vector<std::int32_t> parent(static_cast<std::size_t>(mesh.points_m.cols()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t i) {
    while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
    return i;
  };
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = triangle[k], b = triangle[(k + 1) % 3];
      if (!holds(a) || !holds(b)) continue;
      const std::int32_t from = root(a), to = root(b);
      parent[static_cast<std::size_t>(std::max(from, to))] = std::min(from, to);
    }
  }
  std::vector<std::int32_t> out;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(parent.size()); ++i) out.push_back(root(i));
  return out;
}

/// How deep every vertex is below the rest surface where it touches, at most [m]; 0 where it never does.
/// @param share  of its part's deepest vertex from which one touches
std::vector<double> depths_m(const Scene& scene, const TriangleMesh& mesh, const std::vector<double>& times_s,
                             double share) {
  const auto body = body_shape(scene.body);
  const Bounds box = body->bounds();
  const auto count = static_cast<std::size_t>(mesh.points_m.cols());
  std::vector<double> out(count, 0.0), now_m(count), deepest_m(count);
  for (const double time_s : times_s) {
    const Pose pose = pose_at(scene.track, time_s);
    const Mat3 turn = pose.orientation.toRotationMatrix();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 p_m = turn * mesh.points_m.col(static_cast<Eigen::Index>(i)) + pose.position_m;
      const bool apart = (p_m.array() < box.lower_m.array()).any() || (p_m.array() > box.upper_m.array()).any();
      now_m[i] = apart ? 0.0 : std::max(0.0, -body->signed_distance_m(p_m));
    }
    const std::vector<std::int32_t> part =
        parts(mesh, [&](std::int32_t i) { return now_m[static_cast<std::size_t>(i)] > 0.0; });
    std::fill(deepest_m.begin(), deepest_m.end(), 0.0);
    const auto deepest = [&](std::size_t i) -> double& { return deepest_m[static_cast<std::size_t>(part[i])]; };
    for (std::size_t i = 0; i < count; ++i) deepest(i) = std::max(deepest(i), now_m[i]);
    for (std::size_t i = 0; i < count; ++i) {
      if (now_m[i] > share * deepest(i)) out[i] = std::max(out[i], now_m[i]);
    }
  }
  return out;
}

/// Triangles with a vertex that touches, by connected parts of such vertices.
std::vector<std::vector<std::size_t>> touching_parts(const TriangleMesh& mesh, const std::vector<double>& depth_m) {
  const auto touches = [&](std::int32_t i) { return depth_m[static_cast<std::size_t>(i)] > 0.0; };
  const std::vector<std::int32_t> part = parts(mesh, touches);
  std::map<std::int32_t, std::vector<std::size_t>> of_part;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& triangle = mesh.triangles[t];
    const auto first = std::find_if(triangle.begin(), triangle.end(), touches);
    if (first != triangle.end()) of_part[part[static_cast<std::size_t>(*first)]].push_back(t);
  }
  std::vector<std::vector<std::size_t>> out;
  for (auto& [_, triangles] : of_part) out.push_back(std::move(triangles));
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
  if (!(off_m <= tip_tolerance_rel * depth_m) || !(out_m2.dot(middle - tip.center_T_m) > 0.0)) return std::nullopt;
  return tip;
}

/// The disc of a part, which is pressed in to a depth: its largest triangle's plane and the rounded rim around it;
/// nothing where it is none.
std::optional<ToolTip> disc_of(const TriangleMesh& mesh, const std::vector<std::size_t>& part, double depth_m) {
  const double tolerance_m = tip_tolerance_rel * depth_m;
  const auto corner = [&](std::size_t t, std::size_t k) -> Vec3 { return mesh.points_m.col(mesh.triangles[t][k]); };
  const auto area_m2 = [&](std::size_t t) -> Vec3 {
    return 0.5 * (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
  };
  const std::size_t largest = *std::max_element(
      part.begin(), part.end(), [&](std::size_t a, std::size_t b) { return area_m2(a).norm() < area_m2(b).norm(); });
  const Vec3 out = area_m2(largest).normalized();
  const auto height_m = [&](const Vec3& p_m) { return out.dot(corner(largest, 0) - p_m); };
  // Its triangles are flat by the mesh's own precision.
  const double flat_m = 1e-3 * tolerance_m;
  Vec3 moment_m3 = Vec3::Zero();
  double flat_m2 = 0.0, flat_reach_m = 0.0;
  std::vector<std::size_t> flat, round;
  for (const std::size_t t : part) {
    bool in_plane = true;
    for (std::size_t k = 0; k < 3; ++k) in_plane = in_plane && std::abs(height_m(corner(t, k))) < flat_m;
    (in_plane ? flat : round).push_back(t);
  }
  for (const std::size_t t : flat) {
    const double one_m2 = area_m2(t).norm();
    flat_m2 += one_m2;
    moment_m3 += one_m2 / 3.0 * (corner(t, 0) + corner(t, 1) + corner(t, 2));
  }
  ToolTip tip{.center_T_m = moment_m3 / flat_m2, .axis_T = out, .flat_radius_m = std::sqrt(flat_m2 / std::numbers::pi)};
  for (const std::size_t t : flat) {
    for (std::size_t k = 0; k < 3; ++k) flat_reach_m = std::max(flat_reach_m, (corner(t, k) - tip.center_T_m).norm());
  }
  if (flat_reach_m - tip.flat_radius_m > tolerance_m) return std::nullopt;
  // (r - r_flat)^2 + z^2 = 2 R z on the rim's circle, by least squares through the edges' middles.
  double zz = 0.0, zq = 0.0;
  std::vector<Eigen::Vector2d> across_m;
  for (const std::size_t t : round) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 p_m = 0.5 * (corner(t, k) + corner(t, (k + 1) % 3));
      const double z_m = height_m(p_m), r_m = (p_m - tip.center_T_m).cross(out).norm() - tip.flat_radius_m;
      across_m.emplace_back(r_m, z_m);
      zz += z_m * z_m;
      zq += z_m * (r_m * r_m + z_m * z_m);
    }
  }
  tip.radius_m = zz > 0.0 ? 0.5 * zq / zz : 0.0;
  if (!(tip.radius_m > 0.0)) return std::nullopt;
  for (const Eigen::Vector2d& at_m : across_m) {
    const double off_m = (at_m - Eigen::Vector2d(0.0, tip.radius_m)).norm() - tip.radius_m;
    if (std::abs(off_m) > rim_tolerance_rel * depth_m) return std::nullopt;
  }
  return tip;
}

/// @param depth_m  of the vertices that touch
FoundTips tips_of(const TriangleMesh& mesh, const std::vector<double>& depth_m) {
  FoundTips out;
  for (const std::vector<std::size_t>& part : touching_parts(mesh, depth_m)) {
    double deepest_m = 0.0;
    for (const std::size_t t : part) {
      for (const std::int32_t i : mesh.triangles[t]) {
        deepest_m = std::max(deepest_m, depth_m[static_cast<std::size_t>(i)]);
      }
    }
    std::optional<ToolTip> found = ball_of(mesh, part, deepest_m);
    if (!found) found = disc_of(mesh, part, deepest_m);
    if (!found) {
      return {{}, "every part of the tool's mesh that touches is part of a ball or a flat disc with a rounded rim"};
    }
    const bool known = std::ranges::any_of(out.tips, [&](const ToolTip& tip) {
      return (tip.center_T_m - found->center_T_m).norm() < tip_tolerance_rel * tip.radius_m;
    });
    if (!known) out.tips.push_back(*found);
  }
  return out;
}

}  // namespace

FoundTips mesh_tips(const Scene& scene, const std::vector<double>& times_s) {
  const TriangleMesh mesh = tool_mesh(scene.tool);
  // All that is below the rest surface, if it is one form: more facets make a better ball.
  FoundTips out = tips_of(mesh, depths_m(scene, mesh, times_s, 0.0));
  return out.why.empty() ? out : tips_of(mesh, depths_m(scene, mesh, times_s, touches_rel));
}

}  // namespace touchstone::scene
