#include "scene/scene.h"

#include <algorithm>

namespace touchstone::scene {

std::unique_ptr<const Shape> body_shape(const Body& body) {
  switch (body.shape) {
    case BodyShape::box:
      return std::make_unique<Box>(Vec3(0.0, 0.0, 0.5 * body.size_m.z()), body.size_m);
    case BodyShape::sphere:
      return std::make_unique<Sphere>(Vec3(0.0, 0.0, body.radius_m), body.radius_m);
    default:
      break;
  }
  return nullptr;
}

std::unique_ptr<const Shape> tool_shape(const Tool& tool) {
  switch (tool.shape) {
    case ToolShape::sphere:
      return std::make_unique<Sphere>(Vec3::Zero(), tool.radius_m);
    default:
      break;
  }
  return nullptr;
}

Pose pose_at(const std::vector<Waypoint>& track, double time_s) {
  const auto after = std::find_if(track.begin(), track.end(), [&](const Waypoint& w) { return w.time_s > time_s; });
  if (after == track.begin()) return track.front().pose;
  const Waypoint& a = *(after - 1);
  if (after == track.end()) return a.pose;
  const double s = (time_s - a.time_s) / (after->time_s - a.time_s);
  return {(1.0 - s) * a.pose.position_m + s * after->pose.position_m,
          a.pose.orientation.slerp(s, after->pose.orientation)};
}

std::vector<double> instants_s(const Scene& scene) {
  const double begin_s = scene.track.front().time_s;
  const double end_s = scene.track.back().time_s;
  std::vector<double> times;
  for (int i = 0; i < scene.compare.instants; ++i) {
    times.push_back(begin_s + (end_s - begin_s) * i / (scene.compare.instants - 1));
  }
  return times;
}

double rest_depth_m(const Shape& body, const Tool& tool, const Pose& pose) {
  // A ball's deepest point lies along the gradient at its centre, so this is exact for a convex body.
  return std::max(0.0, tool.radius_m - body.signed_distance_m(pose.position_m));
}

}  // namespace touchstone::scene
