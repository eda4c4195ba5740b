#include "fast/tool_samples.h"

#include <gtest/gtest.h>

#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr double radius_m = 0.01;

ToolSamples sample(int count) { return sample_tool(scene::Sphere(Vec3::Zero(), radius_m), count); }

Vec3 point(const ToolSamples& tool, int i) {
  const auto k = static_cast<std::size_t>(i);
  return {tool.x_T_m[k], tool.y_T_m[k], tool.z_T_m[k]};
}

TEST(ToolSamples, LieOnTheToolWithItsNormals) {
  const ToolSamples tool = sample(2000);
  ASSERT_EQ(tool.count(), 2000);
  for (int i = 0; i < tool.count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 normal(tool.nx_T[k], tool.ny_T[k], tool.nz_T[k]);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-14);
    EXPECT_LT((point(tool, i) - radius_m * normal).norm(), 1e-17);
  }
}

TEST(ToolSamples, CoverTheSurfaceEvenly) {
  const ToolSamples tool = sample(2000);
  const double surface_m2 = scene::Sphere(Vec3::Zero(), radius_m).area_m2();
  EXPECT_NEAR(std::accumulate(tool.area_m2.begin(), tool.area_m2.end(), 0.0), surface_m2, 1e-12 * surface_m2);
  EXPECT_NEAR(tool.spacing_m, std::sqrt(surface_m2 / 2000), 1e-15);
  // Every cap of a tenth of the height holds a tenth of the samples or so, whatever its direction.
  for (const Vec3& direction : {Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(0.6, 0.0, 0.8), Vec3(-0.48, 0.64, 0.6)}) {
    int inside = 0;
    double nearest_m = 1.0;
    for (int i = 0; i < tool.count(); ++i) {
      inside += point(tool, i).dot(direction) > 0.8 * radius_m;
      nearest_m = std::min(nearest_m, (point(tool, i) - radius_m * direction).norm());
    }
    EXPECT_NEAR(inside, 200, 8);
    EXPECT_LT(nearest_m, tool.spacing_m);
  }
}

TEST(ToolSamples, AreTurnedOntoThemselvesByAQuarterTurn) {
  const ToolSamples tool = sample(400);
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < tool.count(); ++i) sum += point(tool, i);
  EXPECT_LT(sum.norm(), 1e-15);
}

TEST(ToolSamples, TreeBoundsEverySampleOnce) {
  for (const int count : {1, 3, 8, 9, 57, 2000}) {
    const ToolSamples tool = sample(count);
    ASSERT_EQ(tool.count(), count);
    std::vector<int> seen(static_cast<std::size_t>(count), 0);
    for (std::size_t node = 0; node < tool.tree.size(); ++node) {
      const SampleBall& ball = tool.tree[node];
      for (int i = ball.begin; i < ball.end; ++i) {
        EXPECT_LE((point(tool, i) - ball.center_T_m).norm(), ball.radius_m);
        seen[static_cast<std::size_t>(i)] += ball.leaf;
      }
      EXPECT_EQ(ball.leaf, ball.end - ball.begin <= 8);
      EXPECT_GT(ball.next, static_cast<int>(node));
      EXPECT_EQ(ball.leaf, ball.next == static_cast<int>(node) + 1);
    }
    EXPECT_EQ(tool.tree.front().next, static_cast<int>(tool.tree.size()));
    for (const int times : seen) EXPECT_EQ(times, 1);
  }
}

}  // namespace
}  // namespace touchstone::fast
