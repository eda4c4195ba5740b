#include "scene/response/find_tips.h"

#include "scene/response/mesh_tips.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace touchstone::scene {
namespace {

/// At every time at which it touches, a disc or a line lies flat.
bool lies_flat(const Scene& scene, const Shape& body, const ToolTip& tip) {
  for (const double time_s : looked_at_s(scene)) {
    const Pose pose = pose_at(scene.track, time_s);
    bool touches = false;
    for (const double side : {-1.0, 0.0, 1.0}) {
      ToolTip end = tip;
      end.center_T_m += side * tip.half_line_T_m;
      touches = touches || touch(body, end, pose).depth_m > 0.0;
    }
    if (touches && touch(body, tip, pose).tilt > tilt_max) return false;
  }
  return true;
}

/// A capsule touches with the half ball at its end alone: where it touches is not beyond the ball's equator. The
/// contact's rim is not further up than two thirds of the depth (touches_rel of mesh_tips.cc).
bool stands_on_end(const Scene& scene, const Shape& body, const ToolTip& end, const Vec3& out_T) {
  for (const double time_s : looked_at_s(scene)) {
    const Pose pose = pose_at(scene.track, time_s);
    const Touch at = touch(body, end, pose);
    if (at.depth_m <= 0.0) continue;
    const double tilt = std::acos(std::clamp(-(pose.orientation * out_T).dot(at.normal), -1.0, 1.0));
    const double rim = std::acos(std::max(0.0, 1.0 - 2.0 / 3.0 * at.depth_m / end.radius_m));
    if (tilt + rim > 0.5 * std::numbers::pi) return false;
  }
  return true;
}

/// The body is a plane below all of a line, at every time at which it touches.
bool on_a_plane(const Scene& scene, const Shape& body, const ToolTip& line) {
  for (const double time_s : looked_at_s(scene)) {
    const Pose pose = pose_at(scene.track, time_s);
    const Touch at = touch(body, line, pose);
    if (at.depth_m <= 0.0) continue;
    for (const double side : {-1.0, 1.0}) {
      ToolTip end = line;
      end.center_T_m += side * (1.0 + line.radius_m / line.half_line_T_m.norm()) * line.half_line_T_m;
      const Touch there = touch(body, end, pose);
      const double off_m = (there.point_m - at.point_m).dot(at.normal);
      if ((there.normal - at.normal).norm() > 1e-6 || std::abs(off_m) > 1e-6 * line.radius_m) return false;
    }
  }
  return true;
}

/// Of two ends of a tool the one that is deeper at the deepest instant.
ToolTip deeper(const Scene& scene, const Shape& body, const std::array<ToolTip, 2>& ends) {
  std::array<double, 2> deepest_m{-INFINITY, -INFINITY};
  for (const double time_s : looked_at_s(scene)) {
    for (std::size_t i = 0; i < 2; ++i) {
      deepest_m[i] = std::max(deepest_m[i], touch(body, ends[i], pose_at(scene.track, time_s)).depth_m);
    }
  }
  return ends[deepest_m[1] > deepest_m[0] ? 1 : 0];
}

FoundTips capsule_tips(const Scene& scene, const Vec3& center_m) {
  const auto body = body_shape(scene.body);
  const Vec3 half_m(0.0, 0.0, 0.5 * scene.tool.length_m);
  const double radius_m = scene.tool.radius_m;
  const ToolTip end = deeper(scene, *body,
                             {ToolTip{.center_T_m = center_m - half_m, .radius_m = radius_m},
                              ToolTip{.center_T_m = center_m + half_m, .radius_m = radius_m}});
  if (stands_on_end(scene, *body, end, (end.center_T_m - center_m).normalized())) return {{end}, ""};
  const ToolTip line{.center_T_m = center_m, .half_line_T_m = half_m, .radius_m = radius_m};
  if (!lies_flat(scene, *body, line)) return {{}, "its capsule stands on its end or lies on its side"};
  if (!on_a_plane(scene, *body, line)) return {{}, "a capsule on its side lies on a flat face"};
  if (scene.contact.friction) return {{}, "a capsule on its side has no friction"};
  return {{line}, ""};
}

}  // namespace

std::vector<double> looked_at_s(const Scene& scene) {
  std::vector<double> times_s = instants_s(scene);
  for (const Waypoint& waypoint : scene.track) times_s.push_back(waypoint.time_s);
  std::sort(times_s.begin(), times_s.end());
  return times_s;
}

FoundTips tool_tips(const Scene& scene) {
  const Tool& tool = scene.tool;
  const std::string upright = "its tool stands on its flat end, upright";
  if (tool.shape == ToolShape::mesh) {
    FoundTips found = mesh_tips(scene, looked_at_s(scene));
    if (!found.why.empty()) return found;
    if (found.tips.empty()) return {{}, "the tool touches the body"};
    if (found.tips.size() > tips_max) return {{}, fmt::format("at most {} parts of the tool touch", tips_max)};
    if (found.tips.size() > 1 && scene.contact.friction) {
      return {{}, fmt::format("one part of the tool touches where there is friction, and not {}", found.tips.size())};
    }
    const bool balls = std::ranges::all_of(found.tips, &ToolTip::ball);
    if (!balls && found.tips.size() > 1) return {{}, "parts of the tool that touch beside others are parts of balls"};
    if (!balls && !lies_flat(scene, *body_shape(scene.body), found.tips.front())) return {{}, upright};
    return found;
  }
  const Vec3 shift_m = -tool.mass_center_m.value_or(Vec3::Zero());  // of the shape's centre in frame T
  if (tool.shape == ToolShape::sphere) return {{ToolTip{.center_T_m = shift_m, .radius_m = tool.radius_m}}, ""};
  if (tool.shape == ToolShape::capsule) return capsule_tips(scene, shift_m);
  if (tool.shape != ToolShape::cylinder) {
    return {{}, "its tool is a ball, a capsule, a cylinder that stands on its end, or a mesh"};
  }
  if (!(tool.edge_radius_m > 0.0)) return {{}, "a cylinder needs a rounded rim"};
  const auto body = body_shape(scene.body);
  const auto end = [&](double side) {
    return ToolTip{.center_T_m = shift_m + Vec3(0.0, 0.0, side * 0.5 * tool.length_m),
                   .axis_T = Vec3(0.0, 0.0, side),
                   .flat_radius_m = tool.radius_m - tool.edge_radius_m,
                   .radius_m = tool.edge_radius_m};
  };
  const ToolTip best = deeper(scene, *body, {end(-1.0), end(1.0)});
  if (!lies_flat(scene, *body, best)) return {{}, upright};
  return {{best}, ""};
}

}  // namespace touchstone::scene
