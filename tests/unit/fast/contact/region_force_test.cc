#include "fast/contact/region_force.h"

#include "support/points.h"
#include "support/press.h"

#include <gtest/gtest.h>

namespace touchstone::fast {
namespace {

using scene::Vec3;

test::OwnedPoints two_points() {
  test::OwnedPoints points(2);
  points.count = 2;
  const double x_T_m[] = {0.002, -0.001}, y_T_m[] = {0.0, 0.003}, z_T_m[] = {-0.01, -0.009};
  const double depth_m[] = {0.003, 0.001}, share[] = {0.25, 0.75};
  for (std::size_t i = 0; i < 2; ++i) {
    points.x_T_m[i] = x_T_m[i];
    points.y_T_m[i] = y_T_m[i];
    points.z_T_m[i] = z_T_m[i];
    points.depth_m[i] = depth_m[i];
    points.share[i] = share[i];
  }
  return points;
}

TEST(RegionForce, IsTheWeightedSumAgainstTheDirection) {
  const DuffingLaw law(40.0, 3e8);
  const Vec3 d = Vec3(0.6, 0.0, -0.8);
  const scene::Mat3 R_WT = test::tilted().toRotationMatrix();
  const test::OwnedPoints points = two_points();
  const RegionForce force = region_force(law, R_WT, d, points);
  const double F1 = 0.25 * law.force_n(0.003), F2 = 0.75 * law.force_n(0.001);
  EXPECT_NEAR(force.magnitude_n, F1 + F2, 1e-15);
  EXPECT_LT((force.force_n - -(F1 + F2) * d).norm(), 1e-15);
  const Vec3 moment =
      (R_WT * Vec3(0.002, 0.0, -0.01)).cross(-F1 * d) + (R_WT * Vec3(-0.001, 0.003, -0.009)).cross(-F2 * d);
  EXPECT_LT((force.torque_nm - moment).norm(), 1e-16);
  EXPECT_FALSE(force.saturated);
}

TEST(RegionForce, BothPartsActAtTheLoadsCentre) {
  const DuffingLaw law(40.0, 3e8);
  const scene::Mat3 R_WT = test::tilted().toRotationMatrix();
  const Vec3 d = Vec3(0.6, 0.0, -0.8), along = Vec3(0.8, 0.0, 0.6);
  const test::OwnedPoints points = two_points();
  RegionForce force = region_force(law, R_WT, d, points);
  EXPECT_EQ(force.normal_n, force.magnitude_n);
  EXPECT_EQ(force.tangential_n, Vec3::Zero());
  set_force(d, 3.0, 4.0 * along, force);
  EXPECT_NEAR(force.magnitude_n, 5.0, 1e-15);
  EXPECT_LT((force.force_n - (4.0 * along - 3.0 * d)).norm(), 1e-15);
  // Each point carries the part of the whole that it has of the force along d.
  const double F1 = 0.25 * law.force_n(0.003), F2 = 0.75 * law.force_n(0.001);
  const Vec3 moment = (R_WT * Vec3(0.002, 0.0, -0.01)).cross(F1 / (F1 + F2) * force.force_n) +
                      (R_WT * Vec3(-0.001, 0.003, -0.009)).cross(F2 / (F1 + F2) * force.force_n);
  EXPECT_LT((force.torque_nm - moment).norm(), 1e-16);
}

TEST(RegionForce, DepthScaleDeepensEveryPoint) {
  const DuffingLaw law(40.0, 3e8);
  const test::OwnedPoints points = two_points();
  const RegionLoad load = region_load(law, points, 2.0);
  EXPECT_NEAR(load.force_n, 0.25 * law.force_n(0.006) + 0.75 * law.force_n(0.002), 1e-15 * load.force_n);
  EXPECT_EQ(load.deepest_m, 0.006);
}

TEST(RegionForce, WithoutDepthThereIsNone) {
  const DuffingLaw law(40.0, 3e8);
  test::OwnedPoints points = two_points();
  points.depth_m[0] = points.depth_m[1] = 0.0;
  const RegionForce force = region_force(law, scene::Mat3::Identity(), -Vec3::UnitZ(), points);
  EXPECT_EQ(force.magnitude_n, 0.0);
  EXPECT_EQ(force.force_n, Vec3::Zero());
  EXPECT_EQ(force.torque_nm, Vec3::Zero());
}

TEST(RegionForce, SaysWhenTheLawIsSaturated) {
  const test::OwnedPoints points = two_points();
  const DuffingLaw law(40.0, -40.0 / (3.0 * 0.002 * 0.002));  // peak at 2 mm
  EXPECT_TRUE(region_force(law, scene::Mat3::Identity(), -Vec3::UnitZ(), points).saturated);
}

}  // namespace
}  // namespace touchstone::fast
