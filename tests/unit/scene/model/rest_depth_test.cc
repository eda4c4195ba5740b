#include "scene/model/rest_depth.h"

#include "scene/model/first_contact.h"
#include "scene/model/scene.h"
#include "scene/shape/surface.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

namespace touchstone::scene {
namespace {

constexpr double size_m = 0.06;
const Box cube(Vec3(0, 0, 0.5 * size_m), Vec3::Constant(size_m));

Tool sphere_tool(double radius_m) {
  Tool tool;
  tool.radius_m = radius_m;
  return tool;
}

Tool capsule_tool(double radius_m, double length_m) {
  Tool tool = sphere_tool(radius_m);
  tool.shape = ToolShape::capsule;
  tool.length_m = length_m;
  return tool;
}

Tool cylinder_tool(double radius_m, double length_m, double edge_radius_m) {
  Tool tool = capsule_tool(radius_m, length_m);
  tool.shape = ToolShape::cylinder;
  tool.edge_radius_m = edge_radius_m;
  return tool;
}

Tool box_tool(const Vec3& box_size_m) {
  Tool tool;
  tool.shape = ToolShape::box;
  tool.size_m = box_size_m;
  return tool;
}

/// A shape's triangles as a mesh tool, with repeated vertices at borders.
Tool mesh_tool(const Shape& shape, int triangles) {
  const Surface s = tessellate(shape, triangles);
  Tool tool;
  tool.shape = ToolShape::mesh;
  tool.mesh = std::make_shared<TriangleMesh>(TriangleMesh{s.points_m, s.triangles});
  return tool;
}

Eigen::Quaterniond turned(double angle, const Vec3& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

TEST(RestDepth, CapsuleOnItsSideAndTilted) {
  const Tool tool = capsule_tool(0.005, 0.02);
  const double above_m = size_m + 0.005 - 0.001;
  EXPECT_NEAR(rest_depth_m(cube, tool, {Vec3(0, 0, above_m), turned(std::numbers::pi / 2, Vec3::UnitX())}), 0.001,
              1e-12);
  // Tilted by 30 degrees, the lower end is lower by l/2 cos.
  const double lead_m = 0.01 * std::cos(std::numbers::pi / 6);
  EXPECT_NEAR(rest_depth_m(cube, tool, {Vec3(0, 0, above_m + lead_m), turned(std::numbers::pi / 6, Vec3::UnitX())}),
              0.001, 1e-12);
  // Across an edge the middle of the capsule touches first.
  const double edge_m = 0.5 * size_m + 0.004 / std::sqrt(2.0);
  EXPECT_NEAR(rest_depth_m(
                  cube, tool,
                  {Vec3(edge_m, 0.001, size_m + 0.004 / std::sqrt(2.0)), turned(std::numbers::pi / 4, -Vec3::UnitY())}),
              0.001, 1e-12);
}

TEST(RestDepth, BoxOnItsCornerEdgeAndFace) {
  const Tool tool = box_tool(Vec3(0.02, 0.02, 0.02));
  // On its corner: the space diagonal is vertical.
  const Eigen::Quaterniond corner_down = Eigen::Quaterniond::FromTwoVectors(Vec3(1, 1, 1), -Vec3::UnitZ());
  const double diagonal_m = 0.01 * std::sqrt(3.0);
  EXPECT_NEAR(rest_depth_m(cube, tool, {Vec3(0.003, 0.001, size_m + diagonal_m - 0.002), corner_down}), 0.002, 6e-9);
  EXPECT_NEAR(
      rest_depth_m(cube, tool,
                   {Vec3(0, 0, size_m + 0.01 * std::sqrt(2.0) - 0.002), turned(std::numbers::pi / 4, Vec3::UnitX())}),
      0.002, 6e-9);
  EXPECT_NEAR(rest_depth_m(cube, tool, {Vec3(0, 0.01, size_m + 0.01 - 0.002), Eigen::Quaterniond::Identity()}), 0.002,
              6e-9);
  EXPECT_EQ(rest_depth_m(cube, tool, {Vec3(0, 0.01, size_m + 0.0101), Eigen::Quaterniond::Identity()}), 0.0);
  // From the side.
  EXPECT_NEAR(
      rest_depth_m(cube, tool, {Vec3(0.5 * size_m + 0.01 - 0.002, 0, 0.5 * size_m), Eigen::Quaterniond::Identity()}),
      0.002, 6e-9);
}

TEST(RestDepth, CylinderFlatOnEdgeAndOnItsSide) {
  const Tool sharp = cylinder_tool(0.008, 0.03, 0.0);
  EXPECT_NEAR(rest_depth_m(cube, sharp, {Vec3(0.01, 0, size_m + 0.015 - 0.0015), Eigen::Quaterniond::Identity()}),
              0.0015, 6e-9);
  EXPECT_NEAR(
      rest_depth_m(cube, sharp, {Vec3(0, 0, size_m + 0.008 - 0.0015), turned(std::numbers::pi / 2, Vec3(1, 2, 0))}),
      0.0015, 6e-9);
  const double angle = 0.4, reach_m = 0.015 * std::cos(angle) + 0.008 * std::sin(angle);
  EXPECT_NEAR(rest_depth_m(cube, sharp, {Vec3(0, 0, size_m + reach_m - 0.0015), turned(angle, Vec3(1, 2, 0))}), 0.0015,
              6e-9);
  // With a fillet: the ring of circles of radius e.
  const double e = 0.002, rounded_m = (0.015 - e) * std::cos(angle) + (0.008 - e) * std::sin(angle) + e;
  EXPECT_NEAR(rest_depth_m(cube, cylinder_tool(0.008, 0.03, e),
                           {Vec3(0, 0, size_m + rounded_m - 0.0015), turned(angle, Vec3(1, 2, 0))}),
              0.0015, 6e-9);
}

TEST(RestDepth, MassCentreMovesTheToolNotTheAnswer) {
  Tool tool = cylinder_tool(0.008, 0.03, 0.001);
  const Pose pose{Vec3(0.01, 0, size_m + 0.015), turned(0.3, Vec3(1, 1, 0))};
  const double depth_m = rest_depth_m(cube, tool, pose);
  EXPECT_GT(depth_m, 0.0005);
  for (ToolShape shape : {ToolShape::cylinder, ToolShape::capsule, ToolShape::box, ToolShape::sphere}) {
    Tool other = tool;
    other.shape = shape;
    other.size_m = Vec3(0.02, 0.01, 0.03);
    const double before_m = rest_depth_m(cube, other, pose);
    other.mass_center_m = Vec3(0.002, -0.003, 0.012);
    const Pose moved{pose.position_m + pose.orientation * *other.mass_center_m, pose.orientation};
    EXPECT_NEAR(rest_depth_m(cube, other, moved), before_m, 1.2e-8);
    const Bounds bounds = tool_shape(other)->bounds();
    EXPECT_LT((0.5 * (bounds.lower_m + bounds.upper_m) + *other.mass_center_m).norm(), 1e-15);
  }
}

TEST(RestDepth, MeshBallIsTheBallToItsFacets) {
  const Ellipsoid body(Vec3(0, 0, 0.03), Vec3(0.05, 0.04, 0.03));
  const Tool ball = sphere_tool(0.01);
  double error_before_m = 0.0;
  for (int triangles : {200, 800, 3200}) {
    const Tool mesh = mesh_tool(Sphere(Vec3(0.5, 0.2, 0.1), 0.01), triangles);
    double error_m = 0.0;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    for (int k = 0; k < 40; ++k) {
      const Vec3 out = Vec3(any(random), any(random), 0.6 + 0.4 * any(random)).normalized();
      const SurfaceQuery q = body.query(body.center_m() + 0.07 * out);
      const Pose pose{q.point_m + 0.008 * q.normal, turned(3.0 * any(random), Vec3(any(random), any(random), 1.0))};
      const double difference_m = rest_depth_m(body, ball, pose) - rest_depth_m(body, mesh, pose);
      // A mesh inside the ball is never deeper; the chord's sagitta is h^2 / (8 R) along an edge, more in a triangle.
      EXPECT_GE(difference_m, -1.2e-9);
      error_m = std::max(error_m, difference_m);
    }
    EXPECT_GT(error_m, 0.0);
    EXPECT_LT(error_m, 1.2e-3 * 200 / triangles);
    if (error_before_m > 0.0) {
      EXPECT_LT(error_m, 0.4 * error_before_m);
    }
    error_before_m = error_m;
  }
}

TEST(RestDepth, IsTheDeepestOfManyPointsForEveryBodyAndTool) {
  // Against brute force over a fine tessellation of the tool: never less than any point, at most the sagitta more.
  const std::vector<std::shared_ptr<const Shape>> bodies = {
      std::make_shared<Box>(cube), std::make_shared<Sphere>(Vec3(0, 0, 0.03), 0.03),
      std::make_shared<Ellipsoid>(Vec3(0, 0, 0.02), Vec3(0.05, 0.03, 0.02)),
      std::make_shared<Revolution>(cylinder_profile(0.03, 0.05, 0.006), Vec3(0, 0, 0.025))};
  const std::vector<std::shared_ptr<const Tool>> tools = {
      std::make_shared<Tool>(cylinder_tool(0.008, 0.03, 0.002)),
      std::make_shared<Tool>(box_tool(Vec3(0.02, 0.01, 0.015))),
      std::make_shared<Tool>(mesh_tool(Box(Vec3::Zero(), Vec3(0.02, 0.01, 0.015)), 12)),
      std::make_shared<Tool>(mesh_tool(Revolution(cylinder_profile(0.008, 0.03, 0.002)), 600))};
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int touching = 0;
  for (const auto& body : bodies) {
    const double tolerance_m = 1e-8 * (body->bounds().upper_m - body->bounds().lower_m).norm();
    for (const auto& tool : tools) {
      const Surface fine = tool_surface(*tool, 20000);
      for (int k = 0; k < 12; ++k) {
        const Vec3 out = Vec3(any(random), any(random), any(random)).normalized();
        const SurfaceQuery q = body->query(body->bounds().upper_m.z() * 0.5 * Vec3::UnitZ() + 0.2 * out);
        const Pose pose{q.point_m + 0.008 * q.normal,
                        turned(3.0 * any(random), Vec3(any(random), any(random), any(random)))};
        const double depth_m = rest_depth_m(*body, *tool, pose);
        touching += depth_m > 0.0;
        const auto deepest_of = [&](const Eigen::Matrix3Xd& points_m) {
          double deepest_m = 0.0;
          for (Eigen::Index i = 0; i < points_m.cols(); ++i) {
            deepest_m = std::max(deepest_m,
                                 -body->signed_distance_m(pose.orientation * Vec3(points_m.col(i)) + pose.position_m));
          }
          return deepest_m;
        };
        if (tool->mesh) {
          // Points all over the triangles, not only their corners.
          const TriangleMesh mesh = tool_mesh(*tool);
          Eigen::Matrix3Xd points_m(3, 66 * static_cast<Eigen::Index>(mesh.triangles.size()));
          Eigen::Index next = 0;
          double edge_m = 0.0;
          for (const auto& [a, b, c] : mesh.triangles) {
            const Vec3 pa = mesh.points_m.col(a), pb = mesh.points_m.col(b), pc = mesh.points_m.col(c);
            edge_m = std::max({edge_m, (pa - pb).norm(), (pb - pc).norm(), (pc - pa).norm()});
            for (int i = 0; i <= 10; ++i) {
              for (int j = 0; j <= 10 - i; ++j) points_m.col(next++) = pa + 0.1 * i * (pb - pa) + 0.1 * j * (pc - pa);
            }
          }
          EXPECT_GE(depth_m, deepest_of(points_m) - tolerance_m);
          EXPECT_LE(depth_m, deepest_of(points_m) + 0.06 * edge_m);
        } else {
          EXPECT_GE(depth_m, deepest_of(fine.points_m) - tolerance_m);
          EXPECT_LE(depth_m, deepest_of(fine.points_m) + 3e-4);
        }
      }
    }
  }
  EXPECT_GT(touching, 150);
}

TEST(RestDepth, OfATriangleMeshInBoxesIsTheSame) {
  const std::vector<std::shared_ptr<const Shape>> bodies = {
      std::make_shared<Box>(cube), std::make_shared<Ellipsoid>(Vec3(0, 0, 0.02), Vec3(0.05, 0.03, 0.02)),
      std::make_shared<Revolution>(cylinder_profile(0.03, 0.05, 0.006), Vec3(0, 0, 0.025))};
  const std::vector<Tool> tools = {mesh_tool(Box(Vec3::Zero(), Vec3(0.02, 0.01, 0.015)), 12),
                                   mesh_tool(Box(Vec3::Zero(), Vec3(0.2, 0.1, 0.15)), 12),
                                   mesh_tool(Revolution(cylinder_profile(0.008, 0.03, 0.002)), 600),
                                   mesh_tool(Sphere(Vec3(0.001, 0.0, 0.02), 0.005), 2000)};
  std::mt19937 random(6);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int touching = 0, apart = 0;
  for (const auto& body : bodies) {
    const double tolerance_m = 1e-8 * (body->bounds().upper_m - body->bounds().lower_m).norm();
    for (const Tool& tool : tools) {
      const RestDepth depth(*body, tool);
      for (int k = 0; k < 30; ++k) {
        const Vec3 out = Vec3(any(random), any(random), any(random)).normalized();
        const SurfaceQuery q = body->query(0.5 * body->bounds().upper_m.z() * Vec3::UnitZ() + 0.2 * out);
        const Pose pose{q.point_m + 0.01 * (1.0 + any(random)) * q.normal,
                        k % 3 == 0 ? Eigen::Quaterniond::Identity()
                                   : turned(3.0 * any(random), Vec3(any(random), any(random), any(random)))};
        const double gap = gap_m(*body, tool, pose);
        ++(gap < 0.0 ? touching : apart);
        EXPECT_NEAR(depth.gap_m(pose), gap, tolerance_m);
        EXPECT_NEAR(depth.depth_m(pose), rest_depth_m(*body, tool, pose), tolerance_m);
        EXPECT_EQ(depth.depth_m(pose) > 0.0, gap < 0.0);
      }
    }
  }
  EXPECT_GT(touching, 100);
  EXPECT_GT(apart, 50);
}

TEST(RestDepth, OfAFineMeshAtManyPosesTakesTheTimeOfFew) {
  // Nearly as many triangles as a mesh may have, at as many poses as a scene's rules ask for.
  const Tool tool = mesh_tool(Sphere(Vec3::Zero(), 0.01), 490000);
  const auto pose_of = [](int i) {
    return Pose{Vec3(0.001, 0.002, size_m + 0.015 - 1e-5 * i), turned(0.1 + 1e-3 * i, Vec3(1, 2, 3))};
  };
  const auto seconds_since = [](std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  constexpr int few = 10, many = 1000;
  auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < few; ++i) (void)gap_m(cube, tool, pose_of(i));
  const double one_s = seconds_since(begin) / few;
  begin = std::chrono::steady_clock::now();
  const RestDepth depth(cube, tool);
  for (int i = 0; i < many; ++i) {
    // Facets lie within the ball by less than a micrometre.
    EXPECT_NEAR(depth.gap_m(pose_of(i)), pose_of(i).position_m.z() - size_m - 0.01, 1e-6);
  }
  // About thirty when this was written.
  EXPECT_LT(seconds_since(begin), 150 * one_s);
}

}  // namespace
}  // namespace touchstone::scene
