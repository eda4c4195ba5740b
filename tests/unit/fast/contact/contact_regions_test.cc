#include "fast/contact/contact_regions.h"

#include "scene/shape/surface.h"
#include "support/points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

namespace touchstone::fast {
namespace {

using scene::Vec3;
using testing::ElementsAre;

ToolSamples samples_at(const std::vector<Vec3>& points_m) {
  ToolSamples tool;
  for (const Vec3& p : points_m) {
    tool.x_T_m.push_back(p.x());
    tool.y_T_m.push_back(p.y());
    tool.z_T_m.push_back(p.z());
    tool.area_m2.push_back(1e-6);
  }
  return tool;
}

void fill(const ToolSamples& tool, const std::vector<int>& chosen, RegionPoints& points) {
  points.count = static_cast<int>(chosen.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    const auto i = static_cast<std::size_t>(chosen[k]);
    points.sample[k] = chosen[k];
    points.x_T_m[k] = points.x_W_m[k] = tool.x_T_m[i];
    points.y_T_m[k] = points.y_W_m[k] = tool.y_T_m[i];
    points.z_T_m[k] = points.z_W_m[k] = tool.z_T_m[i];
    points.area_m2[k] = tool.area_m2[i];
    points.depth_m[k] = 1e-4 * static_cast<double>(chosen[k] % 17);
  }
}

/// Clusters by looking at every pair, as lists of samples in the order of `chosen`.
std::vector<std::vector<int>> by_force(const ToolSamples& tool, const std::vector<int>& chosen, double r_th_m) {
  const auto at = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    return Vec3(tool.x_T_m[k], tool.y_T_m[k], tool.z_T_m[k]);
  };
  std::vector<int> label(chosen.size(), -1);
  int clusters = 0;
  for (std::size_t seed = 0; seed < chosen.size(); ++seed) {
    if (label[seed] >= 0) continue;
    std::vector<std::size_t> open{seed};
    label[seed] = clusters;
    while (!open.empty()) {
      const std::size_t here = open.back();
      open.pop_back();
      for (std::size_t other = 0; other < chosen.size(); ++other) {
        if (label[other] >= 0 || (at(chosen[here]) - at(chosen[other])).squaredNorm() >= r_th_m * r_th_m) continue;
        label[other] = clusters;
        open.push_back(other);
      }
    }
    ++clusters;
  }
  std::vector<std::vector<int>> lists(static_cast<std::size_t>(clusters));
  for (std::size_t k = 0; k < chosen.size(); ++k) lists[static_cast<std::size_t>(label[k])].push_back(chosen[k]);
  return lists;
}

TEST(Clusters, AreThoseOfEveryPairLookedAt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int several = 0, one = 0;
  for (int kind = 0; kind < 3; ++kind) {
    std::vector<Vec3> points_m;
    for (int i = 0; i < 600; ++i) {
      const Vec3 p(unit(random), unit(random), unit(random));
      // A cloud; a ball's surface; a lattice, where distances equal to r_th abound.
      points_m.push_back(0.01 * (kind == 0   ? p
                                 : kind == 1 ? Vec3(p.normalized())
                                             : Vec3((8.0 * p).array().round().matrix() / 8.0)));
    }
    const ToolSamples tool = samples_at(points_m);
    for (const double r_th_m : {1e-9, 2e-4, 5e-4, 1e-3, 1.25e-3, 1.5e-3, 2e-3, 2.5e-3, 3e-3, 5e-3, 0.01, 0.05}) {
      const ClusterGrid grid = cluster_grid(tool, r_th_m);
      ClusterScratch scratch(grid, tool.count());
      test::OwnedPoints points(tool.count());
      std::vector<Cluster> out(600);
      for (const double part : {0.02, 0.1, 0.3, 1.0}) {
        std::vector<int> chosen;
        for (int i = 0; i < tool.count(); ++i)
          if (0.5 * (unit(random) + 1.0) < part) chosen.push_back(i);
        std::shuffle(chosen.begin(), chosen.end(), random);
        fill(tool, chosen, points);
        const std::vector<std::vector<int>> truth = by_force(tool, chosen, r_th_m);
        const ClusterCount found = cluster(grid, points, scratch, out);
        ASSERT_EQ(found.count, static_cast<int>(truth.size())) << "r_th " << r_th_m << " part " << part;
        ASSERT_EQ(found.dropped, 0);
        ASSERT_EQ(points.count, static_cast<int>(chosen.size()));
        for (std::size_t c = 0; c < truth.size(); ++c) {
          const auto begin = static_cast<std::size_t>(out[c].points.begin);
          ASSERT_EQ(out[c].points.size, static_cast<int>(truth[c].size()));
          Vec3 center = Vec3::Zero();
          double deepest_m = -1.0;
          for (std::size_t k = 0; k < truth[c].size(); ++k) {
            const auto i = static_cast<std::size_t>(truth[c][k]);
            ASSERT_EQ(points.sample[begin + k], truth[c][k]);
            ASSERT_EQ(points.p_T_m(begin + k), points_m[i]);
            center += points_m[i] / static_cast<double>(truth[c].size());
            deepest_m = std::max(deepest_m, points.depth_m[begin + k]);
          }
          ASSERT_LT((out[c].center_W_m - center).norm(), 1e-15);
          ASSERT_EQ(out[c].deepest_m, deepest_m);
          ASSERT_NEAR(out[c].area_m2, 1e-6 * static_cast<double>(truth[c].size()), 1e-15);
        }
        (truth.size() > 1 ? several : one) += 1;
      }
    }
  }
  EXPECT_GT(several, 50);
  EXPECT_GT(one, 20);
}

TEST(Clusters, BeyondTheCapacityLoseTheLeastArea) {
  const ToolSamples tool = samples_at(
      {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1.1, 0, 0), Vec3(2, 0, 0), Vec3(3, 0, 0), Vec3(3.1, 0, 0), Vec3(3.2, 0, 0)});
  const ClusterGrid grid = cluster_grid(tool, 0.2);
  ClusterScratch scratch(grid, tool.count());
  test::OwnedPoints points(tool.count());
  std::vector<Cluster> out(2);
  for (int repeat = 0; repeat < 2; ++repeat) {
    fill(tool, {0, 6, 1, 5, 3, 2, 4}, points);
    const ClusterCount found = cluster(grid, points, scratch, out);
    EXPECT_EQ(found.count, 2);
    EXPECT_EQ(found.dropped, 2);
    EXPECT_EQ(points.count, 5);
    EXPECT_EQ(out[0].points.size, 3);
    EXPECT_EQ(out[1].points.begin, 3);
    EXPECT_THAT(std::vector<int>(points.sample, points.sample + 5), ElementsAre(6, 5, 4, 1, 2));
  }
  points.count = 0;
  EXPECT_EQ(cluster(grid, points, scratch, out).count, 0);
}

