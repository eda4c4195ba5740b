#include "fast/contact/contact_detection.h"

#include "support/points.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>

namespace touchstone::fast {
namespace {

using scene::Vec3;

Placement placement(const scene::Pose& pose) { return {pose.orientation.toRotationMatrix(), pose.position_m}; }

struct Case {
  scene::Scene scene;
  std::unique_ptr<const scene::Shape> body = scene::body_shape(scene.body);
  Detection detection = detection_for(*body);
  ToolSamples tool = sample_tool(test::ball(scene.tool.radius_m), scene.fast.tool_samples);
  test::OwnedPoints points{tool.count()};
};

/// Every sample asked one by one of the shape itself.
std::vector<Vec3> inside_by_force(const Case& c, const scene::Pose& pose) {
  std::vector<Vec3> inside;
  for (std::size_t i = 0; i < static_cast<std::size_t>(c.tool.count()); ++i) {
    const Vec3 p_W = pose.orientation * Vec3(c.tool.x_T_m[i], c.tool.y_T_m[i], c.tool.z_T_m[i]) + pose.position_m;
    if (c.body->signed_distance_m(p_W) < 0.0) inside.push_back(p_W);
  }
  return inside;
}

scene::Scene scene_with(scene::BodyShape shape) {
  scene::Scene scene = shape == scene::BodyShape::box ? test::ball_on_cube() : test::ball_on_sphere();
  scene.body.shape = shape;
  scene.body.semi_axes_m = Vec3(0.035, 0.025, 0.030);
  // A post with a flat bottom, a sloping side and a dome.
  scene.body.profile = {{{0.0, 0.0}, {0.030, 0.0}, {0.025, 0.040}, {0.0, 0.055}}, {0.0, 0.0, 0.085 / 3.0}};
  return scene;
}

class ContactDetection : public testing::TestWithParam<scene::BodyShape> {
 protected:
  Case c{scene_with(GetParam())};
};

TEST_P(ContactDetection, FindsExactlyTheSamplesInside) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-0.045, 0.045), turn(-1.0, 1.0);
  int contacts = 0;
  for (int k = 0; k < 400; ++k) {
    scene::Pose pose;
    pose.position_m = Vec3(place(random), place(random), 0.03 + place(random));
    pose.orientation = Eigen::Quaterniond(turn(random), turn(random), turn(random), turn(random)).normalized();
    const InsideSummary summary =
        c.detection.find_inside(*c.body, c.tool, placement(pose), 0.0, c.tool.count(), c.points);
    const std::vector<Vec3> truth = inside_by_force(c, pose);
    ASSERT_NEAR(c.points.count, static_cast<int>(truth.size()), 0);
    contacts += c.points.count > 0;
    double deepest_m = 0.0;
    Vec3 sum = Vec3::Zero(), expected_sum = Vec3::Zero();
    for (const Vec3& p : truth) {
      deepest_m = std::max(deepest_m, -c.body->signed_distance_m(p));
      expected_sum += p;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(c.points.count); ++i) {
      sum += Vec3(c.points.x_W_m[i], c.points.y_W_m[i], c.points.z_W_m[i]);
    }
    EXPECT_NEAR(summary.deepest_m, deepest_m, 1e-15);
    EXPECT_LT((sum - expected_sum).norm(), 1e-12);
  }
  EXPECT_GT(contacts, 100);
}

TEST_P(ContactDetection, DeepestSampleIsTheRestDepth) {
  for (const double depth_m : {0.0005, 0.001, 0.003, 0.006}) {
    const double top_m = c.body->bounds().upper_m.z();
    scene::Pose pose = test::at(0.0, 0.0, top_m + 0.010 - depth_m);
    pose.orientation = test::tilted();
    const Placement at = placement(pose);
    const InsideSummary inside = c.detection.find_inside(*c.body, c.tool, at, 0.0, c.tool.count(), c.points);
    const Vec3 d = direction_from(inside, Vec3::UnitX());
    const RegionExtent extent = c.detection.measure_depths(*c.body, at.R_WT, d, c.points);
    // The samples miss the deepest point by at most half a diagonal of their spacing.
    const double miss_m = c.tool.spacing_m * c.tool.spacing_m / (2.0 * 2.0 * 0.010) * 2.0;
    const double truth_m = scene::rest_depth_m(*c.body, c.scene.tool, pose);
    EXPECT_LE(extent.deepest_m, truth_m * (1.0 + 1e-6) + 2e-6);
    EXPECT_NEAR(extent.deepest_m, truth_m, miss_m);
    EXPECT_GT(d.dot(-Vec3::UnitZ()), 0.999);
  }
}

TEST_P(ContactDetection, MarginBringsInWhatIsNearFromOutside) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> place(-0.045, 0.045);
  constexpr double margin_m = 0.0015;
  int outside = 0;
  for (int k = 0; k < 100; ++k) {
    const scene::Pose pose = test::at(place(random), place(random), 0.03 + place(random));
    const InsideSummary with =
        c.detection.find_inside(*c.body, c.tool, placement(pose), margin_m, c.tool.count(), c.points);
    std::vector<bool> found(static_cast<std::size_t>(c.tool.count()), false);
    for (int i = 0; i < c.points.count; ++i) found[static_cast<std::size_t>(c.points.sample[i])] = true;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Vec3 p_W = Vec3(c.tool.x_T_m[i], c.tool.y_T_m[i], c.tool.z_T_m[i]) + pose.position_m;
      const double distance_m = c.body->signed_distance_m(p_W);
      // Off a box's corner the faces' planes are asked.
      if (distance_m < margin_m - 1e-15) {
        EXPECT_TRUE(found[i]);
      } else if (distance_m > std::sqrt(3.0) * margin_m) {
        EXPECT_FALSE(found[i]);
      }
      outside += found[i] && distance_m > 0.0;
    }
    const InsideSummary without =
        c.detection.find_inside(*c.body, c.tool, placement(pose), 0.0, c.tool.count(), c.points);
    EXPECT_EQ(with.normal_sum, without.normal_sum) << "the summary speaks of the inside ones";
  }
  EXPECT_GT(outside, 500);
}

