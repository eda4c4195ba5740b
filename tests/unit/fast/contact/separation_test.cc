#include "fast/contact/separation.h"

#include "fast/contact/contact_detection.h"
#include "support/points.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <random>

namespace touchstone::fast {
namespace {

using scene::Vec3;

struct Pair {
  explicit Pair(const scene::Scene& scene, int triangles = 20000)
      : tool(scene.tool),
        body(scene::body_shape(scene.body)),
        separation(*body, scene::tessellate(*body, triangles), scene::tool_surface(scene.tool, triangles)) {}
  scene::Tool tool;
  std::unique_ptr<const scene::Shape> body;
  Separation separation;
};

scene::Scene capsule_on_ellipsoid() {
  scene::Scene scene = test::ball_on_cube();
  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = Vec3(0.04, 0.03, 0.025);
  scene.tool.shape = scene::ToolShape::capsule;
  scene.tool.radius_m = 0.006;
  scene.tool.length_m = 0.02;
  return scene;
}

/// Of a capsule to a convex body: that of its axis, where the distance is convex.
double capsule_distance_m(const scene::Shape& body, const scene::Tool& tool, const scene::Pose& pose) {
  const Vec3 half = pose.orientation * Vec3(0.0, 0.0, 0.5 * tool.length_m);
  double low = -1.0, high = 1.0;
  for (int k = 0; k < 100; ++k) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (body.signed_distance_m(pose.position_m + a * half) < body.signed_distance_m(pose.position_m + b * half) ? high
                                                                                                             : low) =
        body.signed_distance_m(pose.position_m + a * half) < body.signed_distance_m(pose.position_m + b * half) ? b : a;
  }
  return body.signed_distance_m(pose.position_m + 0.5 * (low + high) * half) - tool.radius_m;
}

TEST(Separation, OfABallAndABoxIsTheExactDistance) {
  const Pair pair(test::ball_on_cube());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-0.06, 0.06);
  // A sphere's facets of edge h stand back by up to h^2 / (6 R) or so.
  const double facets_m = 4.0 * std::numbers::pi * 0.010 * 0.010 / 20000 / 0.010;
  int apart = 0;
  for (int i = 0; i < 300; ++i) {
    scene::Pose pose = test::at(place(random), place(random), 0.03 + place(random));
    pose.orientation = test::tilted();
    const double truth_m = pair.body->signed_distance_m(pose.position_m) - 0.010;
    const double found_m = pair.separation.distance_m(pose);
    if (truth_m > 0.0) {
      EXPECT_GE(found_m, truth_m - 1e-12);
      EXPECT_LE(found_m, truth_m + facets_m);
      ++apart;
    } else if (truth_m < -facets_m) {
      EXPECT_EQ(found_m, 0.0);
      EXPECT_TRUE(pair.separation.touches(pose));
    }
  }
  EXPECT_GT(apart, 100);
  EXPECT_TRUE(pair.separation.touches(test::at(0.0, 0.0, 0.03))) << "inside the body is contact too";
  EXPECT_EQ(pair.separation.distance_m(test::at(0.0, 0.0, 0.03)), 0.0);
}

TEST(Separation, OfACapsuleAndAnEllipsoidIsTheExactDistance) {
  const Pair pair(capsule_on_ellipsoid());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-0.07, 0.07), turn(-1.0, 1.0);
  int apart = 0;
  for (int i = 0; i < 300; ++i) {
    scene::Pose pose = test::at(place(random), place(random), 0.025 + place(random));
    pose.orientation = Eigen::Quaterniond(turn(random), turn(random), turn(random), turn(random)).normalized();
    const double truth_m = capsule_distance_m(*pair.body, pair.tool, pose);
    if (truth_m <= 0.0) continue;
    ++apart;
    const double found_m = pair.separation.distance_m(pose);
    EXPECT_GE(found_m, truth_m - 1e-12);
    EXPECT_LE(found_m, truth_m + 3e-5);
  }
  EXPECT_GT(apart, 100);
}

TEST(FirstContact, OfAFallingBallIsWhenItsLowestPointArrives) {
  const Pair pair(test::ball_on_cube());
  const std::vector<scene::Waypoint> track{
      {1.0, test::pressed(-0.020)}, {2.0, test::pressed(-0.005)}, {4.0, test::pressed(0.005)}};
  const auto time_s = pair.separation.first_contact_s(track);
  ASSERT_TRUE(time_s.has_value());
  EXPECT_NEAR(*time_s, 3.0, 1e-6 / 0.005);  // the facets stand back by less than 1 um
}

