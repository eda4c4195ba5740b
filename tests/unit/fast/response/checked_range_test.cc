// When a step says that it is beyond what was compared with the reference.
#include "fast/response/checked_range.h"

#include "fast/response/response_step.h"
#include "support/synthetic_response.h"
#include "support/two_balls.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

ResponseModel model_of(const scene::Scene& scene) {
  scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), 600);
  scene::Response response = test::synthetic_response(scene, surface, 0.0);
  return {scene, std::move(surface), std::move(response)};
}

scene::Scene ball(double radius_m, double x_m = 0.0) {
  scene::Scene scene = test::ball_on_cube();
  scene.tool.radius_m = radius_m;
  scene.track = {{0.0, test::at(x_m, 0.0, 0.06 + radius_m)}, {1.0, test::at(x_m, 0.0, 0.06 + 0.999 * radius_m)}};
  return scene;
}

/// Of a ball at a depth over its radius.
StepStatus status_of(double radius_m, double depth_over_radius, double x_m = 0.0) {
  const ResponseModel model = model_of(ball(radius_m, x_m));
  ResponseState state(model);
  return response_step(model, test::at(x_m, 0.0, 0.06 + radius_m * (1.0 - depth_over_radius)), state);
}

/// Of a ball that is pressed on the top of a ball of 30 mm, to a depth over its radius.
StepStatus status_on_sphere(double radius_m, double nu = 0.5, double depth_over_radius = 0.1) {
  scene::Scene scene = test::ball_on_sphere();
  scene.body.material.poissons_ratio = nu;
  scene.tool.radius_m = radius_m;
  const scene::Pose pressed = test::at(0.0, 0.0, 0.06 + (1.0 - depth_over_radius) * radius_m);
  scene.track = {{0.0, test::at(0.0, 0.0, 0.06 + radius_m)}, {1.0, pressed}};
  const ResponseModel model = model_of(scene);
  ResponseState state(model);
  return response_step(model, pressed, state);
}

/// Depth over radius at which a ball's contact has a radius, on a half space.
double depth_for(double radius_m, double contact_m) {
  const ResponseModel model = model_of(ball(radius_m));
  double low = 0.0, high = 1.0;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (model.tips[0].tables.front().at(middle * radius_m).radius_m < contact_m ? low : high) = middle;
  }
  return low;
}

TEST(CheckedRange, TellsWhichLimitIsPassed) {
  const CheckedRange checked = checked_range(ball(0.010));
  EXPECT_EQ(status_of(0.003, 0.99 * checked.depth_over_radius), StepStatus::ok);
  EXPECT_EQ(status_of(0.003, 1.01 * checked.depth_over_radius), StepStatus::depth_unchecked);
  EXPECT_EQ(status_of(0.028, depth_for(0.028, 0.99 * checked.size_rel * 0.06)), StepStatus::ok);
  EXPECT_EQ(status_of(0.028, depth_for(0.028, 1.01 * checked.size_rel * 0.06)), StepStatus::size_unchecked);
  // 10 mm from the edge.
  const double radius_m = 0.010 / checked.edge_over_radius;
  EXPECT_EQ(status_of(0.010, depth_for(0.010, 0.99 * radius_m), 0.020), StepStatus::ok);
  EXPECT_EQ(status_of(0.010, depth_for(0.010, 1.01 * radius_m), 0.020), StepStatus::edge_unchecked);
  // Nothing touches, nothing is beyond.
  EXPECT_EQ(status_of(0.010, -0.1, 0.020), StepStatus::ok);
}

TEST(CheckedRange, CurvedBodies) {
  const double limit_m = 0.030 * checked_range(test::ball_on_sphere()).curvature_rel;
  EXPECT_EQ(status_on_sphere(0.99 * limit_m), StepStatus::ok);
  EXPECT_EQ(status_on_sphere(1.01 * limit_m), StepStatus::curvature_unchecked);
  // The depth is limited by the body's curvature, too.
  const double depth_over_radius = checked_range(test::ball_on_sphere()).depth_curvature * 0.030 / 0.015;
  EXPECT_EQ(status_on_sphere(0.015, 0.5, 0.99 * depth_over_radius), StepStatus::ok);
  EXPECT_EQ(status_on_sphere(0.015, 0.5, 1.01 * depth_over_radius), StepStatus::depth_unchecked);
  // A cylinder's side is curved in one direction, its top in none.
  scene::Scene scene = test::ball_on_sphere();
  scene.body.shape = scene::BodyShape::revolution;
  scene.body.profile.rz_m = {{0.0, 0.0}, {0.030, 0.0}, {0.030, 0.060}, {0.0, 0.060}};
  EXPECT_LT(model_of(scene).largest_curvature_per_m.maxCoeff(), 1e-9);
  scene.track = {{0.0, test::at(0.041, 0.0, 0.030)}, {1.0, test::at(0.039, 0.0, 0.030)}};
  const ResponseModel side = model_of(scene);
  EXPECT_NEAR(side.largest_curvature_per_m.minCoeff(), 1.0 / 0.030, 0.02 / 0.030);
  EXPECT_NEAR(side.largest_curvature_per_m.maxCoeff(), 1.0 / 0.030, 0.02 / 0.030);
  // With friction no curved body was compared.
  scene.contact.friction.emplace();
  EXPECT_LT(checked_range(scene).curvature_rel, 0.01);
}

