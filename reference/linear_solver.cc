#include "reference/linear_solver.h"

#include <Eigen/SparseCore>

namespace touchstone::reference {

Eigen::VectorXd LinearSolver::multiply(const SymmetricMatrix& matrix, const Eigen::VectorXd& x) const {
  using Lower = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;
  const Eigen::Map<const Lower> lower(matrix.size(), matrix.size(), static_cast<std::int64_t>(matrix.row.size()),
                                      matrix.column_begin.data(), matrix.row.data(), matrix.value.data());
  return lower.selfadjointView<Eigen::Lower>() * x;
}

}  // namespace touchstone::reference
