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

  /// The two halves of solve(), one after the other.
  virtual void solve_lower(Eigen::VectorXd& x) = 0;
  virtual void solve_upper(Eigen::VectorXd& x) = 0;

  /// One solve with the matrix that factorise() has just refused. @returns false when singular
  [[nodiscard]] virtual bool solve_indefinite(const SymmetricMatrix& matrix, Eigen::VectorXd& x) = 0;

  /// The matrix, symmetric as it is meant, times x.
  [[nodiscard]] virtual Eigen::VectorXd multiply(const SymmetricMatrix& matrix, const Eigen::VectorXd& x) const;

  /// Memory of the factor, known since analyse().
  [[nodiscard]] virtual std::int64_t predicted_factor_bytes() const noexcept = 0;

  /// Operations of a factorisation over those of a solve, each weighed with the speed the processor has for it. Zero
  /// when the factor serves its own matrix only.
  [[nodiscard]] virtual double factor_cost_in_solves() const noexcept = 0;

  /// The library, its version and how much of the machine it uses.
  [[nodiscard]] virtual std::string description() const = 0;
};

}  // namespace touchstone::reference
