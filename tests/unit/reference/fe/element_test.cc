// Stress is the slope of the energy, the tangent is the slope of the force: by central differences.
#include "reference/fe/element.h"

#include "reference/mesh/mesh.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

namespace touchstone::reference {
namespace {

TEST(NeoHookean, StressIsTheSlopeOfTheEnergy) {
  const Eigen::Matrix3d H = (Eigen::Matrix3d() << 0.2, 0.1, -0.3, 0.05, -0.25, 0.15, 0.1, 0.2, 0.3).finished();
  const double mu_pa = 2.0, p_pa = -0.7, step = 1e-6;
  const auto energy = [&](const Eigen::Matrix3d& h) {
    return isochoric_energy_per_m3(h, mu_pa) + p_pa * volume_change(h);
  };
  const PointLaw law = neo_hookean(H, mu_pa, p_pa);
  const Eigen::Matrix3d P = (law.tau_iso_pa + law.pJ_pa * Eigen::Matrix3d::Identity()) * law.F_inverse.transpose();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      Eigen::Matrix3d up = H, down = H;
      up(i, j) += step;
      down(i, j) -= step;
      EXPECT_NEAR(P(i, j), (energy(up) - energy(down)) / (2.0 * step), 1e-8);
    }
  }
}

TEST(NeoHookean, SmallStrainIsItsLimit) {
  const Eigen::Matrix3d H = 1e-7 * (Eigen::Matrix3d() << 1, 2, 3, -4, 5, 6, 7, -8, 9).finished();
  const PointLaw finite = neo_hookean(H, 2.0, 0.0), small = linear_elastic(H, 2.0, 0.0);
  EXPECT_LT((finite.tau_iso_pa - small.tau_iso_pa).norm(), 1e-5 * small.tau_iso_pa.norm());
  EXPECT_NEAR(finite.J_minus_1 / small.J_minus_1, 1.0, 1e-5);
}

/// A cell with its nodes at X_m.
template <int dim>
CellGeometry<dim> cell_of(const typename Element<dim>::Nodal& X_m) {
  using Point = Eigen::Matrix<double, dim, 1>;
  MappedSpec<dim> spec;
  for (int v = 0; v < 1 << dim; ++v) {
    Point& vertex = spec.vertices.emplace_back();
    for (int d = 0; d < dim; ++d) vertex[d] = v >> d & 1;
    spec.cells.resize(1);
    spec.cells[0][v] = v;
  }
  spec.place_m = [&](const Point& xi) -> Point {
    int a = 0;
    for (int d = dim - 1; d >= 0; --d) a = 3 * a + static_cast<int>(2.0 * xi[d]);
    return X_m.col(a);
  };
  spec.boundary = [](const Point&) { return Boundary::free; };
  spec.grading.largest_m = 1e3;
  return mapped_mesh(spec).cell_geometry().at(0);
}