/// Samples on a line, one a unit, of unit area; regions are stretches of it.
class Tracking1D : public testing::Test {
 protected:
  struct Stretch {
    int begin, size;
    double deepest_m = 1.0, center_m = -1.0;
  };
  std::vector<std::pair<int, int>> track(const std::vector<Stretch>& stretches, double reach_m = 3.0) {
    std::vector<Cluster> clusters;
    points.count = 0;
    for (const Stretch& s : stretches) {
      const double center_m = s.center_m >= 0.0 ? s.center_m : s.begin + 0.5 * s.size;
      clusters.push_back({{points.count, s.size}, static_cast<double>(s.size), s.deepest_m, Vec3(center_m, 0, 0)});
      for (int i = s.begin; i < s.begin + s.size; ++i) {
        points.sample[points.count] = i;
        points.area_m2[points.count++] = 1.0;
      }
    }
    result = tracker.track(points, clusters, reach_m, out);
    std::vector<std::pair<int, int>> list;
    for (int r = 0; r < result.count; ++r)
      list.emplace_back(out[static_cast<std::size_t>(r)].was, out[static_cast<std::size_t>(r)].cluster);
    return list;
  }
  using P = std::pair<int, int>;
  test::OwnedPoints points{100};
  RegionTracker tracker{100, 8, 4};
  std::vector<TrackedRegion> out = std::vector<TrackedRegion>(4);
  Tracking result;
};