TEST_P(ContactDetection, LimitStopsTheSearchEarly) {
  const double top_m = c.body->bounds().upper_m.z();
  c.detection.find_inside(*c.body, c.tool, placement(test::at(0.0, 0.0, top_m)), 0.0, 1, c.points);
  EXPECT_GE(c.points.count, 1);
  EXPECT_LE(c.points.count, 8);
}

std::string name_of(const testing::TestParamInfo<scene::BodyShape>& info) {
  const std::array names{"Box", "Sphere", "Ellipsoid", "Revolution"};
  return names[static_cast<std::size_t>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(Bodies, ContactDetection,
                         testing::Values(scene::BodyShape::box, scene::BodyShape::sphere, scene::BodyShape::ellipsoid,
                                         scene::BodyShape::revolution),
                         name_of);

TEST(ContactDepths, AreMeasuredAlongTheGivenDirection) {
  Case c{test::ball_on_cube()};
  const scene::Pose pose = test::pressed(0.004);
  const Placement at = placement(pose);
  c.detection.find_inside(*c.body, c.tool, at, 0.0, c.tool.count(), c.points);
  const Vec3 d = Vec3(0.6, 0.0, -0.8);
  const RegionExtent extent = c.detection.measure_depths(*c.body, at.R_WT, d, c.points);
  double area_m2 = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(c.points.count); ++i) {
    EXPECT_GE(c.points.cos_theta[i], 0.0);
    EXPECT_NEAR(c.points.depth_m[i], (0.060 - c.points.z_W_m[i]) / 0.8, 1e-15);
    const Vec3 normal(c.points.nx_T[i], c.points.ny_T[i], c.points.nz_T[i]);
    EXPECT_NEAR(c.points.cos_theta[i], normal.dot(d), 1e-15);
    area_m2 += c.points.area_m2[i] * c.points.cos_theta[i];
  }
  EXPECT_NEAR(extent.area_m2, area_m2, 1e-15);
}

TEST(ContactDepths, AreaIsTheOverlapsProjection) {
  Case c{test::ball_on_cube()};
  for (const double depth_m : {0.001, 0.003, 0.006}) {
    const Placement at = placement(test::pressed(depth_m));
    c.detection.find_inside(*c.body, c.tool, at, 0.0, c.tool.count(), c.points);
    const RegionExtent extent = c.detection.measure_depths(*c.body, at.R_WT, -Vec3::UnitZ(), c.points);
    const double cap_m2 = std::numbers::pi * (2.0 * 0.010 * depth_m - depth_m * depth_m);
    EXPECT_NEAR(extent.area_m2, cap_m2, 0.02 * cap_m2);
    EXPECT_NEAR(extent.thickness_m, 0.060, 1e-15);
    EXPECT_LT((extent.center_W_m - Vec3(0.0, 0.0, 0.060)).norm(), 1e-15);
  }
}

TEST(ContactDepths, PointsFacingAwayAreLeftOut) {
  Case c{test::ball_on_cube()};
  const Placement at = placement(test::at(0.0, 0.0, 0.03));  // the whole ball inside
  c.detection.find_inside(*c.body, c.tool, at, 0.0, c.tool.count(), c.points);
  EXPECT_EQ(c.points.count, c.tool.count());
  c.detection.measure_depths(*c.body, at.R_WT, -Vec3::UnitZ(), c.points);
  EXPECT_EQ(c.points.count, c.tool.count() / 2);
  for (int i = 0; i < c.points.count; ++i) {
    EXPECT_LE(c.points.z_W_m[static_cast<std::size_t>(i)], 0.03 + 1e-12);
  }
}

TEST(ContactDirection, FollowsTheSurfaceButNeverTurnsBack) {
  InsideSummary inside;
  inside.weight_sum = 1.0;
  inside.normal_sum = Vec3(0.6, 0.0, 0.8);
  EXPECT_LT((follow_direction(-Vec3::UnitZ(), inside) - Vec3(-0.6, 0.0, -0.8)).norm(), 1e-15);
  inside.normal_sum = Vec3(0.0, 0.0, -1.0);  // the far side is nearer now
  EXPECT_EQ(follow_direction(-Vec3::UnitZ(), inside), -Vec3::UnitZ());
  inside.normal_sum = Vec3(0.3, 0.0, 0.3);  // the normals disagree
  EXPECT_EQ(follow_direction(-Vec3::UnitZ(), inside), -Vec3::UnitZ());
}

TEST(ContactDirection, FallsBackWhereTheNormalsCancel) {
  InsideSummary inside;
  inside.weight_sum = 1.0;
  EXPECT_EQ(direction_from(inside, Vec3::UnitX()), Vec3::UnitX());
  inside.normal_sum = Vec3(0.0, 0.0, 0.5);
  EXPECT_EQ(direction_from(inside, Vec3::UnitX()), -Vec3::UnitZ());
}

}  // namespace
}  // namespace touchstone::fast
