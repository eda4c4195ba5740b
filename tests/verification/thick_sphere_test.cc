// Inflation of a thick incompressible neo-Hookean sphere: the displacement is known exactly, so its order can be
// asserted.
#include "reference/contact_problem.h"
#include "reference/verification/closed_forms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::reference {
namespace {

constexpr double A_m = 0.01, B_m = 0.02, stretch = 1.25;

/// Upper half of the sphere in its meridian plane, n x n cells in radius and angle.
Mesh<2> half_shell(int n) {
  Mesh<2> mesh;
  const int row = 2 * n + 1;
  mesh.points_m.resize(2, row * row);
  for (int j = 0; j < row; ++j) {
    for (int i = 0; i < row; ++i) {
      const double R_m = A_m + (B_m - A_m) * i / (2 * n), angle = 0.5 * M_PI * j / (2 * n);  // from the plane up
      mesh.points_m.col(j * row + i) << (j == 2 * n ? 0.0 : R_m * std::cos(angle)), R_m * std::sin(angle);
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      std::array<int, 9> cell;
      for (int a = 0; a < 9; ++a) cell[a] = (2 * j + a / 3) * row + 2 * i + a % 3;
      mesh.cells.push_back(cell);
    }
    // The axis, where nothing moves sideways.
    mesh.faces.push_back({{2 * n * row + 2 * j, 2 * n * row + 2 * j + 1, 2 * n * row + 2 * j + 2}, Boundary::plane_x});
  }
  return mesh;
}

struct Errors {
  double displacement_l2 = 0.0;  ///< relative
  double pressure_rel = 0.0;     ///< of the inner pressure
};

Errors inflate(int n) {
  const Mesh<2> mesh = half_shell(n);
  const int row = 2 * n + 1;
  const scene::Material rubber{3e6, 0.5};
  ContactProblem<2> body(mesh, rubber, scene::Kinematics::finite, false, false);
  for (int k = 0; k < row; ++k) {
    body.prescribe(k, 1, 0.0);
    const Eigen::Vector2d u_m = (stretch - 1.0) * mesh.points_m.col(k * row);
    for (int i = 0; i < 2; ++i) body.prescribe(k * row, i, u_m[i]);
  }
  State<2> state = body.rest();
  const NewtonReport report = body.solve(state);
  EXPECT_TRUE(report.converged) << report.trouble;

  Errors errors;
  double difference2 = 0.0, size2 = 0.0;
  const GaussRule<2> rule;
  for (const auto& cell : mesh.cells) {
    Eigen::Matrix<double, 2, 9> X, u;
    for (int a = 0; a < 9; ++a) {
      X.col(a) = mesh.points_m.col(cell[a]);
      u.col(a) = state.u_m.col(cell[a]);
    }
    for (int q = 0; q < GaussRule<2>::size; ++q) {
      const Q2<2> shape(rule.points[q]);
      const Eigen::Vector2d place = X * shape.value;
      const double R_m = place.norm();
      const double W = rule.weights[q] * std::abs(Eigen::Matrix2d(X * shape.gradient).determinant()) * place[0];
      const Eigen::Vector2d exact = place * (verification::thick_sphere_radius_m(A_m, stretch, R_m) / R_m - 1.0);
      difference2 += W * (u * shape.value - exact).squaredNorm();
      size2 += W * exact.squaredNorm();
    }
  }
  errors.displacement_l2 = std::sqrt(difference2 / size2);
  // Virtual work of the inner pressure in a unit radial motion: p 2 pi a^2 over the half sphere.
  const auto F = body.internal_forces(state);
  double work_n = 0.0;
  for (int k = 0; k < row; ++k) work_n += F.col(k * row).dot(mesh.points_m.col(k * row)) / A_m;
  const double p_pa = work_n / (2.0 * M_PI * stretch * A_m * stretch * A_m);
  errors.pressure_rel =
      p_pa / verification::thick_sphere_pressure_pa(rubber.shear_modulus_pa(), A_m, B_m, stretch) - 1.0;
  return errors;
}

// Quadratic displacement with linear discontinuous pressure: the L2 error of the displacement falls like h^3 (Boffi,
// Brezzi, Fortin, Mixed Finite Element Methods, 8.6.3, with the usual duality argument).
TEST(ThickSphere, DisplacementConvergesWithOrderThree) {
  const Errors coarse = inflate(4), middle = inflate(8), fine = inflate(16);
  EXPECT_NEAR(verification::observed_order(coarse.displacement_l2, middle.displacement_l2), 3.0, 0.3);
  EXPECT_NEAR(verification::observed_order(middle.displacement_l2, fine.displacement_l2), 3.0, 0.3);
  EXPECT_LT(fine.displacement_l2, 1e-4);
}

TEST(ThickSphere, InnerPressure) { EXPECT_NEAR(inflate(16).pressure_rel, 0.0, 1e-3); }

}  // namespace
}  // namespace touchstone::reference
