// States of uniform strain, which the element must hold to round-off on any mesh: patch tests and the uniaxial bar.
#include "reference/contact_problem.h"
#include "reference/mesh.h"
#include "reference/round_mesh.h"
#include "reference/verification/closed_forms.h"

#include <gtest/gtest.h>

#include <random>

namespace touchstone::reference {
namespace {

constexpr double L_m = 0.02;

/// A cube with hanging nodes around one corner of the top.
Mesh<3> graded_cube() {
  BlockSpec spec{Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(L_m), true, true, {}};
  spec.grading = {{{{0.0, 0.0, L_m}, {0.0, 0.0, 1.0}, 0.1 * L_m, 0.125 * L_m}}, 0.5, 0.5 * L_m};
  return block_mesh(spec);
}

template <int dim>
void free_all_boundaries(Mesh<dim>& mesh) {
  for (auto& face : mesh.faces) face.boundary = Boundary::free;
}

template <int dim>
std::vector<char> on_boundary(const Mesh<dim>& mesh) {
  std::vector<char> flags(mesh.node_count(), 0);
  for (const auto& face : mesh.faces) {
    for (const int node : face.nodes) flags[node] = 1;
  }
  for (const auto& hanging : mesh.hanging) flags[hanging.node] = 0;
  return flags;
}

/// Prescribes u = H X on the boundary and expects it inside.
template <int dim>
void expect_patch(const Mesh<dim>& mesh, const Eigen::Matrix<double, dim, dim>& H, scene::Kinematics kinematics,
                  double nu) {
  ContactProblem<dim> body(mesh, {3e6, nu}, kinematics, false, false);
  const std::vector<char> boundary = on_boundary(mesh);
  const Eigen::Matrix<double, dim, Eigen::Dynamic> exact_m = H * mesh.points_m;
  for (int node = 0; node < mesh.node_count(); ++node) {
    for (int i = 0; i < dim && boundary[node]; ++i) body.prescribe(node, i, exact_m(i, node));
  }
  State<dim> state = body.rest();
  const NewtonReport report = body.solve(state);
  ASSERT_TRUE(report.converged) << report.trouble << report.residual_rel;
  EXPECT_LT((state.u_m - exact_m).cwiseAbs().maxCoeff(), 1e-12 * L_m);
  const double p_pa = state.p_pa(0, 0);
  EXPECT_LT((state.p_pa.row(0).array() - p_pa).abs().maxCoeff(), 1e-7 * 3e6);
  EXPECT_LT(state.p_pa.bottomRows(dim).cwiseAbs().maxCoeff(), 1e-7 * 3e6);
}

const Eigen::Matrix3d shear_and_squeeze =
    (Eigen::Matrix3d() << 0.05, 0.08, -0.02, 0.01, -0.06, 0.03, 0.02, -0.04, 0.07).finished();

TEST(PatchTest, ShearedCubeWithHangingNodes) {
  Mesh<3> mesh = graded_cube();
  ASSERT_GT(mesh.hanging.size(), 0u);
  free_all_boundaries(mesh);
  const Eigen::Matrix3d skew = (Eigen::Matrix3d() << 1.0, 0.3, 0.1, 0.0, 1.1, -0.2, 0.2, 0.0, 0.9).finished();
  mesh.points_m = skew * mesh.points_m;
  expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::finite, 0.3);
  expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::small, 0.0);
}

TEST(PatchTest, DistortedHexahedra) {
  BlockSpec spec{Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(L_m), false, false, {{}, 0.5, 0.5 * L_m}};
  Mesh<3> mesh = block_mesh(spec);
  ASSERT_EQ(mesh.cell_count(), 8);
  free_all_boundaries(mesh);
  // Move the vertex in the middle; edges stay straight.
  const Eigen::Vector3d middle = Eigen::Vector3d::Constant(0.5 * L_m), moved(0.62 * L_m, 0.41 * L_m, 0.56 * L_m);
  const Mesh<3> regular = mesh;
  for (int node = 0; node < mesh.node_count(); ++node) {
    const Eigen::Array3d share = 1.0 - (regular.points_m.col(node) - middle).array().abs() / (0.5 * L_m);
    mesh.points_m.col(node) += share.prod() * (moved - middle);
  }
  expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::finite, 0.45);
}

TEST(PatchTest, RingsWithHangingNodes) {
  CylinderSpec spec{L_m, L_m, {{{{0.0, L_m}, {0.0, 1.0}, 0.1 * L_m, 0.03 * L_m}}, 0.5, 0.5 * L_m}};
  Mesh<2> mesh = cylinder_mesh(spec);
  ASSERT_GT(mesh.hanging.size(), 0u);
  free_all_boundaries(mesh);
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
    free_all_boundaries(mesh);
    expect_patch<2>(mesh, Eigen::Matrix2d(Eigen::Vector2d(0.08, -0.1).asDiagonal()), scene::Kinematics::finite, 0.3);
  }
  for (const RoundSpec& spec : specs) {
    Grading<3> grading;
    grading.largest_m = 0.02;
    grading.discs = {{{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.001, 0.006}};
    Mesh<3> mesh = round_mesh<3>(spec, grading);
    ASSERT_GT(mesh.hanging.size(), 0u);
    free_all_boundaries(mesh);
    expect_patch<3>(mesh, shear_and_squeeze, scene::Kinematics::finite, 0.45);
  }
}

class Bar : public testing::TestWithParam<double> {};

TEST_P(Bar, IncompressibleCompressionBetweenLubricatedPlates) {
  const double lam = GetParam();
  Mesh<3> mesh = graded_cube();
  for (auto& face : mesh.faces) {
    if (face.boundary == Boundary::held) face.boundary = Boundary::free;
  }
  const scene::Material rubber{3e6, 0.5};
  ContactProblem<3> body(mesh, rubber, scene::Kinematics::finite, true, true);
  std::vector<char> hanging(mesh.node_count(), 0), top(mesh.node_count(), 0);
  for (const auto& h : mesh.hanging) hanging[h.node] = 1;
  State<3> state = body.rest();
  constexpr int steps = 4;
  for (int step = 1; step <= steps; ++step) {
    for (int node = 0; node < mesh.node_count(); ++node) {
      const double z_m = mesh.points_m(2, node);
      if (hanging[node]) continue;
      if (z_m < 1e-9 * L_m) body.prescribe(node, 2, 0.0);
      if (z_m > (1.0 - 1e-9) * L_m) body.prescribe(node, 2, (lam - 1.0) * L_m * step / steps), top[node] = 1;
    }
    const NewtonReport report = body.solve(state);
    ASSERT_TRUE(report.converged) << report.trouble << " step " << step;
  }
  const auto F = body.internal_forces(state);
  double force_n = 0.0;
  for (int node = 0; node < mesh.node_count(); ++node) force_n += top[node] ? F(2, node) : 0.0;
  const double exact_pa = verification::neo_hookean_bar_pa(rubber.shear_modulus_pa(), lam);
  EXPECT_NEAR(force_n / (L_m * L_m) / exact_pa, 1.0, 1e-7);
  EXPECT_NEAR(body.observe(state).volume_change_rel, 0.0, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Stretch, Bar, testing::Values(0.7, 0.85, 1.5));

}  // namespace
}  // namespace touchstone::reference
