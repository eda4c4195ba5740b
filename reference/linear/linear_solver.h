// What a sparse direct solver of symmetric matrices offers, whichever library does the work.
#pragma once

#include <Eigen/Core>

#include <cstdint>
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

/// What a solver did.
struct LinearWork {
  int factorisations = 0;
  int iterations = 0;       ///< of conjugate gradients, one application of a factor each
  double analysis_s = 0.0;  ///< processor time of all threads, as the others
  double factorisation_s = 0.0;
  double iteration_s = 0.0;
};

/// Analyses a pattern once, then factorises any number of matrices on it.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Ordering and symbolic factorisation. @throws std::runtime_error out of memory, as the following
  virtual void analyse(const SymmetricMatrix& matrix) = 0;

  /// @returns false when the matrix is not positive definite; then solve() must not be called
  [[nodiscard]] virtual bool factorise(const SymmetricMatrix& matrix) = 0;

  /// Solves with the last factor. @param x in: right-hand side; out: solution
  virtual void solve(Eigen::VectorXd& x) = 0;

  /// The same for every column, where the library can at less than the price of one by one.
  virtual void solve_columns(Eigen::MatrixXd& x) {
    for (Eigen::Index k = 0; k < x.cols(); ++k) {
      Eigen::VectorXd column = x.col(k);
      solve(column);
      x.col(k) = column;
    }
  }

  /// Solves for one right-hand side, by whatever is cheapest.
  /// @param tolerance_rel  |L^-1 P (b - K x)| <= tolerance_rel |L^-1 P b| at least, P' L L' P the factor of K or of an
  ///                       older one like it: the residual as an energy
  /// @param x in: b; out: the solution, or still b when there is none
  /// @returns false when K is not positive definite
  [[nodiscard]] virtual bool solve(const SymmetricMatrix& K, [[maybe_unused]] double tolerance_rel,
                                   Eigen::VectorXd& x) {
    if (!factorise(K)) return false;
    solve(x);
    return true;
  }

  /// Whether the K of the last call, given once more, is positive definite, where that call did not refuse it.
  [[nodiscard]] virtual bool positive_definite(const SymmetricMatrix& /*K*/) { return true; }

  /// What comes next does not depend on what was solved before.
  virtual void forget() noexcept {}

  /// What was done since this was made, where it is counted.
  [[nodiscard]] virtual LinearWork work() const noexcept { return {}; }

  /// The library, its version and how much of the machine it uses.
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace touchstone::reference
