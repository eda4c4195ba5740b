// Every tool's gap function: derivatives for Newton's method, signs, positions, and the spline of a mesh against exact
// shapes.
#include "reference/tool/tool_gap.h"

#include "reference/tool/distance_grid.h"
#include "reference/tool/tool_distance.h"
#include "reference/tool/tool_symmetry.h"
#include "scene/shape/surface.h"
#include "support/mesh_tools.h"

#include <gtest/gtest.h>

#include <limits>

#include <cmath>
#include <numbers>
#include <random>

namespace touchstone::reference {
namespace {

using test::mesh_of;
using test::turned;

using scene::ToolShape;
using scene::Vec3;

scene::Tool tool_of(ToolShape shape) {
  scene::Tool tool;
  tool.shape = shape;
  tool.radius_m = 0.7;
  tool.length_m = shape == ToolShape::cylinder ? 2.4 : 1.1;
  tool.edge_radius_m = shape == ToolShape::cylinder ? 0.25 : 0.0;
  tool.size_m = {1.6, 1.2, 2.0};
  tool.mass_center_m = Vec3(0.05, -0.1, 0.2);
  if (shape == ToolShape::mesh) tool.mesh = mesh_of(scene::Box(Vec3::Zero(), tool.size_m), 600);
  return tool;
}

class EveryTool : public testing::TestWithParam<ToolShape> {
 protected:
  scene::Tool tool_ = tool_of(GetParam());
  std::shared_ptr<const ToolDistance> distance_ = tool_distance(tool_);
  std::mt19937 random_{7};

  Vec3 around() {
    std::uniform_real_distribution<double> coordinate(-1.4, 1.4);
    return {coordinate(random_), coordinate(random_), coordinate(random_)};
  }
  /// The box's edges are rounded; elsewhere the exact distance is the scene's own.
  [[nodiscard]] double rounding_m() const {
    return GetParam() == ToolShape::box ? 0.5 * box_edge_share * tool_.size_m.minCoeff() : 0.0;
  }
};

/// The derivatives of `at` agree with difference quotients to the tolerance. Where pieces of the surface meet, the
/// Hessian jumps: the difference quotients of both sides differ, and the place is skipped.
template <int dim, class At>
bool slopes_agree(const At& at, const Eigen::Matrix<double, dim, 1>& x, double tolerance) {
  const Gap<dim> g = at(x);
  const double step = 1e-5;
  for (int i = 0; i < dim; ++i) {
    const Eigen::Matrix<double, dim, 1> dx = step * Eigen::Matrix<double, dim, 1>::Unit(i);
    const Gap<dim> up = at(x + dx), down = at(x - dx);
    if (std::isinf(up.value_m) || std::isinf(down.value_m)) return false;
    const Eigen::Matrix<double, dim, 1> forward = (up.gradient - g.gradient) / step,
                                        backward = (g.gradient - down.gradient) / step;
    if ((forward - backward).norm() > 1e-2) return false;
    EXPECT_NEAR(g.gradient[i], (up.value_m - down.value_m) / (2.0 * step), tolerance);
    EXPECT_LT((g.hessian_per_m.col(i) - 0.5 * (forward + backward)).norm(), 100.0 * tolerance);
  }
  EXPECT_LT((g.hessian_per_m - g.hessian_per_m.transpose()).norm(), 1e-12);
  return true;
}

TEST_P(EveryTool, GradientAndHessianAreTheSlopesInSpace) {
  const RigidTool<3> tool(distance_, {Vec3(0.1, -0.2, 0.3), turned(0.8, {1, 2, -1})});
  int checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 x = around();
    if (slopes_agree<3>([&](const Vec3& p) { return tool.gap(p); }, x, 1e-7)) ++checked;
  }
  EXPECT_GT(checked, 80);
}

TEST_P(EveryTool, GradientAndHessianAreTheSlopesInTheMeridianPlane) {
  if (GetParam() == ToolShape::box || GetParam() == ToolShape::mesh) return;  // not of revolution
  tool_.mass_center_m = Vec3(0.0, 0.0, 0.2);
  const RigidTool<2> tool(tool_distance(tool_), {Vec3(0.0, 0.0, 0.3), Eigen::Quaterniond::Identity()});
  int checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3 p = around();
    const Eigen::Vector2d x(std::abs(p.x()) + 1e-3, p.z());
    if (slopes_agree<2>([&](const Eigen::Vector2d& rz) { return tool.gap(rz); }, x, 1e-7)) ++checked;
    const RigidTool<3> in_space(tool_distance(tool_), {Vec3(0.0, 0.0, 0.3), Eigen::Quaterniond::Identity()});
    EXPECT_NEAR(tool.gap(x).value_m, in_space.gap({0.0, x[0], x[1]}).value_m, 1e-14);
  }
  EXPECT_GT(checked, 250);
}