TEST(FirstContact, OfASwungCapsuleIsTheClosedForms) {
  // About its centre, 14 mm over the block, until the tip comes down: (L/2) sin(a) + R = 14 mm.
  scene::Scene scene = test::ball_on_cube();
  scene.tool.shape = scene::ToolShape::capsule;
  scene.tool.radius_m = 0.006;
  scene.tool.length_m = 0.024;
  const Pair pair(scene);
  const auto turned = [](double angle) {
    scene::Pose pose = test::at(0.0, 0.0, 0.074);
    pose.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi - angle, Vec3::UnitY());
    return pose;
  };
  const auto time_s = pair.separation.first_contact_s({{0.0, turned(0.0)}, {1.0, turned(1.0)}});
  ASSERT_TRUE(time_s.has_value());
  EXPECT_NEAR(*time_s, std::asin(0.008 / 0.012), 1e-3);
}

TEST(FirstContact, IsNotSteppedOverByAFastTool) {
  const Pair pair(test::ball_on_cube());
  // Through the body and out at the other side between two waypoints.
  const auto time_s = pair.separation.first_contact_s({{0.0, test::at(-1.0, 0, 0.03)}, {1.0, test::at(1.0, 0, 0.03)}});
  ASSERT_TRUE(time_s.has_value());
  EXPECT_NEAR(*time_s, (1.0 - 0.040) / 2.0, 1e-5);
  EXPECT_FALSE(pair.separation.first_contact_s({{0.0, test::at(-1, 0, 0.0705)}, {1.0, test::at(1, 0, 0.0705)}}));
  EXPECT_EQ(pair.separation.first_contact_s({{0.5, test::pressed(0.001)}, {1.0, test::pressed(0.002)}}), 0.5);
}

/// The three phases of section III: apart, the tick of first contact, in contact.
TEST(ContactPhases, FollowFromApartToContact) {
  for (const scene::Scene& scene : {test::ball_on_cube(), capsule_on_ellipsoid()}) {
    const Pair pair(scene);
    const ToolSamples tool = sample_tool(scene.tool, 2000);
    const Detection detection = detection_for(*pair.body);
    test::OwnedPoints points(tool.count());
    const double top_m = pair.body->bounds().upper_m.z();
    const double reach_m = scene.tool.shape == scene::ToolShape::sphere ? 0.010 : 0.016;
    const std::vector<scene::Waypoint> track{{0.0, test::at(0.0, 0.0, top_m + reach_m + 0.005)},
                                             {1.0, test::at(0.0, 0.0, top_m + reach_m - 0.005)}};
    const double first_s = pair.separation.first_contact_s(track).value();
    EXPECT_NEAR(first_s, 0.5, 1e-3);
    // The lowest samples stand up to half a diagonal of their spacing beside the lowest point.
    const double late_s = 0.5 * tool.spacing_m * tool.spacing_m / (2.0 * scene.tool.radius_m) / 0.010 + 1e-3;
    int apart = 0, first_tick = -1;
    for (int tick = 0; tick <= 1000; ++tick) {
      const double time_s = 1e-3 * tick;
      const scene::Pose pose = scene::pose_at(track, time_s);
      const Placement at{pose.orientation.toRotationMatrix(), pose.position_m};
      detection.find_inside(*pair.body, tool, at, 0.0, tool.count(), points);
      if (first_tick < 0 && points.count > 0) first_tick = tick;
      if (time_s < first_s - 1e-6) {
        ++apart;
        EXPECT_EQ(points.count, 0);
        EXPECT_GT(pair.separation.distance_m(pose), 0.0);
      }
      if (first_tick >= 0) {
        EXPECT_GT(points.count, 0);
        EXPECT_TRUE(pair.separation.touches(pose));
      }
    }
    EXPECT_GT(apart, 400);
    EXPECT_GE(1e-3 * first_tick, first_s);
    EXPECT_LE(1e-3 * first_tick, first_s + late_s);
  }
}

}  // namespace
}  // namespace touchstone::fast
