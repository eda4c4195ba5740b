// Newton's linear systems: conjugate gradients on the tangent of now, preconditioned by the Cholesky factor of an
// earlier one. The factorisation is most of a solve in three dimensions, and one serves several iterations.
#pragma once

#include "reference/linear_solver.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <cstdint>
#include <string>

namespace touchstone::reference {

/// What a solver did since it was made.
struct TangentWork {
  int factorisations = 0;
  int iterations = 0;       ///< of the Krylov solvers, one application of a factor each
  double analysis_s = 0.0;  ///< processor time of all threads, as the others
  double factorisation_s = 0.0;
  double iteration_s = 0.0;
};

/// Solves (K + C) x = b again and again on one pattern of K. K is symmetric; where it is not positive definite it is
/// refused, for a balance with such a tangent is not stable. C is what makes the whole unsymmetric, as friction does.
/// Whether a factor is kept follows from counted operations, never from a clock: equal calls give equal results.
class TangentSolver {
 public:
  /// @param direct  makes and keeps the factors; must outlive this
  explicit TangentSolver(LinearSolver& direct) : direct_(direct) {}

  /// Ordering and symbolic factorisation; forgets the factor. @throws std::runtime_error out of memory
  void analyse(const SymmetricMatrix& pattern);

  /// Without C by conjugate gradients, with it by GMRES; either by the factor alone when that is of this K and C is
  /// absent.
  /// @param C size as K, or nullptr
  /// @param tolerance_rel of the energy norm |x| = sqrt(x' K x), with a K that may be an earlier one: the error of x
  /// over
  ///                      x. Stiff directions, such as those that change volume, have no more weight than soft ones
  /// @param x in: b; out: the solution, or still b when there is none
  /// @returns false when K is not positive definite, or nearly singular, or K + C cannot be solved
  /// @throws std::runtime_error out of memory
  [[nodiscard]] bool solve(const SymmetricMatrix& K, const Eigen::SparseMatrix<double>* C, double tolerance_rel,
                           Eigen::VectorXd& x);

  /// Whether the K of the last solve(), given once more, is positive definite: its factor says so where there is one,
  /// otherwise conjugate gradients with an arbitrary right-hand side, in which every direction of negative curvature
  /// has its part, and where they doubt it a factorisation.
  [[nodiscard]] bool positive_definite(const SymmetricMatrix& K);

  /// Drops the factor: what comes next does not depend on what was before.
  void forget() noexcept;

  /// Memory of a factor on the analysed pattern, known before anything is factorised.
  [[nodiscard]] std::int64_t predicted_factor_bytes() const noexcept { return direct_.predicted_factor_bytes(); }

  [[nodiscard]] const TangentWork& work() const noexcept { return work_; }

  /// "CHOLMOD 3.0.14 on OpenBLAS 0.3.21 ..., 2 threads"
  [[nodiscard]] std::string description() const { return direct_.description(); }

 private:
  /// Below this many solves to a factorisation nothing is saved by keeping one.
  static constexpr double cheap_factor = 8.0;
  static constexpr int most_iterations = 200, between_restarts = 50;
  static constexpr double probe_tolerance_rel = 1e-3;

  [[nodiscard]] bool factorise(const SymmetricMatrix& K);
  [[nodiscard]] bool worth_keeping(double tolerance_rel) const;
  /// Krylov iterations with the factor there is. @returns false when they do not arrive or K is not positive definite
  [[nodiscard]] bool iterate(const SymmetricMatrix& K, const Eigen::SparseMatrix<double>* C, double tolerance_rel,
                             int most, Eigen::VectorXd& x);
  [[nodiscard]] int most_iterations_worth() const;

  LinearSolver& direct_;
  TangentWork work_;
  bool has_factor_ = false;
  bool factor_is_current_ = false;  // of the K last given to solve()
  // Since the factor was made.
  int solves_ = 0, iterations_ = 0;
  double decades_per_iteration_ = 1.0;  // of the residual, in the last solve
};

}  // namespace touchstone::reference
