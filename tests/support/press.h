// Hand-made scenes for the fast model's tests: a ball of 10 mm pressed on a 60 mm rubber cube, as in the paper's
// Fig. 13.
#pragma once

#include "scene/model/scene.h"

#include <numbers>

namespace touchstone::test {

inline scene::Pose at(double x_m, double y_m, double z_m) {
  return {scene::Vec3(x_m, y_m, z_m), Eigen::Quaterniond::Identity()};
}

/// The ball with its lowest point this deep below the top of the cube.
inline scene::Pose pressed(double depth_m, double x_m = 0.0, double y_m = 0.0) {
  return at(x_m, y_m, 0.060 + 0.010 - depth_m);
}

inline scene::Scene ball_on_cube(scene::Formulation formulation = scene::Formulation::corrected) {
  scene::Scene scene;
  scene.name = "ball-on-cube";
  scene.body.shape = scene::BodyShape::box;
  scene.body.size_m = scene::Vec3(0.06, 0.06, 0.06);
  scene.body.material = {3.0e6, 0.5};
  scene.tool.radius_m = 0.010;
  scene.tool.mass_kg = 1.0;
  scene.track = {{0.0, pressed(-0.0005)}, {0.5, pressed(0.006)}};
  scene.contact.k1_n_per_m = 40.0;
  scene.contact.k3_n_per_m3 = 3.0e8;
  scene.fast.formulation = formulation;
  scene.fast.triangles = 3952;
  scene.fast.tool_samples = 2000;
  scene.fast.rate_hz = 1000.0;
  scene.contact.r_th_m = 0.004;
  scene.fast.r_R_m = 0.015;
  scene.fast.C_n = 0.2;
  scene.fast.C_r_m = 0.002;
  scene.fast.s_c_m2 = 1.0e-3;
  scene.compare.instants = 14;
  return scene;
}

/// The same ball on a rubber sphere of 30 mm, fixed below 5 mm.
inline scene::Scene ball_on_sphere(scene::Formulation formulation = scene::Formulation::corrected) {
  scene::Scene scene = ball_on_cube(formulation);
  scene.name = "ball-on-sphere";
  scene.body.shape = scene::BodyShape::sphere;
  scene.body.radius_m = 0.030;
  scene.body.support_height_m = 0.005;
  return scene;
}

/// A ball with its mass centre at its centre.
inline scene::Tool ball(double radius_m) {
  scene::Tool tool;
  tool.shape = scene::ToolShape::sphere;
  tool.radius_m = radius_m;
  return tool;
}

/// A rotation about no special axis.
inline Eigen::Quaterniond tilted() {
  return Eigen::Quaterniond(Eigen::AngleAxisd(1.1, scene::Vec3(0.3, -0.7, 0.5).normalized()));
}

}  // namespace touchstone::test
