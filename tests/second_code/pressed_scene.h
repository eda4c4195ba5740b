// A ball pressed on a body of rubber, for both codes.
#pragma once

#include "scene/model/scene.h"

namespace touchstone::second_code {

/// A ball of 10 mm radius, straight down onto the body's top in equal steps to a depth.
inline scene::Scene pressed(const scene::Body& body, double depth_m, int steps) {
  scene::Scene scene;
  scene.name = "pressed";
  scene.body = body;
  scene.tool.radius_m = 0.01;
  const double top_m = scene::body_shape(body)->bounds().upper_m.z();
  const auto at = [&](double time_s, double below_m) {
    return scene::Waypoint{time_s, {{0.0, 0.0, top_m + scene.tool.radius_m - below_m}, Eigen::Quaterniond::Identity()}};
  };
  scene.track = {at(0.0, -depth_m / steps), at(1.0, depth_m)};
  scene.compare.instants = steps + 2;
  scene.reference.levels = 3;
  return scene;
}

inline scene::Body cylinder(double poissons_ratio) {
  scene::Body body;
  body.shape = scene::BodyShape::revolution;
  body.profile.rz_m = {{0.0, 0.0}, {0.05, 0.0}, {0.05, 0.05}, {0.0, 0.05}};
  body.material = {3e6, poissons_ratio};
  return body;
}

/// A ball ten times softer inside, 15 mm below the top.
inline scene::Body cylinder_around_soft_ball(double poissons_ratio) {
  scene::Body body = cylinder(poissons_ratio);
  scene::Inclusion inclusion;
  inclusion.shape = scene::BodyShape::sphere;
  inclusion.radius_m = 0.008;
  inclusion.center_m = {0.0, 0.0, 0.035};
  inclusion.material = {3e5, poissons_ratio};
  body.inclusions = {inclusion};
  return body;
}

inline scene::Body ball(double poissons_ratio) {
  scene::Body body;
  body.shape = scene::BodyShape::sphere;
  body.radius_m = 0.03;
  body.support_height_m = 0.005;
  body.material = {3e6, poissons_ratio};
  return body;
}

inline scene::Body block(double poissons_ratio) {
  scene::Body body;
  body.size_m = scene::Vec3::Constant(0.06);
  body.material = {3e6, poissons_ratio};
  return body;
}

}  // namespace touchstone::second_code
