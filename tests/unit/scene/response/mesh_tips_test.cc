// Balls and flat discs in the meshes of tools, and the parts of other tools that touch.
#include "scene/response/mesh_tips.h"

#include "scene/response/find_tips.h"
#include "scene/response/response.h"
#include "support/press.h"
#include "support/shipped_scenes.h"
#include "support/two_balls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

namespace touchstone::scene {
namespace {

using ::testing::HasSubstr;

TEST(MeshTips, AreTheBallsThatTouch) {
  for (const bool left_first : {true, false}) {
    const FoundTips found = tool_tips(test::two_balls_on_cube(left_first));
    EXPECT_EQ(found.why, "");
    ASSERT_EQ(found.tips.size(), 2u);
    const ToolTip &left = found.tips[left_first ? 0 : 1], &right = found.tips[left_first ? 1 : 0];
    // Facets lie inside the ball that has their corners, by 0.5 % of its radius at most.
    EXPECT_NEAR(left.radius_m, test::left_m, 0.003 * test::left_m);
    EXPECT_LT(left.radius_m, test::left_m);
    EXPECT_NEAR(right.radius_m, test::right_m, 0.003 * test::right_m);
    EXPECT_LT((left.center_T_m - Vec3(-0.015, 0.0, -0.006)).norm(), 2e-5);
    EXPECT_LT((right.center_T_m - Vec3(0.015, 0.0, -0.007)).norm(), 2e-5);
    EXPECT_TRUE(left.ball());
  }
  // One that never touches is none.
  Scene scene = test::two_balls_on_cube();
  for (Waypoint& waypoint : scene.track) waypoint.pose = test::both_pressed(-0.0002, 0.0, 0.0, -0.06);
  ASSERT_EQ(tool_tips(scene).tips.size(), 1u);
  EXPECT_LT(tool_tips(scene).tips.front().center_T_m.x(), 0.0);
  for (Waypoint& waypoint : scene.track) waypoint.pose = test::both_pressed(-0.005);
  EXPECT_THAT(tool_tips(scene).why, HasSubstr("the tool touches the body"));
}

TEST(MeshTips, OneBallThatRollsIsOneTip) {
  Scene scene = test::two_balls_on_cube();
  scene.track = {{0.0, test::both_pressed(-0.0002, 0.0, 0.0, -0.06)},
                 {1.0, test::both_pressed(-0.0002, 0.0, 0.0, -0.06)}};
  const Eigen::Quaterniond first = scene.track[0].pose.orientation;
  // About the left ball's centre by more than the contact is wide.
  const Vec3 left_m(-0.015, 0.0, -0.006);
  Pose& turned = scene.track[1].pose;
  const Vec3 center_m = first * left_m + turned.position_m;
  turned.orientation = Eigen::AngleAxisd(-2.0, Vec3::UnitY()) * first;
  turned.position_m = center_m - turned.orientation * left_m;
  scene.compare.instants = 2;
  EXPECT_EQ(tool_tips(scene).why, "");
  EXPECT_EQ(tool_tips(scene).tips.size(), 1u);
}

TEST(MeshTips, OfTheShippedTools) {
  const Scene compass = test::shipped_scene("compass-two-pins", Formulation::response);
  const FoundTips pins = tool_tips(compass);
  EXPECT_EQ(response_needs(compass), "");
  ASSERT_EQ(pins.tips.size(), 2u);
  for (const ToolTip& pin : pins.tips) {
    EXPECT_NEAR(pin.radius_m, 0.0025, 0.003 * 0.0025);
    EXPECT_NEAR(std::abs(pin.center_T_m.x()), 0.012, 1e-5);
    EXPECT_NEAR(pin.center_T_m.y(), 0.0, 1e-5);
    EXPECT_NEAR(pin.center_T_m.z(), 0.0025 - 0.024140, 2e-5);
  }
  const FoundTips tail = tool_tips(test::shipped_scene("mallet-tail-on-cube", Formulation::response));
  ASSERT_EQ(tail.tips.size(), 1u) << tail.why;
  EXPECT_NEAR(tail.tips.front().radius_m, 0.004, 0.003 * 0.004);
  // A disc whose rim has facets of 1.2 mm.
  const Scene pressed = test::shipped_scene("mallet-head-on-cube", Formulation::response);
  const FoundTips head = tool_tips(pressed);
  ASSERT_EQ(head.tips.size(), 1u) << head.why;
  EXPECT_FALSE(head.tips.front().ball());
  EXPECT_LT((head.tips.front().axis_T + Vec3::UnitZ()).norm(), 1e-9);
  EXPECT_NEAR(head.tips.front().flat_radius_m, 0.009, 3e-5);
  EXPECT_NEAR(head.tips.front().radius_m, 0.003, 1e-4);
  EXPECT_LT((head.tips.front().center_T_m - Vec3(0.0, 0.0, -0.023566)).norm(), 2e-6);
  EXPECT_EQ(response_needs(pressed), "");
}

TEST(MeshTips, WhatIsBesideTheContactDoesNotMatter) {
  // On the slope the handle is below the rest surface, too; but there the body yields.
  const Scene along = test::shipped_scene("mallet-along-ellipsoid", Formulation::response);
  const FoundTips tail = tool_tips(along);
  ASSERT_EQ(tail.tips.size(), 1u) << tail.why;
  EXPECT_TRUE(tail.tips.front().ball());
  EXPECT_NEAR(tail.tips.front().radius_m, 0.004, 0.004 * 0.004);
  EXPECT_EQ(response_needs(along), "");
}

TEST(MeshTips, RefusesWhatIsNoBall) {
  Scene head = test::shipped_scene("mallet-head-on-cube", Formulation::response);
  for (Waypoint& waypoint : head.track) {
    waypoint.pose.orientation = Eigen::AngleAxisd(0.5 * tilt_max, Vec3::UnitX());
  }
  EXPECT_EQ(response_needs(head), "");
  for (Waypoint& waypoint : head.track) {
    waypoint.pose.orientation = Eigen::AngleAxisd(1.5 * tilt_max, Vec3::UnitX());
  }
  EXPECT_THAT(response_needs(head), HasSubstr("upright"));
  // On its side.
  for (Waypoint& waypoint : head.track) {
    waypoint.pose.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX());
    waypoint.pose.position_m.z() += 0.012 - 0.0235;
  }
  EXPECT_THAT(response_needs(head), HasSubstr("part of a ball or a flat disc"));
  // A ball turned inside out is a hollow.
  Scene scene = test::two_balls_on_cube();
  auto hollow = std::make_shared<TriangleMesh>(*scene.tool.mesh);
  for (auto& triangle : hollow->triangles) std::swap(triangle[0], triangle[1]);
  scene.tool.mesh = hollow;
  EXPECT_THAT(tool_tips(scene).why, HasSubstr("part of a ball"));
  scene = test::two_balls_on_cube();
  scene.contact.friction = Friction{.K = 0.3, .beta = 1.0, .mu_D = 0.3};
  EXPECT_THAT(tool_tips(scene).why, HasSubstr("one part of the tool touches where there is friction, and not 2"));
}

/// A capsule of 6 mm on a cube or a ball, turned this far from upright about the x axis.
Scene capsule(double tilt, double depth_m, double yaw = 0.0, bool on_cube = true) {
  Scene scene = on_cube ? test::ball_on_cube() : test::ball_on_sphere();
  scene.tool.shape = ToolShape::capsule;
  scene.tool.radius_m = 0.006;
  scene.tool.length_m = 0.012;
  Pose pose = test::at(0.0, 0.0, 0.06 + 0.006 + 0.006 * std::cos(tilt) - depth_m);
  pose.orientation = Eigen::AngleAxisd(yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(tilt, Vec3::UnitX());
  scene.track = {{0.0, pose}, {1.0, pose}};
  return scene;
}

TEST(ToolTips, ACapsuleStandsOrLies) {
  const double lying = 0.5 * std::numbers::pi;
  for (const double yaw : {0.0, 1.0}) {
    const FoundTips side = tool_tips(capsule(lying, 0.002, yaw));
    ASSERT_EQ(side.tips.size(), 1u) << side.why;
    EXPECT_TRUE(side.tips.front().line());
    EXPECT_NEAR(side.tips.front().half_line_T_m.norm(), 0.006, 1e-12);
    EXPECT_LT(side.tips.front().center_T_m.norm(), 1e-12);
    EXPECT_EQ(response_needs(capsule(lying, 0.002, yaw)), "");
  }
  EXPECT_THAT(tool_tips(capsule(lying - 2.0 * tilt_max, 0.002)).why,
              HasSubstr("stands on its end or lies on its side"));
  EXPECT_THAT(tool_tips(capsule(lying, 0.002, 0.0, false)).why, HasSubstr("on a flat face"));
  Scene rough = capsule(lying, 0.002);
  rough.contact.friction = Friction{.K = 0.3, .beta = 1.0, .mu_D = 0.3};
  EXPECT_THAT(tool_tips(rough).why, HasSubstr("no friction"));
  // Its half ball alone touches; deeper its straight part would.
  const FoundTips end = tool_tips(capsule(0.8, 0.001));
  ASSERT_EQ(end.tips.size(), 1u) << end.why;
  EXPECT_FALSE(end.tips.front().line());
  EXPECT_NEAR(end.tips.front().center_T_m.z(), -0.006, 1e-12);
  EXPECT_THAT(tool_tips(capsule(0.8, 0.003)).why, HasSubstr("stands on its end"));
}

}  // namespace
}  // namespace touchstone::scene
