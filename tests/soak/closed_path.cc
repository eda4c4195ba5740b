#include "soak/closed_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace touchstone::soak {

using scene::Pose;
using scene::Vec3;

namespace {

/// A touch with the same plane around all that the tool may reach, if such a place is found soon.
Touch touch_under_plane(const fast::FastModel& model, double reach_m, Random& random) {
  Touch touch = random_touch(model, random);
  for (int attempt = 0; attempt < 50; ++attempt) {
    bool plane = true;
    const Vec3 across = touch.normal.unitOrthogonal(), other = touch.normal.cross(across);
    for (const Vec3& aside : {across, Vec3(-across), other, Vec3(-other)}) {
      const Vec3 p_m = touch.place_m + reach_m * (aside - touch.normal);
      const scene::SurfaceQuery here = model.body->query(p_m);
      plane = plane && here.signed_distance_m < 0.0 && (here.normal - touch.normal).norm() <= 1e-12;
    }
    if (plane) break;
    touch = random_touch(model, random);
  }
  return touch;
}

/// Whether no sample, and no part of a cell's polygon, below the plane of the touch is outside the body, which is
/// convex. The bulge of a curved cell is not considered.
bool stays_under_plane(const fast::FastModel& model, const ClosedPath& closed) {
  const scene::Bounds bounds = model.body->bounds();
  const double rounding_m = 1e-9 * (bounds.upper_m - bounds.lower_m).norm();
  const auto inside = [&](const Vec3& p_m) {
    return model.body->signed_distance_m(p_m - rounding_m * closed.touch.normal) < 0.0;
  };
  const fast::ToolSamples& tool = model.tool;
  for (const Pose& pose : closed.poses) {
    const scene::Mat3 R_WT = pose.orientation.toRotationMatrix();
    const auto above_m = [&](const Vec3& p_m) { return (p_m - closed.touch.place_m).dot(closed.touch.normal); };
    for (std::size_t i = 0; i < tool.x_T_m.size(); ++i) {
      const Vec3 p_m = R_WT * Vec3(tool.x_T_m[i], tool.y_T_m[i], tool.z_T_m[i]) + pose.position_m;
      if (above_m(p_m) < 0.0 && !inside(p_m)) return false;
    }
    for (const fast::SurfaceCell& cell : tool.cell) {
      const Vec3 middle_m = R_WT * cell.center_T_m + pose.position_m;
      fast::CutPolygon below({cell.corner_m.data(), static_cast<std::size_t>(cell.corners)});
      below.keep_below(R_WT.transpose() * closed.touch.normal, above_m(middle_m));
      for (const Vec3& corner_m : below.corners()) {
        if (!inside(middle_m + R_WT * corner_m)) return false;
      }
    }
  }
  return true;
}

}  // namespace

