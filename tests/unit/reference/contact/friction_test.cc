#include "reference/contact/friction.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>
#include <random>

namespace touchstone::reference {
namespace {

TEST(FrictionLaw, CarriesTheRegionsLimits) {
  const scene::Friction scene{1.0, 0.75, 0.5};
  const FrictionLaw law(scene);
  const double equal_n = std::pow(scene.K / scene.mu_D, 1.0 / (1.0 - scene.beta));  // where both limits are one
  for (const double share : {1e-3, 0.1, 0.9, 1.1, 10.0, 1e3}) {
    const double normal_n = share * equal_n, at_rest_n = scene.K * std::pow(normal_n, scene.beta);
    EXPECT_NEAR(law.coefficient(normal_n, false) * normal_n, at_rest_n, 1e-12 * at_rest_n);
    const double sliding_n = share < 1.0 ? scene.mu_D * normal_n : at_rest_n;
    EXPECT_NEAR(law.coefficient(normal_n, true) * normal_n, sliding_n, 1e-12 * sliding_n);
  }
  EXPECT_EQ(FrictionLaw({0.4, 1.0, 0.3}).coefficient(17.0, false), 0.4);
}

TEST(SlipCoupling, SolvesTheUnsymmetricSystem) {
  constexpr int unknowns = 40, slips = 9;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto matrix = [&](int rows, int columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  const Eigen::MatrixXd A = matrix(unknowns, unknowns);
  const Eigen::MatrixXd K = A * A.transpose() + Eigen::MatrixXd::Identity(unknowns, unknowns);
  const Eigen::MatrixXd column = matrix(unknowns, slips), row = matrix(slips, unknowns);
  const Eigen::VectorXd b = matrix(unknowns, 1), normal_n = matrix(slips, 1);
  SlipCoupling slip;
  slip.column = column.sparseView();
  slip.row = row.sparseView();
  slip.normal_n = normal_n;
  slip.guess_n = matrix(slips, 1);
  Eigen::VectorXd x = b;
  const int solutions = solve_with_slip(
      slip, [&](Eigen::VectorXd& v) { v = K.llt().solve(v).eval(); }, x);
  const Eigen::VectorXd exact = (K + column * row).lu().solve(b - column * normal_n);
  EXPECT_LT((x - exact).norm(), 1e-5 * exact.norm());
  EXPECT_LE(solutions, slips + 2);  // one a dimension, and the first and the last
}

}  // namespace
}  // namespace touchstone::reference