TEST_F(Tracking1D, NewRegionsComeDeepestFirstAndKeepTheirOrder) {
  EXPECT_THAT(track({{0, 5, 0.1}, {20, 5, 0.3}, {40, 5, 0.2}}), ElementsAre(P(-1, 1), P(-1, 2), P(-1, 0)));
  EXPECT_THAT(track({{0, 5, 0.9}, {20, 5, 0.3}, {40, 5, 0.2}}), ElementsAre(P(0, 1), P(1, 2), P(2, 0)));
  EXPECT_THAT(track({{0, 5}, {40, 5}}), ElementsAre(P(1, 1), P(2, 0)));
  EXPECT_THAT(track({{0, 5}, {40, 5}, {60, 1}}), ElementsAre(P(0, 1), P(1, 0), P(-1, 2)));
  EXPECT_THAT(track({}), ElementsAre());
  EXPECT_THAT(track({{0, 5}}), ElementsAre(P(-1, 0)));
}

TEST_F(Tracking1D, AGrownOrShiftedRegionIsTheSame) {
  track({{10, 5}});
  EXPECT_THAT(track({{8, 12}}), ElementsAre(P(0, 0)));
  EXPECT_THAT(track({{19, 12, 1.0, 90.0}}), ElementsAre(P(0, 0)));
}

TEST_F(Tracking1D, TheLargerPartOfASplitGoesOn) {
  track({{0, 3}});
  track({{0, 3}, {10, 20}});
  EXPECT_THAT(track({{10, 6, 5.0}, {18, 12, 1.0}, {0, 3}}), ElementsAre(P(0, 2), P(1, 1), P(-1, 0)));
}

TEST_F(Tracking1D, TheOldestOfAMergeGoesOn) {
  track({{30, 3}});
  track({{30, 3}, {10, 10}});
  track({{30, 3}, {10, 10}, {50, 2}});
  EXPECT_THAT(track({{10, 25}, {50, 2}}), ElementsAre(P(0, 0), P(2, 1)));
  EXPECT_THAT(track({{10, 5}, {30, 5}, {50, 2}}), ElementsAre(P(0, 0), P(1, 2), P(-1, 1)));
}

TEST_F(Tracking1D, AMergedRegionDoesNotTakeAStrangersCluster) {
  track({{30, 3}});
  track({{30, 3}, {36, 3}});
  // 36 merged into 30; the cluster beside it has no samples of either.
  EXPECT_THAT(track({{30, 9}, {40, 2}}, 50.0), ElementsAre(P(0, 0), P(-1, 1)));
}

TEST_F(Tracking1D, WithoutCommonSamplesTheNearestCentreWithinReachGoesOn) {
  track({{0, 3, 1.0, 10.0}});
  track({{0, 3, 1.0, 10.0}, {20, 3, 1.0, 20.0}});
  EXPECT_THAT(track({{40, 3, 1.0, 22.0}, {50, 3, 1.0, 11.0}}), ElementsAre(P(0, 1), P(1, 0)));
  EXPECT_THAT(track({{60, 3, 1.0, 8.5}, {70, 3, 1.0, 30.0}}), ElementsAre(P(0, 0), P(-1, 1)));
}