TEST_P(EveryTool, IsTheSignedDistanceOfTheScenesShape) {
  if (GetParam() == ToolShape::mesh) return;
  const auto shape = scene::tool_shape(tool_);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 p = around();
    const Gap<3> g = distance_->at(p);
    const double exact_m = shape->signed_distance_m(p);
    // Rounding increases the distance, at most by what a corner loses.
    EXPECT_GE(g.value_m, exact_m - 1e-14);
    EXPECT_LE(g.value_m, exact_m + (std::sqrt(3.0) - 1.0) * rounding_m() + 1e-14);
    EXPECT_NEAR(g.gradient.norm(), 1.0, 1e-14);
  }
}

TEST_P(EveryTool, MovesWithItsPose) {
  const scene::Pose pose{Vec3(0.4, -0.3, 1.2), turned(2.1, {0.3, -1, 0.7})};
  const RigidTool<3> at_home(distance_, {}), moved(distance_, pose);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 p = 0.8 * around();
    const Gap<3> home = at_home.gap(p), away = moved.gap(pose.orientation * p + pose.position_m);
    if (std::isinf(home.value_m)) continue;
    EXPECT_NEAR(home.value_m, away.value_m, 1e-13);
    EXPECT_LT((pose.orientation * home.gradient - away.gradient).norm(), 1e-10);
  }
}

TEST_P(EveryTool, GapAlongALineEndsOnTheSurface) {
  const RigidTool<3> tool(distance_, {Vec3(0.0, 0.0, 2.0), turned(0.5, {1, 0, 0})});
  int hits = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 from = 0.7 * around(), N = (Vec3(0, 0, 1) + 0.2 * around()).normalized();
    const double s = tool.gap_along(from, N, Vec3::Zero()).value_m;
    if (std::isinf(s)) continue;
    ++hits;
    EXPECT_NEAR(tool.gap(from + s * N).value_m, 0.0, 1e-12);
    EXPECT_GT(tool.gap(from + (s - 1e-3) * N).value_m, 0.0);  // from outside
    // Tangential motion of the point has no effect.
    EXPECT_NEAR(tool.gap_along(from, N, 0.1 * N + 0.3 * N.unitOrthogonal()).value_m, s - 0.1, 1e-13);
  }
  EXPECT_GT(hits, 50);
}

std::string shape_name(const testing::TestParamInfo<ToolShape>& shape) {
  return std::array{"Sphere", "Capsule", "Cylinder", "Box", "Mesh"}[static_cast<int>(shape.param)];
}
INSTANTIATE_TEST_SUITE_P(Shapes, EveryTool,
                         testing::Values(ToolShape::sphere, ToolShape::capsule, ToolShape::cylinder, ToolShape::box,
                                         ToolShape::mesh),
                         shape_name);

