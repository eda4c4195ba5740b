#include "fast/bench/workload.h"

#include "scene/base/error.h"
#include "scene/model/rules.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>

namespace touchstone::bench {
namespace {

using scene::BodyShape;
using scene::Vec3;

TEST(Workload, EveryCaseIsASceneThatBreaksNoRule) {
  const std::vector<Case> cases = all_cases(false);
  EXPECT_EQ(cases.size(), 36u);
  std::set<std::string> names;
  for (const Case& which : cases) {
    names.insert(which.name());
    if (which.size != "1k") continue;  // the rules do not depend on the size
    for (const scene::Violation& v : scene::broken_rules(scene_of(which))) {
      ADD_FAILURE() << which.name() << ": " << v.key << ": " << v.message;
    }
  }
  EXPECT_EQ(names.size(), cases.size());
}

TEST(Workload, TheQuickListHoldsEveryCaseThatATargetNeeds) {
  std::set<std::string> names;
  for (const Case& which : all_cases(true)) names.insert(which.name());
  for (const char* needed : {"box/4k/1", "box/4k/10", "box/100k/1", "box/1k/1", "response/4k/1", "response/100k/1"})
    EXPECT_TRUE(names.contains(needed));
  EXPECT_LT(names.size(), 16u);
}

TEST(Workload, APatternIsTheFirstPartsOfAName) {
  EXPECT_TRUE(matches("box/4k/1", "box/4k/1"));
  EXPECT_TRUE(matches("box/4k/1", "box"));
  EXPECT_TRUE(matches("box/4k/1", "*/4k"));
  EXPECT_TRUE(matches("box/4k/10", "box/*/10"));
  EXPECT_FALSE(matches("box/4k/10", "box/4k/1"));
  EXPECT_FALSE(matches("box/4k/1", "ellipsoid"));
  EXPECT_FALSE(matches("box/4k/1", "*/1k"));
  EXPECT_FALSE(matches("box/4k/1", "box/4k/1/more"));
  EXPECT_THROW(static_cast<void>(triangles_wished("5k")), scene::InputError);
}

TEST(Workload, BallsAreClosedApartAndAlmostAsBigAsTheirSpheres) {
  const std::vector<Vec3> centers_m = {{0, 0, 0}, {0.012, 0.001, 0}, {0, 0.02, -0.003}};
  const double radius_m = 0.004;
  const scene::TriangleMesh mesh = balls_mesh(centers_m, radius_m, 2);
  EXPECT_EQ(mesh.triangles.size(), 3u * 320u);
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first})) << "open, or not all outwards";
  }
  for (const auto& p_m : mesh.points_m.colwise()) {
    const auto on_ball = [&](const Vec3& c_m) { return std::abs((p_m - c_m).norm() - radius_m) < 1e-12; };
    EXPECT_EQ(std::count_if(centers_m.begin(), centers_m.end(), on_ball), 1);
  }
  const double spheres_m3 = 3.0 * 4.0 / 3.0 * std::numbers::pi * std::pow(radius_m, 3);
  EXPECT_LT(mesh.volume_m3(), spheres_m3);
  EXPECT_GT(mesh.volume_m3(), 0.9 * spheres_m3);
}

TEST(Workload, PlacesStandApart) {
  const std::vector<Eigen::Vector2d> places_m = contact_places_m(10);
  ASSERT_EQ(places_m.size(), 10u);
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    EXPECT_LT(places_m[i].cwiseAbs().maxCoeff(), 0.025);
    for (std::size_t j = 0; j < i; ++j) EXPECT_GE((places_m[i] - places_m[j]).norm(), 0.012);
  }
  EXPECT_EQ(contact_places_m(5).size(), 5u);
}

/// Depth of the ball at each place.
std::vector<double> ball_depths_m(const Case& which, std::int64_t tick) {
  const scene::Scene scene = scene_of(which);
  const auto body = scene::body_shape(scene.body);
  const scene::Pose pose = pose_at_tick(which, tick);
  const scene::TriangleMesh mesh = scene::tool_mesh(scene.tool);
  const auto vertices = mesh.points_m.cols() / which.regions;
  std::vector<double> depths_m;
  for (int ball = 0; ball < which.regions; ++ball) {
    double deepest_m = -1.0;
    for (const auto& p_m : mesh.points_m.middleCols(ball * vertices, vertices).colwise()) {
      deepest_m = std::max(deepest_m, -body->signed_distance_m(pose.position_m + pose.orientation * p_m));
    }
    depths_m.push_back(deepest_m);
  }
  return depths_m;
}

TEST(Workload, EveryBallStartsApartAndPressesOnBothBodies) {
  for (const BodyShape body : {BodyShape::box, BodyShape::ellipsoid}) {
    for (const int regions : {2, 5, 10}) {
      const Case which{body, "1k", regions};
      for (const double depth_m : ball_depths_m(which, 0)) EXPECT_LT(depth_m, -1e-4);
      for (std::int64_t tick = approach_ticks; tick < approach_ticks + 200; tick += 13) {
        for (const double depth_m : ball_depths_m(which, tick)) {
          EXPECT_GT(depth_m, 0.0014) << which.name() << " " << tick;
          EXPECT_LT(depth_m, 0.0027) << which.name() << " " << tick;
        }
      }
    }
  }
}

TEST(Workload, TheOneBallIsPressedTwoToThreeMillimetres) {
  for (const BodyShape body : {BodyShape::box, BodyShape::ellipsoid}) {
    const Case which{body, "1k", 1};
    const scene::Scene scene = scene_of(which);
    const auto shape = scene::body_shape(scene.body);
    EXPECT_EQ(scene::rest_depth_m(*shape, scene.tool, pose_at_tick(which, 0)), 0.0);
    for (std::int64_t tick = approach_ticks; tick < approach_ticks + 300; tick += 7) {
      const double depth_m = scene::rest_depth_m(*shape, scene.tool, pose_at_tick(which, tick));
      EXPECT_GT(depth_m, 0.002);
      EXPECT_LT(depth_m, 0.003);
    }
  }
}

TEST(Workload, NoTickRepeatsTheOneBefore) {
  const Case which;
  for (std::int64_t tick = 0; tick < 2000; ++tick) {
    const Vec3 moved_m = pose_at_tick(which, tick + 1).position_m - pose_at_tick(which, tick).position_m;
    EXPECT_GT(moved_m.norm(), 1e-7) << tick;
    EXPECT_LT(moved_m.norm(), 1e-4) << tick;
  }
}

TEST(Workload, SmallBallsAreSampledAsDenselyAsTheLargeOne) {
  const auto per_area = [](int regions) {
    const scene::Scene scene = scene_of({BodyShape::box, "4k", regions});
    const double area_m2 = regions == 1 ? 4.0 * std::numbers::pi * std::pow(scene.tool.radius_m, 2)
                                        : scene::tool_mesh(scene.tool).area_m2();
    return scene.fast.tool_samples / area_m2;
  };
  for (const int regions : {2, 5, 10}) EXPECT_NEAR(per_area(regions) / per_area(1), 1.0, 0.05);
}

}  // namespace
}  // namespace touchstone::bench
