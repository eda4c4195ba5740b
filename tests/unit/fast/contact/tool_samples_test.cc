#include "fast/contact/tool_samples.h"

#include "scene/shape/surface.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <numeric>
#include <string>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr double radius_m = 0.01;

ToolSamples sample(int count) { return sample_tool(test::ball(radius_m), count); }

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

scene::TriangleMesh mesh_of(const scene::Shape& shape, int triangles) {
  const scene::Surface surface = scene::tessellate(shape, triangles);
  return {surface.points_m, surface.triangles};
}

/// The box's eight corners and twelve triangles.
scene::TriangleMesh brick(const Vec3& size_m) {
  scene::TriangleMesh mesh;
  mesh.points_m.resize(3, 8);
  for (int i = 0; i < 8; ++i) mesh.points_m.col(i) = Vec3(i & 1, i >> 1 & 1, i >> 2 & 1).cwiseProduct(size_m);
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

struct SampledTool {
  std::string name;
  scene::Tool tool;
};

std::vector<SampledTool> every_tool() {
  scene::Tool sphere, capsule, cylinder, sharp, box, brick_mesh, fine_mesh, plate;
  sphere.radius_m = 0.01;
  capsule.shape = scene::ToolShape::capsule;
  capsule.radius_m = 0.006;
  capsule.length_m = 0.02;
  cylinder.shape = sharp.shape = scene::ToolShape::cylinder;
  cylinder.radius_m = sharp.radius_m = 0.008;
  cylinder.length_m = sharp.length_m = 0.02;
  cylinder.edge_radius_m = 0.001;
  box.shape = scene::ToolShape::box;
  box.size_m = Vec3(0.02, 0.01, 0.015);
  brick_mesh.shape = fine_mesh.shape = plate.shape = scene::ToolShape::mesh;
  brick_mesh.mesh = std::make_shared<scene::TriangleMesh>(brick(box.size_m));
  fine_mesh.mesh =
      std::make_shared<scene::TriangleMesh>(mesh_of(scene::Ellipsoid(Vec3::Zero(), Vec3(0.01, 0.008, 0.012)), 20000));
  plate.mesh =
      std::make_shared<scene::TriangleMesh>(mesh_of(scene::Box(Vec3::Zero(), Vec3(0.04, 0.03, 0.0002)), 20000));
  const auto known_convex = [](scene::Tool tool) {
    auto mesh = *tool.mesh;
    mesh.convex = true;
    tool.mesh = std::make_shared<scene::TriangleMesh>(std::move(mesh));
    return tool;
  };
  return {{"Sphere", sphere},
          {"Capsule", capsule},
          {"FilletedCylinder", cylinder},
          {"Cylinder", sharp},
          {"Box", box},
          {"Brick", brick_mesh},
          {"FineMesh", fine_mesh},
          {"ThinPlate", plate},
          {"ConvexBrick", known_convex(brick_mesh)},
          {"ConvexFineMesh", known_convex(fine_mesh)},
          {"ConvexThinPlate", known_convex(plate)}};
}

void PrintTo(const SampledTool& tool, std::ostream* out) { *out << tool.name; }

class EveryTool : public testing::TestWithParam<SampledTool> {
 protected:
  const scene::Tool& tool = GetParam().tool;
  [[nodiscard]] double surface_m2() const {
    return tool.shape == scene::ToolShape::mesh ? tool.mesh->area_m2() : scene::tool_shape(tool)->area_m2();
  }
};

TEST_P(EveryTool, IsCoveredByAboutAsManySamplesAsWished) {
  for (const int wish : {500, 2000, 3000}) {
    const ToolSamples samples = sample_tool(tool, wish);
    EXPECT_GE(samples.count(), wish / 2);
    EXPECT_LE(samples.count(), 2 * wish);
    // A convex mesh may stand for a shape, and shall cost no more.
    if (tool.mesh && tool.mesh->convex) {
      EXPECT_NEAR(samples.count(), wish, 0.1 * wish);
    }
    EXPECT_NEAR(std::accumulate(samples.area_m2.begin(), samples.area_m2.end(), 0.0), surface_m2(),
                1e-10 * surface_m2());
    EXPECT_NEAR(samples.spacing_m, std::sqrt(surface_m2() / samples.count()), 1e-15);
    // Every place of the surface has a sample near that looks the same way.
    const scene::Surface surface = scene::tool_surface(tool, 20000);
    double farthest_m = 0.0;
    for (int v = 0; v < surface.vertex_count(); v += 7) {
      double nearest_m = 1.0;
      for (int i = 0; i < samples.count(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        if (Vec3(samples.nx_T[k], samples.ny_T[k], samples.nz_T[k]).dot(surface.normals.col(v)) < 0.5) continue;
        nearest_m = std::min(nearest_m, (point(samples, i) - surface.points_m.col(v)).norm());
      }
      farthest_m = std::max(farthest_m, nearest_m);
    }
    EXPECT_LT(farthest_m, 1.5 * samples.spacing_m);
  }
}

TEST_P(EveryTool, HasItsSamplesOnTheSurfaceWithUnitNormals) {
  const ToolSamples samples = sample_tool(tool, 2000);
  const auto shape = scene::tool_shape(tool);
  for (int i = 0; i < samples.count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 normal(samples.nx_T[k], samples.ny_T[k], samples.nz_T[k]);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
    EXPECT_GT(samples.area_m2[k], 0.0);
    if (!shape) continue;
    const scene::SurfaceQuery closest = shape->query(point(samples, i));
    EXPECT_NEAR(closest.signed_distance_m, 0.0, 1e-15);
    EXPECT_GT(closest.normal.dot(normal), 1.0 - 1e-9);
  }
}

TEST_P(EveryTool, PressesStraightWithoutSideForceOrTorque) {
  const ToolSamples samples = sample_tool(tool, 2000);
  Vec3 whole = Vec3::Zero(), lower = Vec3::Zero(), torque = Vec3::Zero();
  for (int i = 0; i < samples.count(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Vec3 area = samples.area_m2[k] * Vec3(samples.nx_T[k], samples.ny_T[k], samples.nz_T[k]);
    whole += area;
    if (area.z() >= 0.0) continue;
    lower += area;
    torque += point(samples, i).cross(area.z() * Vec3::UnitZ());
  }
  // A sample on a group of triangles stands near their middle, not on it.
  const bool grouped =
      tool.shape == scene::ToolShape::mesh && (tool.mesh->convex || tool.mesh->triangles.size() > 4000);
  const double side_rel = grouped ? 2e-3 : 1e-12;
  EXPECT_LT(whole.norm(), side_rel * surface_m2());
  EXPECT_LT(std::hypot(lower.x(), lower.y()), (grouped ? side_rel : 1e-12) * surface_m2());
  EXPECT_LT(torque.norm(), side_rel * surface_m2() * 0.01);
}

TEST_P(EveryTool, IsSampledTheSameEveryTime) {
  const ToolSamples a = sample_tool(tool, 1000), b = sample_tool(tool, 1000);
  EXPECT_EQ(a.x_T_m, b.x_T_m);
  EXPECT_EQ(a.nz_T, b.nz_T);
  EXPECT_EQ(a.area_m2, b.area_m2);
}

std::string sampled_tool_name(const testing::TestParamInfo<SampledTool>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(ToolSamples, EveryTool, testing::ValuesIn(every_tool()), sampled_tool_name);

TEST(ToolSamples, OfABallToolAreTheBalls) {
  scene::Tool ball;
  ball.radius_m = radius_m;
  const ToolSamples a = sample_tool(ball, 2000), b = sample(2000);
  EXPECT_EQ(a.x_T_m, b.x_T_m);
  EXPECT_EQ(a.area_m2, b.area_m2);
}

TEST(ToolSamples, OfABrickStandWithinItsFaces) {
  scene::Tool tool;
  tool.shape = scene::ToolShape::mesh;
  const Vec3 size_m(0.02, 0.01, 0.015);
  tool.mesh = std::make_shared<scene::TriangleMesh>(brick(size_m));
  const ToolSamples samples = sample_tool(tool, 600);
  const scene::Box box(Vec3::Zero(), size_m);
  std::array<double, 6> area_m2{};
  for (int i = 0; i < samples.count(); ++i) {
    const scene::SurfaceQuery closest = box.query(point(samples, i));
    ASSERT_NEAR(closest.signed_distance_m, 0.0, 1e-15);
    const Vec3 short_of_edge = box.half_m() - point(samples, i).cwiseAbs();
    // One coordinate on the face, the two others within it.
    EXPECT_EQ((short_of_edge.array() > 1e-4).count(), 2);
    area_m2[static_cast<std::size_t>(closest.patch)] += samples.area_m2[static_cast<std::size_t>(i)];
  }
  EXPECT_NEAR(area_m2[0], 0.01 * 0.015, 1e-15);
  EXPECT_NEAR(area_m2[5], 0.02 * 0.01, 1e-15);
}

}  // namespace
}  // namespace touchstone::fast
