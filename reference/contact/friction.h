// Friction of a contact region as a law for every active node, and its unsymmetric part of the tangent.
#pragma once

#include "scene/model/scene.h"

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <functional>

namespace touchstone::reference {

/// The scene's friction, which limits the friction of a whole region, applied to its nodes: |t_A| <= m N_A with one m
/// for all of them. The limits of the nodes then sum to m F_n, F_n = sum N_A, which is the region's limit.
class FrictionLaw {
 public:
  explicit FrictionLaw(const scene::Friction& friction) noexcept : friction_(friction) {}

  /// m of a region under the normal force F_n > 0 [N]. Sticking regions have m F_n = K F_n^beta; slipping ones mu_D
  /// F_n, but at most the limit of sticking (paper, IV-B, condition C4).
  [[nodiscard]] double coefficient(double normal_n, bool sliding) const noexcept;
  [[nodiscard]] double mu_D() const noexcept { return friction_.mu_D; }

 private:
  scene::Friction friction_;
};

/// Coupling of the slipping nodes' friction with their normal forces N = normal_n + row x: the tangent is
/// K + column row, with K symmetric, and the right-hand side b - column normal_n.
struct SlipCoupling {
  Eigen::SparseMatrix<double> column;                // unknowns x slipping nodes
  Eigen::SparseMatrix<double, Eigen::RowMajor> row;  // slipping nodes x unknowns
  Eigen::VectorXd normal_n;                          // at x = 0
  Eigen::VectorXd guess_n;                           // of the solution's normal forces
};

/// Solves (K + column row) x = b - column normal_n for the normal forces first, y + row K^-1 column y = row K^-1 b +
/// normal_n, by the generalised conjugate residual method (S. C. Eisenstat, H. C. Elman, M. H. Schultz, SIAM J. Numer.
/// Anal. 20 (1983) 345-357), every step of which costs one solution with K.
/// @param solve_symmetric  replaces its argument b by K^-1 b
/// @param x  in: b; out: solution
/// @returns solutions with K that it took
int solve_with_slip(const SlipCoupling& slip, const std::function<void(Eigen::VectorXd&)>& solve_symmetric,
                    Eigen::VectorXd& x);

}  // namespace touchstone::reference
