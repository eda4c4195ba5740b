// Sparse direct solver for the symmetric tangent: CHOLMOD's supernodal Cholesky, UMFPACK when it is not definite.
#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::reference {

/// Lower triangle, diagonal included, by columns with sorted rows.
struct SymmetricMatrix {
  std::vector<std::int64_t> column_begin;  ///< size n + 1
  std::vector<std::int64_t> row;
  std::vector<double> value;
  [[nodiscard]] std::int64_t size() const noexcept { return static_cast<std::int64_t>(column_begin.size()) - 1; }
};

/// Analyses a pattern once, then factorises any number of matrices on it.
class CholmodSolver {
 public:
  /// @param threads of the BLAS under the supernodes; set for the process
  explicit CholmodSolver(int threads);
  ~CholmodSolver();
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  /// Ordering and symbolic factorisation; the better of METIS and AMD. @throws std::runtime_error out of memory
  void analyse(const SymmetricMatrix& matrix);

  /// @returns false when the matrix is not positive definite; then solve() must not be called
  [[nodiscard]] bool factorise(const SymmetricMatrix& matrix);

  /// Solves with the last factor. @param x in: right-hand side; out: solution
  void solve(Eigen::VectorXd& x);

  /// The two halves of solve(), for the matrix is P' L L' P: L^-1 P x, and P' L^-T x.
  void solve_lower(Eigen::VectorXd& x);
  void solve_upper(Eigen::VectorXd& x);

  /// One solve by unsymmetric LU for a matrix factorise() refused: much slower, but indifferent to sign.
  /// @returns false when singular
  [[nodiscard]] static bool solve_indefinite(const SymmetricMatrix& matrix, Eigen::VectorXd& x);

  /// Memory of the factor, known since analyse(): supernodes with their zeros.
  [[nodiscard]] std::int64_t predicted_factor_bytes() const noexcept;

  /// Operations of a factorisation over those of a solve, each weighed with the speed the processor has for it.
  [[nodiscard]] double factor_cost_in_solves() const noexcept;

  /// "CHOLMOD 3.0.14 on OpenBLAS 0.3.21 ..., 2 threads"
  [[nodiscard]] std::string description() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchstone::reference
