// The detection in a tick does not use the heap, for any body.
#include "fast/contact/contact_regions.h"
#include "fast/contact/find_cells.h"
#include "fast/contact/pull_back.h"
#include "support/no_heap.h"
#include "support/points.h"
#include "support/press.h"

#include <gtest/gtest.h>

namespace touchstone::fast {
namespace {

using scene::Vec3;

struct Tilted final : DisplacedSurface {
  void displace(int, PointLanes& lanes) const noexcept override {
    lanes.displacement_m = {};
    for (std::size_t v = 0; v < PointLanes::size; ++v) lanes.displacement_m[2][v] = -0.01 * lanes.point_m[0][v];
  }
};

class DetectionWithoutHeap : public testing::TestWithParam<scene::BodyShape> {};

TEST_P(DetectionWithoutHeap, FindsSplitsFollowsAndTakesBack) {
  scene::Scene scene = test::ball_on_cube();
  scene.body.shape = GetParam();
  scene.body.radius_m = 0.03;
  scene.body.semi_axes_m = Vec3(0.035, 0.025, 0.030);
  scene.body.profile = {{{0.0, 0.0}, {0.030, 0.0}, {0.025, 0.040}, {0.0, 0.055}}, {0.0, 0.0, 0.030}};
  scene.tool.shape = scene::ToolShape::box;  // laid across the top, it touches in up to two places
  scene.tool.size_m = Vec3(0.08, 0.01, 0.01);
  const auto body = scene::body_shape(scene.body);
  const Detection detection = detection_for(*body);
  const ToolSamples tool = cell_tool(scene.tool, 2000);
  const ClusterGrid grid = cluster_grid(tool, 0.002);
  const CellRule rule{.points = 100};
  ClusterScratch scratch(grid, tool.count());
  PullBackScratch scratch_back(tool.count());
  RegionTracker tracker(tool.count(), 20, 10);
  test::OwnedPoints points(tool.count()), fine_points(2 * rule.room);
  CellScratch cells(CellHalves(tool.count(), rule.room));
  std::vector<Cluster> clusters(20);
  std::vector<TrackedRegion> regions(10);
  const double top_m = body->bounds().upper_m.z();
  int ticks_in_contact = 0;
  {
    const test::NoHeap guard;
    for (int tick = 0; tick < 400; ++tick) {
      const double s = 1e-2 * tick;
      Placement at;
      at.R_WT = Eigen::AngleAxisd(0.6 * std::sin(3.0 * s), Vec3::UnitY()).toRotationMatrix();
      at.origin_W_m = Vec3(0.01 * std::sin(s), 0.0, top_m + 0.002 * std::cos(2.0 * s));
      detection.find_cells(*body, tool, at, rule, 1e-4, fine_points, cells);
      detection.find_inside(*body, tool, at, 1e-4, tool.count(), points);
      ticks_in_contact += points.count > 0;
      const ClusterCount found = cluster(grid, points, scratch, clusters);
      const Tracking tracked =
          tracker.track(points, {clusters.data(), static_cast<std::size_t>(found.count)}, 0.004, regions);
      for (int r = 0; r < tracked.count; ++r) {
        const PointRange& range =
            clusters[static_cast<std::size_t>(regions[static_cast<std::size_t>(r)].cluster)].points;
        RegionPoints part = points.slice(range.begin, range.size);
        const InsideSummary inside = detection.pull_back(*body, Tilted(), part, scratch_back);
        detection.summarise(*body, part);
        detection.measure_depths(*body, at.R_WT, direction_from(inside, -Vec3::UnitZ()), part);
      }
    }
  }
  EXPECT_GT(ticks_in_contact, 100);
}

INSTANTIATE_TEST_SUITE_P(Bodies, DetectionWithoutHeap,
                         testing::Values(scene::BodyShape::box, scene::BodyShape::sphere, scene::BodyShape::ellipsoid,
                                         scene::BodyShape::revolution));

}  // namespace
}  // namespace touchstone::fast