template <int dim>
void expect_consistent_tangent(scene::Kinematics kinematics, double nu, bool crossed = false) {
  const Element<dim> element(MixedMaterial({2.0, nu}, kinematics), {MixedMaterial({9.0, 0.2}, kinematics)});
  typename Element<dim>::Materials materials{};
  for (std::size_t q = 0; crossed && q < materials.size(); q += 2) materials[q] = 1;
  typename Element<dim>::Nodal X, u;
  for (int a = 0; a < Element<dim>::nodes; ++a) {
    const int place[3] = {a % 3, a / 3 % 3, a / 9};
    for (int d = 0; d < dim; ++d) {
      X(d, a) = 1.0 + 0.5 * place[d] + 0.03 * std::sin(3.0 * a + d);
      u(d, a) = 0.05 * std::sin(2.0 * a + 1.7 * d);
    }
  }
  const CellGeometry<dim> cell = cell_of<dim>(X);
  using Cell = CellResult<dim>;
  typename Element<dim>::Pressure p = Element<dim>::Pressure::Constant(0.1);
  Cell at, up, down;
  ASSERT_TRUE(element.evaluate(cell, u, p, Stiffness::consistent, at, &materials));
  // Along du the pressure row asks for dp = gain du; so the condensed stiffness is the slope of the force on that line.
  const double step = 1e-6;
  for (int k = 0; k < Cell::unknowns; k += 5) {
    const int i = k / Cell::nodes, a = k % Cell::nodes;
    const typename Element<dim>::Pressure dp = at.pressure_gain.col(k);
    typename Element<dim>::Nodal v = u;
    v(i, a) = u(i, a) + step;
    ASSERT_TRUE(element.evaluate(cell, v, p + step * dp, Stiffness::none, up, &materials));
    v(i, a) = u(i, a) - step;
    ASSERT_TRUE(element.evaluate(cell, v, p - step * dp, Stiffness::none, down, &materials));
    const typename Cell::Vector slope = (up.force_n - down.force_n) / (2.0 * step);
    EXPECT_LT((at.stiffness.col(k) - slope).norm(), 1e-6 * at.stiffness.norm()) << "unknown " << k;
    // The pressure row itself stays solved to first order while kappa is the tangent's.
    if (nu < 0.49) {
      EXPECT_LT(((up.volume_m3 - down.volume_m3) / (2.0 * step)).norm(), 1e-6 * at.rest_volume_m3);
    }
  }
  EXPECT_LT((at.stiffness - at.stiffness.transpose()).norm(), 1e-12 * at.stiffness.norm());
}

template <int dim>
void expect_definite_stiffness(double p_pa) {
  const Element<dim> element(MixedMaterial({2.0, 0.5}, scene::Kinematics::finite));
  typename Element<dim>::Nodal X, u;
  for (int a = 0; a < Element<dim>::nodes; ++a) {
    const int place[3] = {a % 3, a / 3 % 3, a / 9};
    for (int d = 0; d < dim; ++d) {
      X(d, a) = 1.0 + 0.5 * place[d];
      u(d, a) = 0.03 * std::sin(2.0 * a + 1.7 * d);
    }
  }
  const CellGeometry<dim> cell = cell_of<dim>(X);
  typename Element<dim>::Pressure p = Element<dim>::Pressure::Zero();
  p[0] = p_pa;
  const auto eigenvalues = [&](Stiffness stiffness) -> Eigen::VectorXd {
    CellResult<dim> result;
    EXPECT_TRUE(element.evaluate(cell, u, p, stiffness, result));
    return result.stiffness.template selfadjointView<Eigen::Lower>().eigenvalues();
  };
  EXPECT_LT(eigenvalues(Stiffness::consistent).minCoeff(), -0.1);
  EXPECT_GT(eigenvalues(Stiffness::definite).minCoeff(), -1e-9);
}

TEST(Element, DefiniteStiffnessIsSoUnderPressureAndTension) {
  for (const double p_pa : {-30.0, 30.0}) {
    expect_definite_stiffness<2>(p_pa);
    expect_definite_stiffness<3>(p_pa);
  }
}

TEST(Element, TangentIsTheSlopeOfTheForceWhereTwoMaterialsMeet) {
  for (const auto kinematics : {scene::Kinematics::finite, scene::Kinematics::small}) {
    for (const double nu : {0.1, 0.3, 0.5}) {  // the other has 0.2
      expect_consistent_tangent<2>(kinematics, nu, true);
      expect_consistent_tangent<3>(kinematics, nu, true);
    }
  }
}

TEST(Element, TangentIsTheSlopeOfTheForce) {
  for (const auto kinematics : {scene::Kinematics::finite, scene::Kinematics::small}) {
    for (const double nu : {0.0, 0.3, 0.5}) {
      expect_consistent_tangent<2>(kinematics, nu);
      expect_consistent_tangent<3>(kinematics, nu);
    }
  }
}

}  // namespace
}  // namespace touchstone::reference