TEST(BallTool, GapAlongTheNormalIsHertzsBoundaryCondition) {
  const RigidTool<2> tool = ball_tool<2>(1.0, {0.0, 1.9});
  const Gap<2> below = tool.gap_along({0.0, 1.0}, {0.0, 1.0}, {0.0, -0.04});
  EXPECT_NEAR(below.value_m, -0.06, 1e-14);
  EXPECT_NEAR(tool.gap_along({0.6, 1.0}, {0.0, 1.0}, {0.3, 0.0}).value_m, 0.9 - 0.8, 1e-14);
  // A point that is not below the ball never touches.
  EXPECT_TRUE(std::isinf(tool.gap_along({1.2, 1.0}, {0.0, 1.0}, {0.0, 0.0}).value_m));
}

TEST(DistanceGrid, OfABallIsTheBallLessItsChords) {
  const double R_m = 0.01;
  const auto mesh = mesh_of(scene::Sphere(Vec3::Zero(), R_m), 5120);
  const DistanceGrid grid(*mesh, grid_spacing_m(*mesh));
  // An edge e of the mesh lies e^2 / 8R inside the ball, the centre of a triangle e^2 / 6R.
  double edge_m = 0.0;
  for (const auto& t : mesh->triangles) {
    for (int k = 0; k < 3; ++k)
      edge_m = std::max(edge_m, (mesh->points_m.col(t[k]) - mesh->points_m.col(t[(k + 1) % 3])).norm());
  }
  const double chord_m = edge_m * edge_m / (6.0 * R_m);
  std::mt19937 random(3);
  std::normal_distribution<double> coordinate;
  std::uniform_real_distribution<double> share(0.8, 1.2);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3 n = Vec3(coordinate(random), coordinate(random), coordinate(random)).normalized();
    const double r_m = R_m * share(random);
    const Gap<3> g = grid.at(r_m * n);
    if (std::isinf(g.value_m)) continue;
    EXPECT_GT(g.value_m - (r_m - R_m), -0.2 * chord_m);
    EXPECT_LT(g.value_m - (r_m - R_m), 1.2 * chord_m);
    EXPECT_NEAR(g.gradient.norm(), 1.0, 0.05);
    EXPECT_GT(g.gradient.normalized().dot(n), std::cos(edge_m / (std::sqrt(3.0) * R_m)));  // a facet's tilt
  }
  EXPECT_TRUE(std::isinf(grid.at(Vec3(0.0, 0.0, 1.3 * R_m)).value_m));
}

TEST(DistanceGrid, IsMadeOnceForOneMeshAndAnewForAnother) {
  const scene::Tool tool = tool_of(ToolShape::mesh);
  scene::Tool same = tool;
  same.mesh = std::make_shared<const scene::TriangleMesh>(*tool.mesh);
  EXPECT_EQ(tool_distance(tool), tool_distance(same));
  scene::Tool shifted = tool;
  shifted.mass_center_m = *tool.mass_center_m + Vec3(0.1, 0.0, 0.0);
  const Vec3 p_m(0.9, 0.0, 0.0);
  EXPECT_NEAR(tool_distance(shifted)->at(p_m - Vec3(0.1, 0.0, 0.0)).value_m, tool_distance(tool)->at(p_m).value_m,
              1e-6);
  EXPECT_GT(tool_distance(shifted)->at(p_m).value_m, tool_distance(tool)->at(p_m).value_m + 0.05);
}

