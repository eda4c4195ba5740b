#include "fast/region_force.h"

#include "unit/fast/press.h"

#include <gtest/gtest.h>

namespace touchstone::fast {
namespace {

using scene::Vec3;

RegionPoints two_points() {
  RegionPoints points(2);
  points.count = 2;
  points.x_T_m = {0.002, -0.001};
  points.y_T_m = {0.0, 0.003};
  points.z_T_m = {-0.01, -0.009};
  points.depth_m = {0.003, 0.001};
  points.share = {0.25, 0.75};
  return points;
}

TEST(RegionForce, IsTheWeightedSumAgainstTheDirection) {
  const DuffingLaw law(40.0, 3e8);
  const Vec3 d = Vec3(0.6, 0.0, -0.8);
  const scene::Mat3 R_WT = test::tilted().toRotationMatrix();
  const RegionPoints points = two_points();
  const RegionForce force = region_force(law, R_WT, d, points);
  const double F1 = 0.25 * law.force_n(0.003), F2 = 0.75 * law.force_n(0.001);
  EXPECT_NEAR(force.magnitude_n, F1 + F2, 1e-15);
  EXPECT_LT((force.force_n - -(F1 + F2) * d).norm(), 1e-15);
  const Vec3 moment =
      (R_WT * Vec3(0.002, 0.0, -0.01)).cross(-F1 * d) + (R_WT * Vec3(-0.001, 0.003, -0.009)).cross(-F2 * d);
  EXPECT_LT((force.torque_nm - moment).norm(), 1e-16);
  EXPECT_FALSE(force.saturated);
}

TEST(RegionForce, SaysWhenTheLawIsSaturated) {
  const RegionPoints points = two_points();
  const DuffingLaw law(40.0, -40.0 / (3.0 * 0.002 * 0.002));  // peak at 2 mm
  EXPECT_TRUE(region_force(law, scene::Mat3::Identity(), -Vec3::UnitZ(), points).saturated);
}

}  // namespace
}  // namespace touchstone::fast