TEST_F(Tracking1D, NewOnesBeyondTheCapacityAreLeftOutAndSaid) {
  track({{0, 2}, {10, 2}, {20, 2}});
  EXPECT_EQ(result.dropped, 0);
  EXPECT_THAT(track({{30, 2, 0.1}, {0, 2}, {40, 2, 0.2}, {20, 2}, {10, 2}}),
              ElementsAre(P(0, 1), P(1, 4), P(2, 3), P(-1, 2)));
  EXPECT_EQ(result.dropped, 1);
  // It has left no trace: as soon as there is room it is new.
  EXPECT_THAT(track({{30, 2}, {0, 2}}), ElementsAre(P(0, 1), P(-1, 0)));
  tracker.forget();
  EXPECT_THAT(track({{30, 2}}), ElementsAre(P(-1, 0)));
}

/// Three balls in a row on one rigid tool, rocked over a block.
TEST(ContactRegions, OfAToolWithThreeFeet) {
  scene::TriangleMesh feet;
  for (const double x_m : {-0.02, 0.0, 0.02}) {
    const scene::Surface ball = scene::tessellate(scene::Sphere(Vec3(x_m, 0.0, 0.0), 0.006), 1000);
    const auto before = static_cast<std::int32_t>(feet.points_m.cols());
    feet.points_m.conservativeResize(3, before + ball.points_m.cols());
    feet.points_m.rightCols(ball.points_m.cols()) = ball.points_m;
    for (const auto& t : ball.triangles) feet.triangles.push_back({t[0] + before, t[1] + before, t[2] + before});
  }
  scene::Tool tool;
  tool.shape = scene::ToolShape::mesh;
  tool.mesh = std::make_shared<scene::TriangleMesh>(feet);
  const ToolSamples samples = sample_tool(tool, 3000);
  const scene::Box block(Vec3(0.0, 0.0, 0.03), Vec3(0.08, 0.06, 0.06));
  const Detection detection = detection_for(block);
  const ClusterGrid grid = cluster_grid(samples, 0.004);
  ClusterScratch scratch(grid, samples.count());
  RegionTracker tracker(samples.count(), 20, 10);
  test::OwnedPoints points(samples.count());
  std::vector<Cluster> clusters(20);
  std::vector<TrackedRegion> regions(10);
  // Where the regions of a pose are, by creation, and which of the last ones they were.
  const auto tick = [&](double tilt, double depth_m) {
    const Placement at{Eigen::AngleAxisd(tilt, Vec3::UnitY()).toRotationMatrix(), Vec3(0, 0, 0.066 - depth_m)};
    detection.find_inside(block, samples, at, 0.0, samples.count(), points);
    const ClusterCount found = cluster(grid, points, scratch, clusters);
    const Tracking tracked =
        tracker.track(points, {clusters.data(), static_cast<std::size_t>(found.count)}, 0.004, regions);
    std::vector<std::pair<int, int>> list;
    for (int r = 0; r < tracked.count; ++r) {
      const TrackedRegion& region = regions[static_cast<std::size_t>(r)];
      list.emplace_back(
          region.was,
          static_cast<int>(std::lround(clusters[static_cast<std::size_t>(region.cluster)].center_W_m.x() / 0.02)));
    }
    return list;
  };
  using P = std::pair<int, int>;
  EXPECT_THAT(tick(0.0, -0.001), ElementsAre());
  EXPECT_THAT(tick(0.2, -0.001), ElementsAre(P(-1, 1)));  // the foot at +x goes down first
  EXPECT_THAT(tick(0.2, 0.001), ElementsAre(P(0, 1), P(-1, 0)));
  EXPECT_THAT(tick(0.0, 0.001), ElementsAre(P(0, 1), P(1, 0), P(-1, -1)));
  EXPECT_THAT(tick(0.01, 0.0012), ElementsAre(P(0, 1), P(1, 0), P(2, -1)));
  EXPECT_THAT(tick(-0.2, 0.001), ElementsAre(P(1, 0), P(2, -1)));
  EXPECT_THAT(tick(0.0, 0.001), ElementsAre(P(0, 0), P(1, -1), P(-1, 1)));
  EXPECT_THAT(tick(0.0, -0.001), ElementsAre());
}

}  // namespace
}  // namespace touchstone::fast
