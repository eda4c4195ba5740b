#include "reference/linear/tangent_solver.h"
#include "scene/base/stopwatch.h"

#include <Eigen/IterativeLinearSolvers>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

namespace touchstone::reference {
namespace {

/// Ends conjugate gradients from within a matrix-vector product.
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

/// The preconditioned matrix L^-1 P K P' L^-T in the form that Eigen's iterative solvers need. P' L L' P is an earlier
/// K, so it is close to the identity. The square of a residual's norm is an energy, which weights stiff and soft
/// directions alike.
class Tangent : public Eigen::EigenBase<Tangent> {
 public:
  using Scalar = double;
  using RealScalar = double;
  using StorageIndex = int;
  enum { ColsAtCompileTime = Eigen::Dynamic, MaxColsAtCompileTime = Eigen::Dynamic, IsRowMajor = false };

  Tangent(const SymmetricMatrix& K, CholmodSolver& cholesky)
      : K_(K.size(), K.size(), static_cast<std::int64_t>(K.row.size()), K.column_begin.data(), K.row.data(),
           K.value.data()),
        cholesky_(cholesky) {}

  [[nodiscard]] Eigen::Index rows() const { return K_.rows(); }
  [[nodiscard]] Eigen::Index cols() const { return K_.cols(); }

  template <class Right>
  Eigen::Product<Tangent, Right, Eigen::AliasFreeProduct> operator*(const Eigen::MatrixBase<Right>& x) const {
    return {*this, x.derived()};
  }

  /// @throws NegativeCurvature where x' times(x) is not positive
  [[nodiscard]] Eigen::VectorXd times(const Eigen::VectorXd& x) const {
    Eigen::VectorXd u = x;
    cholesky_.solve_upper(u);
    Eigen::VectorXd product = K_.selfadjointView<Eigen::Lower>() * u;
    cholesky_.solve_lower(product);
    if (x.dot(product) <= 0.0 && !x.isZero(0.0)) throw NegativeCurvature();
    return product;
  }

 private:
  Eigen::Map<const Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>> K_;
  CholmodSolver& cholesky_;
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

TangentSolver::TangentSolver(int threads) : cholesky_(threads) {}

void TangentSolver::analyse(const SymmetricMatrix& pattern) {
  forget();
  const scene::CpuTimeAdder watch(work_.analysis_s);
  cholesky_.analyse(pattern);
}

void TangentSolver::forget() noexcept { has_factor_ = factor_is_current_ = false; }

bool TangentSolver::factorise(const SymmetricMatrix& K) {
  const scene::CpuTimeAdder watch(work_.factorisation_s);
  ++work_.factorisations;
  has_factor_ = factor_is_current_ = cholesky_.factorise(K);
  solves_ = 1;
  iterations_ = 0;
  decades_per_iteration_ = 1.0;
  return has_factor_;
}

void TangentSolver::solve(Eigen::VectorXd& x) {
  const scene::CpuTimeAdder watch(work_.iteration_s);
  cholesky_.solve(x);
}

bool TangentSolver::worth_keeping(double tolerance_rel) const {
  // Refactorise when a solve costs more than the mean cost so far.
  const double cost = cholesky_.factor_cost_in_solves();
  const double expected = -std::log10(tolerance_rel) / decades_per_iteration_;
  return has_factor_ && cost > cheap_factor && expected < (cost + iterations_) / solves_;
}

bool TangentSolver::solve(const SymmetricMatrix& K, double tolerance_rel, Eigen::VectorXd& x) {
  factor_is_current_ = false;
  if (worth_keeping(tolerance_rel) && iterate(K, tolerance_rel, x)) return true;
  return LinearSolver::solve(K, tolerance_rel, x);
}

bool TangentSolver::iterate(const SymmetricMatrix& K, double tolerance_rel, Eigen::VectorXd& x) {
  const scene::CpuTimeAdder watch(work_.iteration_s);
  const Tangent tangent(K, cholesky_);
  Eigen::VectorXd right = x;
  cholesky_.solve_lower(right);
  try {
    Eigen::ConjugateGradient<Tangent, Eigen::Lower | Eigen::Upper, Eigen::IdentityPreconditioner> gradients;
    gradients.setTolerance(tolerance_rel);
    gradients.setMaxIterations(std::min(most_iterations, static_cast<int>(0.7 * cholesky_.factor_cost_in_solves())));
    gradients.compute(tangent);
    Eigen::VectorXd found = gradients.solve(right);
    const int iterations = static_cast<int>(gradients.iterations()) + 1;
    work_.iterations += iterations;
    iterations_ += iterations;
    ++solves_;
    decades_per_iteration_ = -std::log10(std::clamp(gradients.error(), 1e-16, 0.9)) / iterations;
    if (!(gradients.error() <= tolerance_rel) || !found.allFinite()) return false;
    cholesky_.solve_upper(found);
    x = std::move(found);
    return true;
  } catch (const NegativeCurvature&) {
    return false;
  }
}

bool TangentSolver::positive_definite(const SymmetricMatrix& K) {
  if (factor_is_current_) return true;
  if (has_factor_) {
    // Random signs, from a generator that gives the same bits on every machine.
    std::mt19937 bits(1);
    Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(K.size(), [&] { return bits() & 1U ? 1.0 : -1.0; });
    if (iterate(K, probe_tolerance_rel, x)) return true;
  }
  return factorise(K);
}

}  // namespace touchstone::reference
