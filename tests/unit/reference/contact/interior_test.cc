// Stress and volume change inside a body that is deformed uniformly, and how they are read at points of the whole body.
#include "reference/contact/interior.h"

#include "reference/fe/neo_hookean.h"
#include "reference/mesh/mesh.h"
#include "reference/mesh/sampling.h"
#include "scene/base/error.h"

#include <gtest/gtest.h>

namespace touchstone::reference {
namespace {

using scene::Kinematics;

constexpr double p_pa = -2e4;
const scene::Material material{3e6, 0.45};

/// The quarter of a cube of 20 mm, with small cells at its top.
Discretisation<3> quarter_cube() {
  BlockSpec spec{{0.0, 0.0, 0.0}, {0.01, 0.01, 0.02}, true, true, {}};
  spec.grading.discs = {{{0.0, 0.0, 0.02}, {0.0, 0.0, 1.0}, 0.002, 0.002}};
  spec.grading.largest_m = 0.01;
  return block_mesh(spec);
}

template <int dim>
State<dim> uniform(const Discretisation<dim>& mesh, const Eigen::Matrix<double, dim, dim>& H) {
  State<dim> state;
  state.u_m = H * mesh.points_m;
  state.p_pa.setZero(dim + 1, mesh.cell_count());
  state.p_pa.row(0).setConstant(p_pa);
  return state;
}

TEST(Interior, IsTheMaterialLawOfAUniformDeformationInEveryImage) {
  const Discretisation<3> mesh = quarter_cube();
  ASSERT_GT(mesh.hanging_count(), 0);
  Eigen::Matrix3d H;
  H << 0.02, 0.03, -0.05, 0.01, -0.04, 0.06, 0.02, -0.03, -0.10;
  const State<3> state = uniform<3>(mesh, H);
  // The last one lies on the sides of several cells, the second one is the first one's mirror image.
  Eigen::Matrix3Xd points_m(3, 3);
  points_m.transpose() << 0.0031, 0.0042, 0.0153, -0.0031, 0.0042, 0.0153, 0.005, 0.005, 0.01;
  const Eigen::Matrix3d mirror = Eigen::Vector3d(-1.0, 1.0, 1.0).asDiagonal();
  for (const Kinematics kinematics : {Kinematics::finite, Kinematics::small}) {
    const bool finite = kinematics == Kinematics::finite;
    const double mu_pa = material.shear_modulus_pa();
    const PointLaw law = finite ? neo_hookean(H, mu_pa, p_pa) : linear_elastic(H, mu_pa, p_pa);
    const Eigen::Matrix3d stress_pa = law.tau_iso_pa / law.J + p_pa * Eigen::Matrix3d::Identity();
    const Interior values = interior(mesh, material, kinematics, state);
    EXPECT_LT((values.J_minus_1.array() - law.J_minus_1).abs().maxCoeff(), 1e-13);
    const BodySampler<3> sampler(mesh, points_m, true, true);
    const auto seen_pa = sampler.tensors(values.stress_pa);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Matrix3d there_pa = k == 1 ? Eigen::Matrix3d(mirror * stress_pa * mirror) : stress_pa;
      EXPECT_LT((seen_pa.col(k).reshaped(3, 3) - there_pa).norm(), 1e-11 * stress_pa.norm()) << k;
      const Eigen::Vector3d moved_m = k == 1 ? Eigen::Vector3d(mirror * H * points_m.col(0)) : H * points_m.col(k);
      EXPECT_LT((sampler.vectors(state.u_m).col(k) - moved_m).norm(), 1e-15) << k;
    }
    EXPECT_NEAR(sampler.numbers(values.J_minus_1)[2], law.J_minus_1, 1e-13);
  }
}

TEST(Interior, TurnsWithTheAngleAroundTheAxis) {
  CylinderSpec spec{0.01, 0.02, {}};
  spec.grading.largest_m = 0.005;
  const Discretisation<2> mesh = cylinder_mesh(spec);
  Eigen::Matrix2d H;  // u_r = 0.03 r, u_z = -0.05 z + 0.04 r
  H << 0.03, 0.0, 0.04, -0.05;
  const Interior values = interior(mesh, material, Kinematics::small, uniform<2>(mesh, H));
  Eigen::Matrix3Xd points_m(3, 2);
  points_m.transpose() << 0.004, 0.0, 0.01, 0.0, 0.004, 0.01;  // on the x axis, on the y axis
  const auto stress_pa = BodySampler<2>(mesh, points_m, false, false).tensors(values.stress_pa);
  const double mu_pa = material.shear_modulus_pa(), third = (0.03 + 0.03 - 0.05) / 3.0;
  Eigen::Matrix3d first_pa = Eigen::Matrix3d::Zero();
  first_pa.diagonal() = (2.0 * mu_pa * (Eigen::Array3d(0.03, 0.03, -0.05) - third) + p_pa).matrix();
  first_pa(0, 2) = first_pa(2, 0) = mu_pa * 0.04;
  EXPECT_LT((stress_pa.col(0).reshaped(3, 3) - first_pa).norm(), 1e-10 * first_pa.norm());
  EXPECT_NEAR(stress_pa(5, 1), mu_pa * 0.04, 1e-6);  // yz on the y axis
  EXPECT_NEAR(stress_pa(2, 1), 0.0, 1e-6);
}

TEST(BodySampler, RefusesAPointOutside) {
  const Discretisation<3> mesh = quarter_cube();
  EXPECT_THROW(BodySampler<3>(mesh, Eigen::Vector3d(0.0, 0.0, 0.0205), true, true), scene::InputError);
  EXPECT_NO_THROW(BodySampler<3>(mesh, Eigen::Vector3d(-0.01, -0.01, 0.02), true, true));
}

}  // namespace
}  // namespace touchstone::reference
