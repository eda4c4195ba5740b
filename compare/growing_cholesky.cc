#include "compare/growing_cholesky.h"

#include <algorithm>
#include <cmath>

namespace touchstone::compare {

GrowingCholesky::GrowingCholesky(const Eigen::MatrixXd& matrix)
    : matrix_(matrix), lower_(matrix.rows(), matrix.cols()) {
  part_.reserve(static_cast<std::size_t>(matrix.rows()));
}

bool GrowingCholesky::add(Eigen::Index index) {
  const auto m = static_cast<Eigen::Index>(part_.size());
  auto row = lower_.row(m).head(m);
  // Row m of L by forward substitution, a column of L at a time.
  for (Eigen::Index j = 0; j < m; ++j) row[j] = matrix_(part_[static_cast<std::size_t>(j)], index);
  if (m > 0) {
    lower_.topLeftCorner(m, m).triangularView<Eigen::Lower>().solveInPlace(row.transpose());
  }
  const double left = matrix_(index, index) - row.squaredNorm();
  if (!(left > 1e-14 * matrix_(index, index))) return false;
  lower_(m, m) = std::sqrt(left);
  part_.push_back(index);
  return true;
}

void GrowingCholesky::remove(Eigen::Index row) {
  const auto m = static_cast<Eigen::Index>(part_.size());
  part_.erase(part_.begin() + row);
  // The rows below move up by one, which leaves an entry above the diagonal in each; rotations of two columns at a time
  // take them away.
  for (Eigen::Index j = 0; j < m; ++j) {
    for (Eigen::Index i = std::max(row, j - 1); i + 1 < m; ++i) lower_(i, j) = lower_(i + 1, j);
  }
  for (Eigen::Index k = row; k + 1 < m; ++k) {
    const double a = lower_(k, k), b = lower_(k, k + 1);
    const double length = std::hypot(a, b), c = a / length, s = b / length;
    for (Eigen::Index i = k; i + 1 < m; ++i) {
      const double left = lower_(i, k), right = lower_(i, k + 1);
      lower_(i, k) = c * left + s * right;
      lower_(i, k + 1) = c * right - s * left;
    }
  }
}

void GrowingCholesky::solve(Eigen::Ref<Eigen::VectorXd> x) const {
  const auto m = static_cast<Eigen::Index>(part_.size());
  if (m == 0) return;
  const auto L = lower_.topLeftCorner(m, m).triangularView<Eigen::Lower>();
  L.solveInPlace(x);
  L.transpose().solveInPlace(x);
}

}  // namespace touchstone::compare
