#include "scene/model/scene.h"

#include <algorithm>
#include <cmath>

namespace touchstone::scene {

std::unique_ptr<const Shape> tool_shape(const Tool& tool) {
  const Vec3 center_T_m = -tool.mass_center_m.value_or(Vec3::Zero());
  switch (tool.shape) {
    case ToolShape::sphere:
      return std::make_unique<Sphere>(center_T_m, tool.radius_m);
    case ToolShape::capsule:
      return std::make_unique<Revolution>(capsule_profile(tool.radius_m, tool.length_m), center_T_m);
    case ToolShape::cylinder:
      return std::make_unique<Revolution>(cylinder_profile(tool.radius_m, tool.length_m, tool.edge_radius_m),
                                          center_T_m);
    case ToolShape::box:
      return std::make_unique<Box>(center_T_m, tool.size_m);
    case ToolShape::mesh:
      return nullptr;
  }
  return nullptr;
}

TriangleMesh tool_mesh(const Tool& tool) {
  TriangleMesh mesh = *tool.mesh;
  const Vec3 center_m = tool.mass_center_m ? *tool.mass_center_m : mesh.centroid_m();
  mesh.points_m.colwise() -= center_m;
  return mesh;
}

Pose pose_at(const std::vector<Waypoint>& track, double time_s) {
  const auto after = std::upper_bound(track.begin(), track.end(), time_s,
                                      [](double t_s, const Waypoint& w) { return t_s < w.time_s; });
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

Surface tool_surface(const Tool& tool, int triangles) {
  if (tool.shape == ToolShape::mesh) return surface_of(tool_mesh(tool));
  return tessellate(*tool_shape(tool), triangles);
}

double body_size_m(const Body& body) {
  const Bounds bounds = body_shape(body)->bounds();
  return std::cbrt((bounds.upper_m - bounds.lower_m).prod());
}

}  // namespace touchstone::scene
