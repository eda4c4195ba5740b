#include "compare/model/growing_cholesky.h"

#include <Eigen/Cholesky>

#include <cmath>

namespace touchstone::compare {

GrowingCholesky::GrowingCholesky(const Eigen::MatrixXd& matrix)
    : matrix_(matrix), upper_(matrix.rows(), matrix.cols()) {
  part_.reserve(static_cast<std::size_t>(matrix.rows()));
}

bool GrowingCholesky::assign(const std::vector<Eigen::Index>& part) {
  const auto m = static_cast<Eigen::Index>(part.size());
  Eigen::Ref<Eigen::MatrixXd> block = upper_.topLeftCorner(m, m);
  block = matrix_(part, part);
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Upper> factor(block);
  part_.clear();
  if (factor.info() != Eigen::Success) return false;
  part_.assign(part.begin(), part.end());
  return true;
}

bool GrowingCholesky::add(Eigen::Index index) {
  const auto m = static_cast<Eigen::Index>(part_.size());
  auto column = upper_.col(m).head(m);
  for (Eigen::Index i = 0; i < m; ++i) column[i] = matrix_(part_[static_cast<std::size_t>(i)], index);
  if (m > 0) upper_.topLeftCorner(m, m).triangularView<Eigen::Upper>().transpose().solveInPlace(column);
  const double left = matrix_(index, index) - column.squaredNorm();
  if (!(left > 1e-14 * matrix_(index, index))) return false;
  upper_(m, m) = std::sqrt(left);
  part_.push_back(index);
  return true;
}

void GrowingCholesky::remove(Eigen::Index row) {
  const auto m = static_cast<Eigen::Index>(part_.size());
  part_.erase(part_.begin() + row);
  // The later columns move up by one, which leaves one entry below the diagonal in each. Givens rotations of two rows
  // at a time remove these entries.
  for (Eigen::Index j = row; j + 1 < m; ++j) upper_.col(j).head(j + 2) = upper_.col(j + 1).head(j + 2);
  for (Eigen::Index k = row; k + 1 < m; ++k) {
    const double a = upper_(k, k), b = upper_(k + 1, k);
    const double length = std::hypot(a, b), c = a / length, s = b / length;
    for (Eigen::Index j = k; j + 1 < m; ++j) {
      const double above = upper_(k, j), below = upper_(k + 1, j);
      upper_(k, j) = c * above + s * below;
      upper_(k + 1, j) = c * below - s * above;
    }
  }
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): a view of what it changes
void GrowingCholesky::solve(Eigen::Ref<Eigen::VectorXd> x) const {
  const auto m = static_cast<Eigen::Index>(part_.size());
  if (m == 0) return;
  const auto U = upper_.topLeftCorner(m, m).triangularView<Eigen::Upper>();
  U.transpose().solveInPlace(x);
  U.solveInPlace(x);
}

}  // namespace touchstone::compare
