// A tool that touches with two balls: a mesh of two pieces.
#pragma once

#include "scene/shape/sphere.h"
#include "support/mesh_tools.h"
#include "support/press.h"

#include <memory>

namespace touchstone::test {

/// Radii and centres, in the tool's frame: the lowest points are at one height.
inline constexpr double left_m = 0.004, right_m = 0.003, apart_m = 0.030;

/// @param left_first  which piece comes first in the mesh
inline scene::Tool two_balls(bool left_first = true) {
  auto both = std::make_shared<scene::TriangleMesh>();
  const auto add = [&](double x_m, double radius_m) {
    const auto one = mesh_of(scene::Sphere(scene::Vec3(x_m, 0.0, radius_m), radius_m), 3000);
    const auto begin = both->points_m.cols();
    both->points_m.conservativeResize(3, begin + one->points_m.cols());
    both->points_m.rightCols(one->points_m.cols()) = one->points_m;
    for (const auto& t : one->triangles) {
      const auto shift = static_cast<std::int32_t>(begin);
      both->triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    }
  };
  if (left_first) add(-0.5 * apart_m, left_m);
  add(0.5 * apart_m, right_m);
  if (!left_first) add(-0.5 * apart_m, left_m);
  scene::Tool tool;
  tool.shape = scene::ToolShape::mesh;
  tool.mesh = both;
  tool.mass_kg = 1.0;
  tool.mass_center_m = scene::Vec3(0.0, 0.0, 0.010);
  return tool;
}

/// The tool's lowest points this deep below the top of the 60 mm cube, where it is upright.
inline scene::Pose both_pressed(double depth_m, double x_m = 0.0, double y_m = 0.0, double turn_y = 0.0) {
  scene::Pose pose = at(x_m, y_m, 0.060 + 0.010 - depth_m);
  pose.orientation = Eigen::AngleAxisd(turn_y, scene::Vec3::UnitY());
  return pose;
}

inline scene::Scene two_balls_on_cube(bool left_first = true) {
  scene::Scene scene = ball_on_cube();
  scene.tool = two_balls(left_first);
  scene.track = {{0.0, both_pressed(-0.001, -0.002, -0.002, -0.05)},
                 {0.5, both_pressed(0.002, -0.002, -0.002)},
                 {1.0, both_pressed(0.0015, 0.002, 0.002, 0.05)}};
  scene.fast.triangles = 1200;
  return scene;
}

}  // namespace touchstone::test
