// Sparse direct solver for the symmetric tangent: CHOLMOD's supernodal Cholesky.
#pragma once

#include "reference/linear/linear_solver.h"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <string>

namespace touchstone::reference {

class CholmodSolver : public LinearSolver {
 public:
  /// @param threads of the BLAS under the supernodes; set for the process
  explicit CholmodSolver(int threads);
  ~CholmodSolver() override;
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  /// The better ordering of METIS and AMD.
  void analyse(const SymmetricMatrix& matrix) override;
  [[nodiscard]] bool factorise(const SymmetricMatrix& matrix) override;
  void solve(Eigen::VectorXd& x) override;
  void solve_columns(Eigen::MatrixXd& x) override;

  /// The two halves of solve(), for the matrix is P' L L' P: L^-1 P x, and P' L^-T x.
  void solve_lower(Eigen::VectorXd& x);
  void solve_upper(Eigen::VectorXd& x);

  /// Memory of the factor, known since analyse(): supernodes with their zeros.
  [[nodiscard]] std::int64_t predicted_factor_bytes() const noexcept;

  /// Operations of a factorisation over those of a solve, each weighed with the speed the processor has for it.
  [[nodiscard]] double factor_cost_in_solves() const noexcept;

  /// "CHOLMOD 3.0.14 on OpenBLAS 0.3.21 ..., 2 threads"
  [[nodiscard]] std::string description() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchstone::reference
