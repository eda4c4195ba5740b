// Small scenes for the reference's extremes: a ball on a ball in the meridian plane, solved on coarse meshes.
#pragma once

#include "reference/solver.h"
#include "scene/base/error.h"
#include "scene/shape/surface.h"
#include "support/ball_on_ball.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace touchstone::reference::extremes {

using scene::Vec3;

inline scene::Waypoint at(double time_s, const Vec3& position_m) {
  return {time_s, {position_m, Eigen::Quaterniond::Identity()}};
}

/// A ball of 10 mm pressed 4 mm into a ball of 30 mm; axisymmetric.
inline scene::Scene ball_on_ball() {
  scene::Scene scene = ball_on_ball_scene({{0.0, 0.0705}, {1.0, 0.066}}, 4);
  scene.reference.levels = 1;
  return scene;
}

/// The same with lengths times a factor.
inline scene::Scene scaled(scene::Scene scene, double factor) {
  for (double* length_m : {&scene.body.radius_m, &scene.body.support_height_m, &scene.tool.radius_m}) {
    *length_m *= factor;
  }
  if (scene.reference.element_size_m) *scene.reference.element_size_m *= factor;
  for (scene::Waypoint& w : scene.track) w.pose.position_m *= factor;
  return scene;
}

/// Solves into a store that is gone afterwards, and looks at what must hold of every answer: numbers, balance, no pull.
inline Result solved(const scene::Scene& scene) {
  static std::atomic<int> count = 0;
  const std::filesystem::path store =
      std::filesystem::temp_directory_path() /
      ("touchstone-extremes-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
  Options options;
  options.store = store;
  const Result result = solve(scene, scene::tessellate(*scene::body_shape(scene.body), 200).points_m, options);
  std::filesystem::remove_all(store);
  for (std::size_t i = 0; i < result.instants.size(); ++i) {
    const scene::InstantRecord& instant = result.instants[i];
    EXPECT_TRUE(instant.force_n().allFinite()) << i;
    EXPECT_TRUE(instant.displacement_m.allFinite()) << i;
    if (!scene.contact.friction) {
      EXPECT_GE(instant.force_n().z(), 0.0) << i << ": the body pulls";
    }
    if (instant.force_n().norm() > 0.0) {
      EXPECT_LT(result.instants[i].equilibrium_rel, 1e-6) << i << ": out of balance";
    }
  }
  return result;
}

/// Magnitude of the force at the last instant [N].
inline double last_n(const Result& result) { return result.instants.back().force_n().norm(); }

/// The largest displacement of a rest point at an instant [m].
inline double moved_m(const scene::InstantRecord& instant) {
  return instant.displacement_m.colwise().norm().maxCoeff();
}

}  // namespace touchstone::reference::extremes
