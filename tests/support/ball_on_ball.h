// The smallest scene that the reference solves: a ball on a ball, in the meridian plane.
#pragma once

#include "scene/model/scene.h"

#include <utility>
#include <vector>

namespace touchstone::reference {

/// A ball of 10 mm on a ball of 30 mm, in contact below a height of 70 mm.
/// @param heights  times [s] and heights of the tool's centre [m]
inline scene::Scene ball_on_ball_scene(const std::vector<std::pair<double, double>>& heights, int instants,
                                       double poissons_ratio = 0.45) {
  scene::Scene scene;
  scene.name = "ball-on-ball";
  scene.body.shape = scene::BodyShape::sphere;
  scene.body.radius_m = 0.03;
  scene.body.support_height_m = 0.006;
  scene.body.material = {3e6, poissons_ratio};
  scene.tool.radius_m = 0.01;
  for (const auto& [time_s, z_m] : heights) {
    scene.track.push_back({time_s, {{0.0, 0.0, z_m}, Eigen::Quaterniond::Identity()}});
  }
  scene.compare.instants = instants;
  scene.reference.element_size_m = 0.003;
  return scene;
}

/// Pressed and taken off again, on two meshes.
inline scene::Scene press_and_release() {
  scene::Scene scene = ball_on_ball_scene({{0.0, 0.0705}, {1.0, 0.0665}, {2.0, 0.0705}}, 9);
  scene.reference.levels = 2;
  return scene;
}

}  // namespace touchstone::reference
