#include "scene/response/find_tips.h"

#include "scene/response/mesh_tips.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::scene {
namespace {

/// A capsule touches with its end alone up to this tilt [rad].
constexpr double capsule_tilt_max = 0.5;

}  // namespace

std::vector<double> looked_at_s(const Scene& scene) {
  std::vector<double> times_s = instants_s(scene);
  for (const Waypoint& waypoint : scene.track) times_s.push_back(waypoint.time_s);
  std::sort(times_s.begin(), times_s.end());
  return times_s;
}

FoundTips tool_tips(const Scene& scene) {
  const Tool& tool = scene.tool;
  if (tool.shape == ToolShape::mesh) {
    FoundTips found = mesh_tips(scene, looked_at_s(scene));
    if (!found.why.empty()) return found;
    if (found.tips.empty()) return {{}, "the tool touches the body"};
    if (found.tips.size() > tips_max) return {{}, fmt::format("at most {} parts of the tool touch", tips_max)};
    if (found.tips.size() > 1 && scene.contact.friction) {
      return {{}, fmt::format("one part of the tool touches where there is friction, and not {}", found.tips.size())};
    }
    return found;
  }
  const Vec3 shift_m = -tool.mass_center_m.value_or(Vec3::Zero());  // of the shape's centre in frame T
  if (tool.shape == ToolShape::sphere) return {{ToolTip{.center_T_m = shift_m, .radius_m = tool.radius_m}}, ""};
  if (tool.shape != ToolShape::capsule && tool.shape != ToolShape::cylinder) {
    return {{}, "its tool is a ball, a capsule or cylinder that stands on its end, or a mesh"};
  }
  const bool capsule = tool.shape == ToolShape::capsule;
  if (!capsule && !(tool.edge_radius_m > 0.0)) return {{}, "a cylinder needs a rounded rim"};
  const auto body = body_shape(scene.body);
  // The end that is deeper at the deepest instant.
  ToolTip best;
  double deepest_m = -std::numeric_limits<double>::infinity();
  for (const double side : {-1.0, 1.0}) {
    ToolTip end;
    end.center_T_m = shift_m + Vec3(0.0, 0.0, side * 0.5 * tool.length_m);
    end.radius_m = capsule ? tool.radius_m : tool.edge_radius_m;
    if (!capsule) {
      end.axis_T = Vec3(0.0, 0.0, side);
      end.flat_radius_m = tool.radius_m - tool.edge_radius_m;
    }
    for (const double time_s : looked_at_s(scene)) {
      const Touch at = touch(*body, end, pose_at(scene.track, time_s));
      if (at.depth_m <= deepest_m) continue;
      deepest_m = at.depth_m;
      best = end;
    }
  }
  const Vec3 out = best.ball() ? Vec3(best.center_T_m - shift_m).normalized() : best.axis_T;
  for (const double time_s : looked_at_s(scene)) {
    const Pose pose = pose_at(scene.track, time_s);
    const Touch at = touch(*body, best, pose);
    if (at.depth_m <= 0.0) continue;
    const double tilt = std::acos(std::clamp(-(pose.orientation * out).dot(at.normal), -1.0, 1.0));
    if (tilt > (capsule ? capsule_tilt_max : tilt_max)) return {{}, "its tool stands on its end, upright"};
  }
  return {{best}, ""};
}

}  // namespace touchstone::scene