ClosedPath closed_path(PathKind kind, const fast::FastModel& model, Random& random) {
  constexpr int waves = 3;
  const scene::Bounds bounds = model.body->bounds();
  const double least_m = (bounds.upper_m - bounds.lower_m).minCoeff();
  const double depth_m = least_m * (kind == PathKind::level ? random.decades(1e-4, 0.1) : random.decades(1e-3, 0.4));
  const Touch touch =
      kind == PathKind::level ? touch_under_plane(model, 3.0 * depth_m, random) : random_touch(model, random);
  // Half of the paths leave the body in between.
  const double swell_m = depth_m * random.uniform(0.1, 2.0) / waves;
  const double aside_m = depth_m * random.decades(0.1, 10.0) / waves;
  const double turn_rad = kind == PathKind::level ? 0.0 : random.decades(1e-3, 0.3);
  std::array<Vec3, waves> way, turn, phase;
  std::array<double, waves> swell{};
  for (std::size_t k = 0; k < waves; ++k) {
    way[k] = aside_m * random.direction();
    way[k] -= way[k].dot(touch.normal) * touch.normal;
    turn[k] = turn_rad * random.direction();
    phase[k] = std::numbers::pi * random.direction();
    swell[k] = swell_m * random.uniform(-1.0, 1.0);
  }
  const auto pose_at = [&](double t) {
    Pose pose = touch.sunk(depth_m);
    Vec3 rotation = Vec3::Zero();
    for (std::size_t k = 0; k < waves; ++k) {
      const double w = static_cast<double>(k + 1) * t;
      const Vec3 across = touch.normal.cross(way[k]);
      pose.position_m += std::sin(w + phase[k].x()) * way[k] + std::cos(w + phase[k].x()) * across;
      pose.position_m += swell[k] * std::cos(w + (kind == PathKind::level ? 0.0 : phase[k].y())) * touch.normal;
      rotation += std::sin(w + phase[k].z()) * turn[k];
    }
    if (kind != PathKind::level)
      pose.orientation = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()) * pose.orientation;
    return pose;
  };
  std::vector<Pose> path;
  for (int i = 0; i <= ticks_per_round; ++i) {
    // The return uses exactly the same poses, so that rounding has no effect.
    const bool back = 2 * i > ticks_per_round;
    if (kind == PathKind::there_and_back && back) {
      path.push_back(path[static_cast<std::size_t>(ticks_per_round - i)]);
      continue;
    }
    path.push_back(i == ticks_per_round ? path[0] : pose_at(2.0 * std::numbers::pi * i / ticks_per_round));
    if (kind != PathKind::level || !back) continue;
    Pose& pose = path.back();
    const Vec3& twin_m = path[static_cast<std::size_t>(ticks_per_round - i)].position_m;
    pose.position_m += (twin_m - pose.position_m).dot(touch.normal) * touch.normal;
    // On a face perpendicular to an axis the depth is then bitwise the same.
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(touch.normal[axis]) == 1.0) pose.position_m[axis] = twin_m[axis];
  }
  return {kind, std::move(path), touch};
}

RoundWork go_round(const fast::FastModel& model, const fast::FastState& state, const ClosedPath& closed,
                   const std::function<void(const Pose&)>& step) {
  const std::vector<Pose>& path = closed.poses;
  for (const Pose& pose : path) step(pose);
  RoundWork work;
  Vec3 force_n = total_force_n(state), torque_nm = total_torque_nm(state);
  for (std::size_t i = 1; i < path.size(); ++i) {
    step(path[i]);
    const Vec3 now_n = total_force_n(state), now_nm = total_torque_nm(state);
    const Eigen::AngleAxisd turn(path[i].orientation * path[i - 1].orientation.conjugate());
    const double work_j = 0.5 * (force_n + now_n).dot(path[i].position_m - path[i - 1].position_m) +
                          0.5 * (torque_nm + now_nm).dot(turn.angle() * turn.axis());
    work.gained_j += work_j;
    work.turned_over_j += std::abs(work_j);
    force_n = now_n;
    torque_nm = now_nm;
    work.always_in_contact = work.always_in_contact && state.in_contact();
    if (state.region_count == 0) continue;
    // A region continues, with its direction, while only the tool's rear is inside.
    const fast::ContactRegion& region = state.regions[0];
    work.steady = work.steady && state.region_count == 1 && (region.d + closed.touch.normal).norm() <= 1e-9;
    work.deepest_rel = std::max(work.deepest_rel, region.depth_rel);
    // The exit of a sample along -d is on the surface, whose normal there tells whether it is a plane.
    for (int k = 0; k < region.points.count && work.flat; ++k) {
      const Vec3 p_m = region.points.p_W_m(static_cast<std::size_t>(k));
      const double out_m = model.detection.exit_distance_m(*model.body, p_m, -region.d);
      const scene::SurfaceQuery above = model.body->query(p_m - out_m * region.d);
      work.flat = (above.normal + region.d).norm() <= 1e-6;
    }
  }
  if (closed.kind == PathKind::level && work.steady && work.flat) work.flat = stays_under_plane(model, closed);
  return work;
}

}  // namespace touchstone::soak
