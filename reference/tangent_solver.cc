#include "reference/tangent_solver.h"

#include "reference/stopwatch.h"

#include <Eigen/IterativeLinearSolvers>
#include <unsupported/Eigen/IterativeSolvers>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace touchstone::reference {
namespace {

/// Ends conjugate gradients from within a product.
struct NegativeCurvature {};

class Tangent;

}  // namespace
}  // namespace touchstone::reference

namespace Eigen::internal {
template <>
struct traits<touchstone::reference::Tangent> : traits<SparseMatrix<double>> {};
}  // namespace Eigen::internal

namespace touchstone::reference {
namespace {

/// L^-1 P (K + C) P' L^-T as Eigen's iterative solvers want it, P' L L' P an older K: nearly the identity. A residual's
/// length is then an energy, which weighs stiff and soft directions alike.
class Tangent : public Eigen::EigenBase<Tangent> {
 public:
  using Scalar = double;
  using RealScalar = double;
  using StorageIndex = int;
  enum { ColsAtCompileTime = Eigen::Dynamic, MaxColsAtCompileTime = Eigen::Dynamic, IsRowMajor = false };

  Tangent(const SymmetricMatrix& K, const Eigen::SparseMatrix<double>* C, LinearSolver& direct)
      : K_(K), C_(C), direct_(direct) {}

  [[nodiscard]] Eigen::Index rows() const { return K_.size(); }
  [[nodiscard]] Eigen::Index cols() const { return K_.size(); }

  template <class Right>
  Eigen::Product<Tangent, Right, Eigen::AliasFreeProduct> operator*(const Eigen::MatrixBase<Right>& x) const {
    return {*this, x.derived()};
  }

  /// @throws NegativeCurvature where there is no C and x' times(x) is not positive
  [[nodiscard]] Eigen::VectorXd times(const Eigen::VectorXd& x) const {
    Eigen::VectorXd u = x;
    direct_.solve_upper(u);
    Eigen::VectorXd product = direct_.multiply(K_, u);
    if (C_) product += *C_ * u;
    direct_.solve_lower(product);
    if (!C_ && x.dot(product) <= 0.0 && !x.isZero(0.0)) throw NegativeCurvature();
    return product;
  }

 private:
  const SymmetricMatrix& K_;
  const Eigen::SparseMatrix<double>* C_;
  LinearSolver& direct_;
};

}  // namespace
}  // namespace touchstone::reference

namespace Eigen::internal {
template <class Right>
struct generic_product_impl<touchstone::reference::Tangent, Right, SparseShape, DenseShape, GemvProduct>
    : generic_product_impl_base<touchstone::reference::Tangent, Right,
                                generic_product_impl<touchstone::reference::Tangent, Right>> {
  template <class Out>
  static void scaleAndAddTo(Out& out, const touchstone::reference::Tangent& tangent, const Right& x, double alpha) {
    out += alpha * tangent.times(x);
  }
};
}  // namespace Eigen::internal

namespace touchstone::reference {
namespace {

struct Solution {
  Eigen::VectorXd x;
  int iterations = 0;
  double residual_rel = 1.0;
};

/// @param right, tolerance_rel  of the preconditioned system
template <class Solver>
Solution solve_with(Solver& solver, const Tangent& tangent, const Eigen::VectorXd& right, double tolerance_rel,
                    int most_iterations) {
  solver.setTolerance(tolerance_rel);
  solver.setMaxIterations(most_iterations);
  solver.compute(tangent);
  Solution result{solver.solve(right)};
  result.iterations = static_cast<int>(solver.iterations()) + 1;
  result.residual_rel = solver.error();
  return result;
}

}  // namespace

void TangentSolver::analyse(const SymmetricMatrix& pattern) {
  forget();
  const Stopwatch watch(work_.analysis_s);
  direct_.analyse(pattern);
}

void TangentSolver::forget() noexcept { has_factor_ = factor_is_current_ = false; }

bool TangentSolver::factorise(const SymmetricMatrix& K) {
  const Stopwatch watch(work_.factorisation_s);
  ++work_.factorisations;
  has_factor_ = factor_is_current_ = direct_.factorise(K);
  solves_ = 1;
  iterations_ = 0;
  decades_per_iteration_ = 1.0;
  return has_factor_;
}

bool TangentSolver::worth_keeping(double tolerance_rel) const {
  // The mean cost of a solve falls as long as one costs less than the mean so far.
  const double cost = direct_.factor_cost_in_solves();
  const double expected = -std::log10(tolerance_rel) / decades_per_iteration_;
  return has_factor_ && cost > cheap_factor && expected < (cost + iterations_) / solves_;
}

bool TangentSolver::solve(const SymmetricMatrix& K, const Eigen::SparseMatrix<double>* C, double tolerance_rel,
                          Eigen::VectorXd& x) {
  factor_is_current_ = false;
  if (worth_keeping(tolerance_rel) && iterate(K, C, tolerance_rel, most_iterations_worth(), x)) return true;
  if (!factorise(K)) return false;
  if (C) return iterate(K, C, tolerance_rel, most_iterations, x);
  const Stopwatch watch(work_.iteration_s);
  direct_.solve(x);
  return true;
}

bool TangentSolver::iterate(const SymmetricMatrix& K, const Eigen::SparseMatrix<double>* C, double tolerance_rel,
                            int most, Eigen::VectorXd& x) {
  const Stopwatch watch(work_.iteration_s);
  const Tangent tangent(K, C, direct_);
  Eigen::VectorXd right = x;
  direct_.solve_lower(right);
  try {
    Solution found;
    if (C) {
      Eigen::GMRES<Tangent, Eigen::IdentityPreconditioner> solver;
      solver.set_restart(std::min(most, between_restarts));
      found = solve_with(solver, tangent, right, tolerance_rel, most);
    } else {
      Eigen::ConjugateGradient<Tangent, Eigen::Lower | Eigen::Upper, Eigen::IdentityPreconditioner> solver;
      found = solve_with(solver, tangent, right, tolerance_rel, most);
    }
    work_.iterations += found.iterations;
    ++solves_;
    iterations_ += found.iterations;
    decades_per_iteration_ = -std::log10(std::clamp(found.residual_rel, 1e-16, 0.9)) / std::max(1, found.iterations);
    if (!(found.residual_rel <= tolerance_rel) || !found.x.allFinite()) return false;
    direct_.solve_upper(found.x);
    x = std::move(found.x);
    return true;
  } catch (const NegativeCurvature&) {
    return false;
  }
}

int TangentSolver::most_iterations_worth() const {
  return std::min(most_iterations, static_cast<int>(0.7 * direct_.factor_cost_in_solves()));
}

bool TangentSolver::positive_definite(const SymmetricMatrix& K) {
  if (factor_is_current_) return true;
  if (has_factor_) {
    // Signs from the bits of a generator that is the same everywhere.
    std::mt19937 bits(1);
    Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(K.size(), [&] { return bits() & 1U ? 1.0 : -1.0; });
    if (iterate(K, nullptr, probe_tolerance_rel, most_iterations_worth(), x)) return true;
  }
  return factorise(K);
}

}  // namespace touchstone::reference
