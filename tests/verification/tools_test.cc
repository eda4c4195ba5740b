// Tools of every shape against closed forms, against each other and against their own symmetry.
#include "reference/contact/contact_problem.h"
#include "reference/contact/load_path.h"
#include "reference/mesh/mesh.h"
#include "reference/solver.h"
#include "reference/tool/tool_distance.h"
#include "reference/verification/closed_forms.h"
#include "reference/verification/half_space.h"
#include "scene/shape/surface.h"
#include "support/mesh_tools.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <numbers>

namespace touchstone::reference {
namespace {

using test::mesh_of;
using test::mesh_tool;
using test::turned;

using scene::ToolShape;
using scene::Vec3;

scene::Tool round_tool(ToolShape shape, double radius_m, double length_m, double edge_radius_m) {
  scene::Tool tool;
  tool.shape = shape;
  tool.radius_m = radius_m;
  tool.length_m = length_m;
  tool.edge_radius_m = edge_radius_m;
  return tool;
}

class RoundedPunch : public testing::TestWithParam<double> {};

TEST_P(RoundedPunch, OnAHalfSpaceInSmallStrain) {
  const double R_m = 0.01, e_m = 0.25 * R_m;
  const double E_star_pa = verification::contact_modulus_pa(3e6, GetParam());
  for (const double a_m : {0.80 * R_m, 0.92 * R_m}) {
    const verification::RoundedPunch exact = verification::rounded_punch(E_star_pa, R_m - e_m, e_m, a_m);
    const verification::HalfSpaceAnswer answer = verification::indent_half_space(
        {{3e6, GetParam()}, verification::rounded_punch(R_m, e_m, exact.depth_m), exact.depth_m});
    EXPECT_NEAR(answer.force_n / exact.force_n, 1.0, 0.002);
    EXPECT_NEAR(answer.contact_radius_m / a_m, 1.0, 0.005);
    EXPECT_LT(answer.equilibrium_rel, 1e-6);
  }
}
INSTANTIATE_TEST_SUITE_P(PoissonsRatio, RoundedPunch, testing::Values(0.3, 0.5));

/// Results for a tool in the middle of a block of 60 x 60 x 30 mm, pressed to a depth in equal steps.
struct Pressed {
  Observation seen;
  int iterations = 0;
};
Pressed press(const scene::Tool& tool, double above_m, double depth_m, double cell_m, bool mirror_x = true,
              const Eigen::Quaterniond& orientation = Eigen::Quaterniond::Identity(), double x_m = 0.0) {
  constexpr int steps = 3;
  const double half_m = 0.03;
  BlockSpec spec{{mirror_x ? 0.0 : -half_m, 0.0, 0.0}, Vec3::Constant(half_m), mirror_x, true, {{}, 0.9, half_m / 2.0}};
  spec.grading.discs.push_back({{0, 0, half_m}, {0, 0, 1}, 0.004, cell_m});
  ContactProblem<3> body(block_mesh(spec), {3e6, 0.45}, scene::Kinematics::finite, mirror_x, true, 1);
  const auto distance = tool_distance(tool);
  Pressed pressed;
  State<3> state = body.rest();
  for (int step = 1; step <= steps; ++step) {
    body.set_tool({distance, {Vec3(x_m, 0, half_m + above_m - depth_m * step / steps), orientation}});
    const NewtonReport report = body.solve(state);
    EXPECT_TRUE(report.converged) << report.trouble << " in step " << step;
    pressed.iterations += report.iterations;
  }
  pressed.seen = body.observe(state, 0.004);
  return pressed;
}

TEST(Tools, TheBallInThreeGuises) {
  const double R_m = 0.01;
  const Pressed ball = press(round_tool(ToolShape::sphere, R_m, 0, 0), R_m, 0.003, 0.002);
  const Pressed capsule = press(round_tool(ToolShape::capsule, R_m, 1e-9, 0), R_m, 0.003, 0.002);
  const Pressed mesh = press(mesh_tool(scene::Sphere(Vec3::Zero(), R_m), 5120), R_m, 0.003, 0.002);
  ASSERT_GT(ball.seen.force_n.z(), 50.0);
  EXPECT_NEAR(capsule.seen.force_n.z() / ball.seen.force_n.z(), 1.0, 1e-6);
  // The facets lie inside the ball, by 0.3 % of the depth.
  EXPECT_LT(mesh.seen.force_n.z(), ball.seen.force_n.z());
  EXPECT_NEAR(mesh.seen.force_n.z() / ball.seen.force_n.z(), 1.0, 0.006);
  EXPECT_LE(mesh.iterations, ball.iterations + 3);
  EXPECT_LT(mesh.seen.equilibrium_rel, 1e-6);
  RecordProperty("ball", std::to_string(ball.seen.force_n.z()) + " " + std::to_string(ball.iterations));
  RecordProperty("mesh", std::to_string(mesh.seen.force_n.z()) + " " + std::to_string(mesh.iterations));
}

TEST(Tools, AFrictionlessBallFeelsNoTorqueAboutItsCentre) {
  const double R_m = 0.01;
  const Pressed aside =
      press(round_tool(ToolShape::sphere, R_m, 0, 0), R_m, 0.003, 0.004, false, Eigen::Quaterniond::Identity(), 0.015);
  ASSERT_GT(aside.seen.force_n.z(), 50.0);
  EXPECT_GT(std::abs(aside.seen.force_n.x()), 0.5);
  EXPECT_LT(aside.seen.torque_nm.norm(), 1e-9 * R_m * aside.seen.force_n.z());
}

TEST(Tools, TheBoxAndItsMesh) {
  scene::Tool box;
  box.shape = ToolShape::box;
  box.size_m = {0.012, 0.010, 0.010};
  const Pressed exact = press(box, 0.005, 0.0005, 0.001),
                mesh = press(mesh_tool(scene::Box(Vec3::Zero(), box.size_m), 600), 0.005, 0.0005, 0.001);
  EXPECT_NEAR(mesh.seen.force_n.z() / exact.seen.force_n.z(), 1.0, 0.08);
  RecordProperty("box", std::to_string(exact.seen.force_n.z()) + " " + std::to_string(exact.iterations));
  RecordProperty("mesh", std::to_string(mesh.seen.force_n.z()) + " " + std::to_string(mesh.iterations));
}

TEST(Tools, ACapsuleOnItsSide) {
  const double R_m = 0.005;
  const Eigen::Quaterniond lying = turned(0.5 * std::numbers::pi, Vec3::UnitY());  // along x
  const scene::Tool tool = round_tool(ToolShape::capsule, R_m, 0.008, 0);
  const Pressed quarter = press(tool, R_m, 0.0015, 0.002, true, lying),
                half = press(tool, R_m, 0.0015, 0.002, false, lying);
  EXPECT_NEAR(quarter.seen.force_n.z() / half.seen.force_n.z(), 1.0, 1e-7);
  EXPECT_NEAR(quarter.seen.area_m2 / half.seen.area_m2, 1.0, 1e-6);
  EXPECT_LT(half.seen.force_n.head<2>().norm(), 1e-6 * half.seen.force_n.z());
  EXPECT_LT(half.seen.torque_nm.norm(), 1e-6 * R_m * half.seen.force_n.z());
  EXPECT_LT(half.seen.equilibrium_rel, 1e-6);
  EXPECT_EQ(half.seen.regions.size(), 1u);
  // The straight part adds to the force of both ends, which form one ball.
  const Pressed ball = press(round_tool(ToolShape::sphere, R_m, 0, 0), R_m, 0.0015, 0.002);
  EXPECT_GT(half.seen.force_n.z(), 1.3 * ball.seen.force_n.z());
}

/// Two upright pins with round tips, 40 mm apart, or the right one alone; the tips are 20 mm below the mass centre.
constexpr double apart_m = 0.04, pin_m = 0.003, drop_m = 0.02;
scene::Tool pins(bool left, bool right) {
  scene::TriangleMesh mesh;
  mesh.points_m.resize(3, 0);
  for (const double x_m : {-0.5 * apart_m, 0.5 * apart_m}) {
    if (!(x_m < 0.0 ? left : right)) continue;
    const auto pin =
        mesh_of(scene::Revolution(scene::capsule_profile(pin_m, 0.006), Vec3(x_m, 0.0, 0.003 + pin_m - drop_m)), 1200);
    const auto first = static_cast<std::int32_t>(mesh.points_m.cols());
    mesh.points_m.conservativeResize(3, first + pin->points_m.cols());
    mesh.points_m.rightCols(pin->points_m.cols()) = pin->points_m;
    for (const auto& t : pin->triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  scene::Tool tool;
  tool.shape = ToolShape::mesh;
  tool.mesh = std::make_shared<scene::TriangleMesh>(std::move(mesh));
  tool.mass_center_m = Vec3::Zero();
  return tool;
}

TEST(Tools, TwoPinsFarApart) {
  // The pins of a tool that tilts: right, both, left.
  const double height_m = 0.012, depth_m = 0.001, angle = 0.06;
  scene::Scene scene;
  scene.name = "two-pins";
  scene.body.size_m = {0.08, 0.03, height_m};
  scene.body.material = {3e6, 0.5};
  scene.tool = pins(true, true);
  const auto pose_at_angle = [&](double turn) {
    // Tilted about y, the tip at 20 mm is lower by 20 mm sin(turn) and its centre stays a radius above.
    const Eigen::Quaterniond orientation = turned(turn, Vec3::UnitY());
    const Vec3 tip_m = orientation * Vec3(turn < 0.0 ? -0.5 * apart_m : 0.5 * apart_m, 0.0, pin_m - drop_m);
    return scene::Pose{Vec3(0.0, 0.0, height_m + pin_m - depth_m - tip_m.z()), orientation};
  };
  scene.track = {{0.0, {Vec3(0, 0, height_m + drop_m + 0.004), Eigen::Quaterniond::Identity()}},
                 {1.0, pose_at_angle(angle)},
                 {2.0, pose_at_angle(0.25 * angle)},
                 {3.0, pose_at_angle(0.0)},
                 {4.0, pose_at_angle(-angle)}};
  scene.contact.r_th_m = 0.004;
  scene.compare.instants = 5;
  scene.reference.levels = 1;
  scene.reference.element_size_m = 0.0012;
  const auto store = std::filesystem::temp_directory_path() / ("touchstone-pins-" + std::to_string(::getpid()));
  const Result both = solve(scene, Eigen::Matrix3Xd(3, 0), {store, {}, nullptr});
  EXPECT_EQ(both.model, "half 3D u-p finite strain");
  const std::size_t regions[] = {0, 1, 2, 2, 1};
  for (std::size_t i = 0; i < 5; ++i) ASSERT_EQ(both.instants[i].regions.size(), regions[i]) << "instant " << i;
  for (const std::size_t i : {1, 2, 3}) EXPECT_EQ(both.instants[i].regions[0].id, 0);
  for (const std::size_t i : {2, 3}) EXPECT_EQ(both.instants[i].regions[1].id, 1);
  EXPECT_EQ(both.instants[4].regions[0].id, 1);
  // Where the tool tilts to the right, the left tip is higher by 40 mm sin(angle).
  EXPECT_NEAR(both.instants[2].regions[0].depth_m, depth_m, 2e-5);
  EXPECT_NEAR(both.instants[2].regions[1].depth_m, depth_m - apart_m * std::sin(0.25 * angle), 2e-5);
  // When upright, the right pin's force has a torque about -y.
  const scene::RegionRecord &right = both.instants[3].regions[0], &left = both.instants[3].regions[1];
  // The cells under the two are not exactly mirror images.
  EXPECT_NEAR(left.force_n.z() / right.force_n.z(), 1.0, 0.01);
  EXPECT_NEAR(right.torque_nm.y() / (-0.5 * apart_m * right.force_n.z()), 1.0, 0.02);
  EXPECT_NEAR(left.torque_nm.y() / (0.5 * apart_m * left.force_n.z()), 1.0, 0.02);
  EXPECT_NEAR(right.depth_m, depth_m, 2e-5);
  EXPECT_NEAR(left.depth_m, depth_m, 2e-5);

  scene.tool = pins(false, true);
  const Result alone = solve(scene, Eigen::Matrix3Xd(3, 0), {store, {}, nullptr});
  ASSERT_EQ(alone.instants[3].regions.size(), 1u);
  const scene::RegionRecord& single = alone.instants[3].regions[0];
  EXPECT_NEAR(right.force_n.z() / single.force_n.z(), 1.0, 0.01);
  EXPECT_NEAR(right.area_m2 / single.area_m2, 1.0, 0.02);
  EXPECT_NEAR(both.instants[1].force_n().z() / alone.instants[1].force_n().z(), 1.0, 0.01);
  std::filesystem::remove_all(store);
}

}  // namespace
}  // namespace touchstone::reference