TEST(DistanceGrid, KnowsInsideFromOutsideOfTwoPieces) {
  const auto cube = mesh_of(scene::Box(Vec3(0, 0, 0), Vec3(1, 1, 1)), 200);
  const auto ball = mesh_of(scene::Sphere(Vec3(1.5, 0.2, 0.1), 0.6), 2000);
  scene::TriangleMesh both = *cube;
  const auto first = static_cast<std::int32_t>(both.points_m.cols());
  both.points_m.conservativeResize(3, first + ball->points_m.cols());
  both.points_m.rightCols(ball->points_m.cols()) = ball->points_m;
  for (const auto& t : ball->triangles) both.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  const DistanceGrid grid(both, 0.05);
  const scene::Box box(Vec3(0, 0, 0), Vec3(1, 1, 1));
  const scene::Sphere sphere(Vec3(1.5, 0.2, 0.1), 0.6);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> x(-0.6, 2.1), yz(-0.6, 0.7);
  int inside = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Vec3 p(x(random), yz(random), yz(random));
    const double exact = std::min(box.signed_distance_m(p), sphere.signed_distance_m(p));
    const Gap<3> g = grid.at(p);
    if (std::abs(exact) < 0.02 || std::isinf(g.value_m)) continue;
    EXPECT_NEAR(g.value_m, exact, 0.02) << p.transpose();
    inside += g.value_m < 0.0 ? 1 : 0;
  }
  EXPECT_GT(inside, 500);
}

TEST(ToolSymmetry, IsTheShapesOwn) {
  const scene::Mat3 mirror = Vec3(-1, 1, 1).asDiagonal();
  const scene::Mat3 turn = Eigen::AngleAxisd(1.0, Vec3::UnitZ()).toRotationMatrix();
  const auto pose = [](double x, double angle, const Vec3& axis) {
    return scene::Pose{{x, 0.01, 2}, turned(angle, axis)};
  };
  const scene::Pose upright{{0, 0, 2}, Eigen::Quaterniond::Identity()};
  for (const ToolShape shape :
       {ToolShape::sphere, ToolShape::capsule, ToolShape::cylinder, ToolShape::box, ToolShape::mesh}) {
    scene::Tool tool = tool_of(shape);
    tool.mass_center_m = Vec3::Zero();
    EXPECT_TRUE(maps_to_itself(tool, pose(0.0, 0.3, {1, 0, 0}), mirror));
    EXPECT_FALSE(maps_to_itself(tool, pose(0.001, 0.3, {1, 0, 0}), mirror));
    EXPECT_EQ(maps_to_itself(tool, pose(0.0, 0.3, {0, 1, 0}), mirror), shape == ToolShape::sphere);
    const bool revolution = shape != ToolShape::box && shape != ToolShape::mesh;
    EXPECT_EQ(maps_to_itself(tool, upright, turn), revolution);
    EXPECT_EQ(maps_to_itself(tool, {{0, 0, 2}, turned(0.1, {1, 0, 0})}, turn), shape == ToolShape::sphere);
    tool.mass_center_m = Vec3(0.01, 0.0, 0.0);
    EXPECT_FALSE(maps_to_itself(tool, upright, mirror));
  }
}

TEST(RigidTool, IsEnteredWhereAWayCrossesItsSurface) {
  const double R_m = 0.01;
  const RigidTool<3> ball = ball_tool<3>(R_m, {0.02, -0.01, 0.03});
  const scene::Vec3 outside_m(0.0012, 0.0007, -0.0111), inside_m(0.0025, -0.0003, -0.0081);
  const scene::Vec3 entry_m = ball.entry_T_m(outside_m, inside_m), way_m = inside_m - outside_m;
  EXPECT_NEAR(entry_m.norm(), R_m, 1e-12 * R_m);
  EXPECT_LT((entry_m - outside_m).cross(way_m).norm(), 1e-12 * R_m * way_m.norm());
  EXPECT_GT((entry_m - outside_m).dot(way_m), 0.0);
  EXPECT_GT((inside_m - entry_m).dot(way_m), 0.0);
  const scene::Vec3 nowhere = scene::Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_LT((ball.entry_T_m(nowhere, inside_m) - R_m * inside_m.normalized()).norm(), 1e-12 * R_m);
  EXPECT_LT((ball.in_tool_frame(ball.in_world(inside_m)) - inside_m).norm(), 1e-16);
}

}  // namespace
}  // namespace touchstone::reference
