// The Cholesky factor of a part of a symmetric positive definite matrix, as indices join the part and leave it.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace touchstone::compare {

/// All storage is taken at construction. A change takes operations of the order of the part's size squared.
class GrowingCholesky {
 public:
  /// @param matrix  must outlive this
  explicit GrowingCholesky(const Eigen::MatrixXd& matrix);

  /// Indices of the part, in the order of the factor's rows.
  [[nodiscard]] const std::vector<Eigen::Index>& part() const noexcept { return part_; }

  /// A part at once: cheaper than one by one where much of it is new. @returns false, the part empty, when it is not
  /// positive definite
  bool assign(const std::vector<Eigen::Index>& part);

  /// @returns false, nothing changed, when the part would no longer be positive definite
  bool add(Eigen::Index index);

  /// @param row  place in part()
  void remove(Eigen::Index row);

  /// In place. @param x one entry per index of the part
  void solve(Eigen::Ref<Eigen::VectorXd> x) const;

 private:
  const Eigen::MatrixXd& matrix_;
  Eigen::MatrixXd upper_;  ///< U of U' U, in the leading part().size() rows and columns; below it anything
  std::vector<Eigen::Index> part_;
};

}  // namespace touchstone::compare