TEST(CheckedRange, PoissonsRatiosBelowOneHalf) {
  const auto status = [](double depth_over_radius, scene::Scene scene) {
    scene.body.material.poissons_ratio = 0.3;
    const ResponseModel model = model_of(scene);
    ResponseState state(model);
    return response_step(model, test::at(0.0, 0.0, 0.06 + scene.tool.radius_m * (1.0 - depth_over_radius)), state);
  };
  scene::Scene compressible = ball(0.003);
  compressible.body.material.poissons_ratio = 0.3;
  const CheckedRange checked = checked_range(compressible);
  EXPECT_EQ(status(0.99 * checked.depth_over_radius, ball(0.003)), StepStatus::ok);
  EXPECT_EQ(status(1.01 * checked.depth_over_radius, ball(0.003)), StepStatus::depth_unchecked);
  EXPECT_EQ(status_on_sphere(0.003), StepStatus::ok);
  EXPECT_EQ(status_on_sphere(0.003, 0.3), StepStatus::curvature_unchecked);
  scene::Scene rubbed = ball(0.003);
  rubbed.contact.friction.emplace();
  EXPECT_EQ(status(0.1, rubbed), StepStatus::material_unchecked);
}

TEST(CheckedRange, Inclusions) {
  scene::Scene scene = ball(0.003);
  scene::Inclusion soft;
  soft.shape = scene::BodyShape::sphere;
  soft.radius_m = 0.005;
  soft.center_m = Vec3(0.0, 0.0, 0.03);
  soft.material = {1e5, 0.33};
  scene.body.inclusions = {soft};
  const ResponseModel model = model_of(scene);
  ResponseState state(model);
  EXPECT_EQ(response_step(model, test::at(0.0, 0.0, 0.0628), state), StepStatus::inclusion_unchecked);
  // Only where it is touched.
  EXPECT_EQ(response_step(model, test::at(0.0, 0.0, 0.07), state), StepStatus::ok);
}

TEST(CheckedRange, DistancesToEdges) {
  const ResponseModel cube = model_of(ball(0.010, 0.020));
  const scene::LoadGrid& grid = cube.response.grid;
  for (int k = 0; k < grid.count(); ++k) {
    const double nearest_m = 0.030 - grid.points_m.col(k).head<2>().cwiseAbs().maxCoeff();
    EXPECT_NEAR(cube.edge_distance_m[k], nearest_m, 1e-6);
  }
  // A ball has none, its outline is no edge.
  scene::Scene scene = test::ball_on_sphere();
  EXPECT_GT(model_of(scene).edge_distance_m.minCoeff(), 1.0);
  // Of a cylinder the rim.
  scene.body.shape = scene::BodyShape::revolution;
  scene.body.profile.rz_m = {{0.0, 0.0}, {0.030, 0.0}, {0.030, 0.060}, {0.0, 0.060}};
  const ResponseModel cylinder = model_of(scene);
  for (int k = 0; k < cylinder.response.grid.count(); ++k) {
    const double nearest_m = 0.030 - cylinder.response.grid.points_m.col(k).head<2>().norm();
    EXPECT_NEAR(cylinder.edge_distance_m[k], nearest_m, 2e-3 * nearest_m);
  }
}

TEST(CheckedRange, TwoContactsTooNear) {
  const ResponseModel model = model_of(test::two_balls_on_cube());
  ResponseState state(model);
  EXPECT_EQ(response_step(model, test::both_pressed(0.0015), state), StepStatus::ok);
  const ContactRange range = contact_range(model, state, state.contacts[0], model.tips[0].tip);
  const double radii_m = state.contacts[0].law.radius_m + state.contacts[1].law.radius_m;
  EXPECT_NEAR(range.apart_over_radii, test::apart_m / radii_m, 1e-3);
  EXPECT_EQ(beyond(model.checked, {.depth_over_radius = 0.1,
                                   .size_rel = 0.01,
                                   .edge_over_radius = 10.0,
                                   .apart_over_radii = 0.99 * model.checked.apart_over_radii}),
            StepStatus::regions_unchecked);
}

}  // namespace
}  // namespace touchstone::fast
