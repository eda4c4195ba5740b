#include "scene/model/scene.h"

#include <gtest/gtest.h>

namespace touchstone::scene {
namespace {

std::vector<Waypoint> two_poses() {
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(1.0, Vec3::UnitX()));
  return {{1.0, {Vec3(0, 0, 1), Eigen::Quaterniond::Identity()}}, {3.0, {Vec3(2, 0, 0), quarter}}};
}

TEST(Track, IsLinearBetweenPosesAndHeldOutside) {
  const auto track = two_poses();
  EXPECT_TRUE(pose_at(track, 1.5).position_m.isApprox(Vec3(0.5, 0, 0.75)));
  EXPECT_NEAR(Eigen::AngleAxisd(pose_at(track, 1.5).orientation).angle(), 0.25, 1e-12);
  EXPECT_EQ(pose_at(track, 0.0).position_m, Vec3(0, 0, 1));
  EXPECT_EQ(pose_at(track, 9.0).position_m, Vec3(2, 0, 0));
  EXPECT_EQ(pose_at(track, 3.0).position_m, Vec3(2, 0, 0));
}

TEST(Track, InstantsIncludeBothEnds) {
  Scene scene;
  scene.track = two_poses();
  scene.compare.instants = 5;
  EXPECT_EQ(instants_s(scene), (std::vector<double>{1.0, 1.5, 2.0, 2.5, 3.0}));
}

TEST(RestDepth, IsTheBallsDeepestPoint) {
  const Box box(Vec3(0, 0, 0.03), Vec3(0.06, 0.06, 0.06));
  Tool tool;
  tool.radius_m = 0.01;
  EXPECT_NEAR(rest_depth_m(box, tool, {Vec3(0, 0, 0.065), Eigen::Quaterniond::Identity()}), 0.005, 1e-15);
  EXPECT_EQ(rest_depth_m(box, tool, {Vec3(0, 0, 0.0701), Eigen::Quaterniond::Identity()}), 0.0);
  // Over an edge the depth is measured along the diagonal.
  const double beyond = 0.003 / std::sqrt(2.0);
  EXPECT_NEAR(rest_depth_m(box, tool, {Vec3(0.03 + beyond, 0, 0.06 + beyond), Eigen::Quaterniond::Identity()}), 0.007,
              1e-15);
}

}  // namespace
}  // namespace touchstone::scene
