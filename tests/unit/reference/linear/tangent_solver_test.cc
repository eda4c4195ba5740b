#include "reference/linear/tangent_solver.h"

#include <gtest/gtest.h>
#include <Eigen/SparseCore>

#include <cmath>
#include <numbers>
#include <vector>

namespace touchstone::reference {
namespace {

constexpr int side = 22;

/// Seven-point Laplacian on a cube of side^3 points, plus a diagonal that varies by `spread` from point to point.
SymmetricMatrix laplacian(double shift, double spread) {
  SymmetricMatrix K{{0}, {}, {}};
  for (int n = 0; n < side * side * side; ++n) {
    K.row.push_back(n);
    K.value.push_back(6.0 + shift + spread * std::sin(n));
    const int step[] = {1, side, side * side};
    const int place[] = {n % side, n / side % side, n / (side * side)};
    for (int d = 0; d < 3; ++d) {
      if (place[d] + 1 == side) continue;
      K.row.push_back(n + step[d]);
      K.value.push_back(-1.0);
    }
    K.column_begin.push_back(static_cast<std::int64_t>(K.row.size()));
  }
  return K;
}

/// Smallest eigenvalue of laplacian(0, 0).
double lowest() { return 3.0 * (2.0 - 2.0 * std::cos(std::numbers::pi / (side + 1))); }

Eigen::SparseMatrix<double> whole(const SymmetricMatrix& K) {
  Eigen::SparseMatrix<double> result(K.size(), K.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < K.size(); ++j) {
    for (std::int64_t k = K.column_begin[j]; k < K.column_begin[j + 1]; ++k) {
      entries.emplace_back(K.row[k], j, K.value[k]);
      if (K.row[k] != j) entries.emplace_back(j, K.row[k], K.value[k]);
    }
  }
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Eigen::VectorXd load(int n) {
  return Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::cos(0.1 * i); });
}

TEST(TangentSolver, OneFactorServesMatricesNearIt) {
  TangentSolver solver(1);
  solver.analyse(laplacian(0.0, 0.0));
  for (const double spread : {0.0, 0.01, 0.02, 0.03}) {
    const SymmetricMatrix K = laplacian(0.0, spread);
    const Eigen::VectorXd b = load(static_cast<int>(K.size()));
    Eigen::VectorXd x = b;
    ASSERT_TRUE(solver.solve(K, 1e-8, x));
    EXPECT_LT((whole(K) * x - b).norm(), 1e-6 * b.norm()) << spread;
    EXPECT_TRUE(solver.positive_definite(K));
  }
  EXPECT_EQ(solver.work().factorisations, 1);
  EXPECT_GT(solver.work().iterations, 3);
}

TEST(TangentSolver, LooserTolerancesTakeFewerIterationsAndKeepTheirPromise) {
  const SymmetricMatrix K = laplacian(0.0, 0.03);
  const Eigen::SparseMatrix<double> all = whole(K);
  const Eigen::VectorXd b = load(static_cast<int>(K.size()));
  int before = 0;
  for (const double tolerance : {1e-3, 1e-5, 1e-8}) {
    TangentSolver solver(1);
    solver.analyse(K);
    Eigen::VectorXd exact = b, x = b;
    const SymmetricMatrix near = laplacian(0.0, 0.0);
    ASSERT_TRUE(solver.solve(near, 1e-10, x));
    x = b;
    ASSERT_TRUE(solver.solve(K, tolerance, x));
    EXPECT_GT(solver.work().iterations, before);
    before = solver.work().iterations;
    solver.forget();
    ASSERT_TRUE(solver.solve(K, 1e-10, exact));
    EXPECT_EQ(solver.work().factorisations, 2);
    const Eigen::VectorXd error = x - exact;
    // The norm is that of the earlier matrix, here within a factor of three.
    EXPECT_LT(std::sqrt(error.dot(all * error)), 3.0 * tolerance * std::sqrt(exact.dot(all * exact)));
  }
}

TEST(TangentSolver, FarMatrixIsFactorisedAnew) {
  TangentSolver solver(1);
  solver.analyse(laplacian(0.0, 0.0));
  for (const double shift : {0.0, 3000.0}) {
    const SymmetricMatrix K = laplacian(shift, 0.9 * shift);
    const Eigen::VectorXd b = load(static_cast<int>(K.size()));
    Eigen::VectorXd x = b;
    ASSERT_TRUE(solver.solve(K, 1e-10, x));
    EXPECT_LT((whole(K) * x - b).norm(), 1e-10 * b.norm());
  }
  EXPECT_EQ(solver.work().factorisations, 2);
}

TEST(TangentSolver, RefusesWhatIsNotPositiveDefinite) {
  for (const bool with_old_factor : {false, true}) {
    TangentSolver solver(1);
    solver.analyse(laplacian(0.0, 0.0));
    Eigen::VectorXd x = load(side * side * side);
    if (with_old_factor) {
      ASSERT_TRUE(solver.solve(laplacian(0.0, 0.0), 1e-10, x));
    }
    const Eigen::VectorXd b = load(side * side * side);
    x = b;
    EXPECT_FALSE(solver.solve(laplacian(-1.5 * lowest(), 0.0), 1e-10, x));
    EXPECT_EQ(x, b);
  }
}

TEST(TangentSolver, SeesTheUnstableDirectionThatTheLoadDoesNot) {
  TangentSolver solver(1);
  const SymmetricMatrix stable = laplacian(0.0, 0.0), unstable = laplacian(-1.2 * lowest(), 0.0);
  solver.analyse(stable);
  // An eigenvector of both, odd about the cube's centre: the one unstable direction is even.
  Eigen::VectorXd odd(stable.size());
  for (int n = 0; n < stable.size(); ++n) {
    const auto wave = [](int i, int halves) { return std::sin(std::numbers::pi * halves * (i + 1) / (side + 1)); };
    odd[n] = wave(n % side, 2) * wave(n / side % side, 1) * wave(n / (side * side), 1);
  }
  Eigen::VectorXd x = odd;
  ASSERT_TRUE(solver.solve(stable, 1e-10, x));
  x = odd;
  ASSERT_TRUE(solver.solve(unstable, 1e-6, x));
  ASSERT_EQ(solver.work().factorisations, 1);
  EXPECT_FALSE(solver.positive_definite(unstable));
}

TEST(TangentSolver, ForgettingMakesTheNextSolveTheFirst) {
  const SymmetricMatrix K = laplacian(0.0, 0.3);
  const Eigen::VectorXd b = load(static_cast<int>(K.size()));
  TangentSolver fresh(1), used(1);
  fresh.analyse(K);
  used.analyse(K);
  Eigen::VectorXd x = b, y = b;
  ASSERT_TRUE(fresh.solve(K, 1e-3, x));
  ASSERT_TRUE(used.solve(laplacian(0.0, 0.0), 1e-3, y));
  used.forget();
  y = b;
  ASSERT_TRUE(used.solve(K, 1e-3, y));
  EXPECT_EQ(x, y);
}

TEST(TangentSolver, KnowsTheSizeOfTheFactorBeforehand) {
  TangentSolver solver(1);
  EXPECT_EQ(solver.predicted_factor_bytes(), 0);
  solver.analyse(laplacian(0.0, 0.0));
  // At least the band of one plane's elimination, at most the whole lower triangle.
  const double n = side * side * side;
  EXPECT_GT(solver.predicted_factor_bytes(), 8.0 * side * side * side * side / 2.0);
  EXPECT_LT(solver.predicted_factor_bytes(), 8.0 * n * n / 2.0);
}

}  // namespace
}  // namespace touchstone::reference
