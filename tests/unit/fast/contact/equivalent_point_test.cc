#include "fast/contact/equivalent_point.h"

#include "fast/step/step.h"
#include "support/points.h"
#include "support/press.h"

#include <gtest/gtest.h>

namespace touchstone::fast {
namespace {

using scene::Vec3;

TEST(EquivalentPoint, OriginIsUnderTheToolOnTheRestSurface) {
  const FastModel model(test::ball_on_cube());
  FastState state(model);
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.004, -0.011}, {0.015, 0.010}}) {
    step(model, test::pressed(-0.001, x, y), state);
    step(model, test::pressed(0.003, x, y), state);
    EXPECT_EQ(state.regions[0].origin.patch, 5);
    EXPECT_LT((state.regions[0].origin.p0_W_m - Vec3(x, y, 0.060)).norm(), 1e-12);
    EXPECT_EQ(state.regions[0].origin.normal, Vec3::UnitZ());
  }
}

TEST(EquivalentPoint, OriginOnASphereIsTakenOutToTheSurface) {
  const FastModel model(test::ball_on_sphere());
  FastState state(model);
  const Vec3 out = Vec3(0.3, 0.4, 0.8).normalized();
  for (const double gap_m : {0.001, -0.003}) {
    step(model, {Vec3(0.0, 0.0, 0.030) + (0.040 + gap_m) * out, test::tilted()}, state);
  }
  ASSERT_TRUE(state.in_contact());
  EXPECT_NEAR(model.body->signed_distance_m(state.regions[0].origin.p0_W_m), 0.0, 1e-15);
  EXPECT_LT((state.regions[0].origin.p0_W_m - (Vec3(0.0, 0.0, 0.030) + 0.030 * out)).norm(), 2e-4);
  EXPECT_GT(state.regions[0].origin.normal.dot(out), 0.999);
}

TEST(EquivalentPoint, OriginIsTakenOutAlongTheDirectionOfDeformation) {
  const scene::Box box(Vec3(0.0, 0.0, 0.03), Vec3(0.06, 0.06, 0.06));
  RegionExtent extent;
  extent.center_W_m = Vec3(0.001, 0.002, 0.058);
  const DeformationOrigin origin =
      deformation_origin(box, detection_for(box).exit_distance_m, Vec3(0.6, 0.0, -0.8), extent);
  EXPECT_LT((origin.p0_W_m - Vec3(0.001 - 0.0015, 0.002, 0.060)).norm(), 1e-15);
}

TEST(EquivalentPoint, DisplacementGivesTheRegionsForce) {
  const FastModel model(test::ball_on_cube());
  FastState state(model);
  step(model, test::pressed(-0.001), state);
  for (const double depth_m : {0.001, 0.003, 0.006}) {
    step(model, test::pressed(depth_m), state);
    const double F = state.regions[0].force.magnitude_n;
    EXPECT_NEAR(model.law.at(0.0).force_n(state.regions[0].displacement_m.norm()), F, 1e-14 * F);
    EXPECT_LT(state.regions[0].displacement_m.norm(), depth_m);
    EXPECT_GT(state.regions[0].displacement_m.norm(), 0.3 * depth_m);
  }
}

TEST(EquivalentPoint, DepthsAreHeldWithinTheLimit) {
  test::OwnedPoints points(3);
  points.count = 3;
  for (std::size_t i = 0; i < 3; ++i) points.depth_m[i] = 0.001 * static_cast<double>(i + 1);
  EXPECT_FALSE(limit_depths(0.003, points));
  EXPECT_TRUE(limit_depths(0.0015, points));
  EXPECT_EQ((std::vector<double>(points.depth_m, points.depth_m + 3)), (std::vector<double>{0.001, 0.0015, 0.0015}));
}

}  // namespace
}  // namespace touchstone::fast
