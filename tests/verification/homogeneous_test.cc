// States of uniform strain, which the element must reproduce to round-off on any mesh: patch tests and the uniaxial
// bar.
#include "reference/contact/contact_problem.h"
#include "reference/mesh/mesh.h"
#include "reference/mesh/round_mesh.h"
#include "reference/verification/closed_forms.h"
#include "reference/verification/solids.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::reference {
namespace {

constexpr double L_m = 0.02;

template <int dim>
void expect_patch(const Mesh<dim>& mesh, const Eigen::Matrix<double, dim, dim>& H, scene::Kinematics kinematics,
                  double nu) {
  const verification::PatchDeviation off = verification::patch_deviation<dim>(mesh, H, {3e6, nu}, kinematics);
  EXPECT_LT(off.displacement_rel, 1e-12);
  EXPECT_LT(off.pressure_rel, 1e-7);
}

const Eigen::Matrix3d shear_and_squeeze =
    (Eigen::Matrix3d() << 0.05, 0.08, -0.02, 0.01, -0.06, 0.03, 0.02, -0.04, 0.07).finished();

TEST(PatchTest, ShearedCubeWithHangingNodes) {
  Mesh<3> mesh = verification::graded_cube(L_m);
  ASSERT_GT(mesh.hanging.size(), 0u);
  const Eigen::Matrix3d skew = (Eigen::Matrix3d() << 1.0, 0.3, 0.1, 0.0, 1.1, -0.2, 0.2, 0.0, 0.9).finished();
  mesh.points_m = skew * mesh.points_m;
  expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::finite, 0.3);
  expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::small, 0.0);
}

TEST(PatchTest, DistortedHexahedra) {
  const Mesh<3> mesh = verification::distorted_cube(L_m);
  ASSERT_EQ(mesh.cell_count(), 8);
  expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::finite, 0.45);
}

TEST(PatchTest, RingsWithHangingNodes) {
  CylinderSpec spec{L_m, L_m, {{{{0.0, L_m}, {0.0, 1.0}, 0.1 * L_m, 0.03 * L_m}}, 0.5, 0.5 * L_m}};
  Mesh<2> mesh = cylinder_mesh(spec);
  ASSERT_GT(mesh.hanging.size(), 0u);
  expect_patch<2>(mesh, Eigen::Matrix2d(Eigen::Vector2d(0.08, -0.1).asDiagonal()), scene::Kinematics::finite, 0.3);
}

TEST(PatchTest, RoundBodies) {
  scene::Body body;
  body.support_height_m = 0.005;
  body.shape = scene::BodyShape::ellipsoid;
  body.semi_axes_m = {0.040, 0.030, 0.025};
  std::vector<RoundSpec> specs{round_spec(body)};
  specs.front().symmetric_x = true;
  body.shape = scene::BodyShape::revolution;
  for (const scene::Profile& profile : {scene::capsule_profile(0.02, 0.03), scene::cylinder_profile(0.03, 0.04, 0.005),
                                        scene::Profile{{{0.0, 0.0}, {0.03, 0.0}, {0.0, 0.05}}, {}}}) {
    body.profile = profile;
    specs.push_back(round_spec(body));
    specs.back().symmetric_x = specs.back().symmetric_y = true;
    Grading<2> grading;
    grading.largest_m = 0.008;
    grading.discs = {{{0.0, 0.0}, {0.0, 1.0}, 0.001, 0.003}};
    Mesh<2> mesh = round_mesh<2>(specs.back(), grading);
    ASSERT_GT(mesh.hanging.size(), 0u);
    expect_patch<2>(mesh, Eigen::Matrix2d(Eigen::Vector2d(0.08, -0.1).asDiagonal()), scene::Kinematics::finite, 0.3);
  }
  for (const RoundSpec& spec : specs) {
    Grading<3> grading;
    grading.largest_m = 0.02;
    grading.discs = {{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.001, 0.006}};
    Mesh<3> mesh = round_mesh<3>(spec, grading);
    ASSERT_GT(mesh.hanging.size(), 0u);
    expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::finite, 0.45);
  }
}

class Bar : public testing::TestWithParam<double> {};

TEST_P(Bar, IncompressibleCompressionBetweenLubricatedPlates) {
  const scene::Material rubber{3e6, 0.5};
  const verification::PulledBar bar = verification::pull_bar(rubber, GetParam());
  EXPECT_NEAR(bar.nominal_stress_pa / verification::neo_hookean_bar_pa(rubber, GetParam()), 1.0, 1e-7);
  EXPECT_NEAR(bar.volume_change_rel, 0.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Stretch, Bar, testing::Values(0.7, 0.85, 1.5));

/// Dead forces on a face with hanging nodes, whose part goes to their masters.
TEST(DeadForce, OnHangingNodesPullsTheBarUniformly) {
  const Mesh<3> mesh = verification::graded_cube(L_m);
  const scene::Material rubber{3e6, 0.3};
  constexpr double stretch = 1.2;
  ContactProblem<3> body(mesh, rubber, scene::Kinematics::finite, true, true);
  for (const int i : {0, 1, 2}) {
    for (const int node : verification::nodes_where<3>(
             mesh, [i](const Eigen::Vector3d& x_m) { return std::abs(x_m[i]) < 1e-9 * L_m; })) {
      body.prescribe(node, i, 0.0);
    }
  }
  const Eigen::Vector3d traction_pa(0.0, 0.0, verification::neo_hookean_bar_pa(rubber, stretch));
  const auto top = [](const Eigen::Vector3d& x_m) { return x_m.z() > (1.0 - 1e-9) * L_m; };
  const State<3> state = verification::solve_in_steps<3>(
      body, 2, "bar", [&](double share) { body.load(verification::traction_force_n(mesh, share * traction_pa, top)); });
  for (int node = 0; node < mesh.node_count(); ++node) {
    ASSERT_NEAR(state.u_m(2, node), (stretch - 1.0) * mesh.points_m(2, node), 1e-8 * L_m);
  }
}

}  // namespace
}  // namespace touchstone::reference
