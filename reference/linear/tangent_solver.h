// Newton's linear systems: conjugate gradients on the tangent of now, preconditioned by the Cholesky factor of an
// earlier one. The factorisation is most of a solve in three dimensions, and one serves several iterations.
#pragma once

#include "reference/linear/cholmod_solver.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

namespace touchstone::reference {

/// CHOLMOD with a memory. Whether a factor is kept follows from counted operations, never from a clock: equal calls
/// give equal results.
class TangentSolver : public LinearSolver {
 public:
  /// @param threads of the BLAS; set for the process
  explicit TangentSolver(int threads);

  /// Forgets the factor.
  void analyse(const SymmetricMatrix& pattern) override;
  [[nodiscard]] bool factorise(const SymmetricMatrix& K) override;
  void solve(Eigen::VectorXd& x) override;
  void solve_columns(Eigen::MatrixXd& x) override { cholesky_.solve_columns(x); }

  /// By the factor there is and conjugate gradients, or by a new factor.
  /// @param tolerance_rel of the energy norm |x| = sqrt(x' K x), with a K that may be an earlier one: the error of x
  ///                      over x. Stiff directions, such as those that change volume, have no more weight than soft
  ///                      ones
  [[nodiscard]] bool solve(const SymmetricMatrix& K, double tolerance_rel, Eigen::VectorXd& x) override;

  /// The factor of this K shows it where there is one, otherwise conjugate gradients with an arbitrary right-hand side,
  /// in which every direction of negative curvature has its part, and where they doubt it a factorisation.
  [[nodiscard]] bool positive_definite(const SymmetricMatrix& K) override;

  void forget() noexcept override;

  /// Memory of a factor on the analysed pattern, known before anything is factorised.
  [[nodiscard]] std::int64_t predicted_factor_bytes() const noexcept { return cholesky_.predicted_factor_bytes(); }

  [[nodiscard]] LinearWork work() const noexcept override { return work_; }
  [[nodiscard]] std::string description() const override { return cholesky_.description(); }

 private:
  /// Below this many solves to a factorisation nothing is saved by keeping one.
  static constexpr double cheap_factor = 8.0;
  static constexpr int most_iterations = 200;
  static constexpr double probe_tolerance_rel = 1e-3;

  [[nodiscard]] bool worth_keeping(double tolerance_rel) const;
  /// Conjugate gradients with the factor there is. @returns false when they do not arrive or K is not positive definite
  [[nodiscard]] bool iterate(const SymmetricMatrix& K, double tolerance_rel, Eigen::VectorXd& x);

  CholmodSolver cholesky_;
  LinearWork work_;
  bool has_factor_ = false;
  bool factor_is_current_ = false;  // of the K given last
  // Since the factor was made.
  int solves_ = 0, iterations_ = 0;
  double decades_per_iteration_ = 1.0;  // of the residual, in the last solve
};

}  // namespace touchstone::reference
