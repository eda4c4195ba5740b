#include "reference/linear/cholmod_solver.h"

#include "reference/linear/blas.h"

#include <cholmod.h>

#include <stdexcept>

namespace touchstone::reference {
namespace {

/// A factorisation multiplies blocks in the cache; a solve streams the factor from memory. Ratio of their operations
/// per second, measured on factors of 0.1 to 0.3 GB with one thread: 4 to 6.
constexpr double factor_speed_over_solve_speed = 5.0;

}  // namespace

struct CholmodSolver::State {
  cholmod_common common;
  cholmod_factor* factor = nullptr;
  // Kept between solves.
  cholmod_dense *solution = nullptr, *permuted = nullptr, *supernode = nullptr;
  int threads = 1;

  /// A view of our arrays; CHOLMOD does not write to them.
  static cholmod_sparse view(const SymmetricMatrix& matrix) {
    cholmod_sparse sparse{};
    sparse.nrow = sparse.ncol = static_cast<std::size_t>(matrix.size());
    sparse.nzmax = matrix.row.size();
    sparse.p = const_cast<std::int64_t*>(matrix.column_begin.data());
    sparse.i = const_cast<std::int64_t*>(matrix.row.data());
    sparse.x = const_cast<double*>(matrix.value.data());
    sparse.stype = -1;
    sparse.itype = CHOLMOD_LONG;
    sparse.xtype = CHOLMOD_REAL;
    sparse.dtype = CHOLMOD_DOUBLE;
    sparse.sorted = sparse.packed = 1;
    return sparse;
  }

  /// @param system CHOLMOD's name of the matrix to solve with
  template <class Matrix>
  void solve(int system, Matrix& x) {
    cholmod_dense right{};
    right.nrow = right.d = static_cast<std::size_t>(x.rows());
    right.ncol = static_cast<std::size_t>(x.cols());
    right.nzmax = static_cast<std::size_t>(x.size());
    right.x = x.data();
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    if (!cholmod_l_solve2(system, factor, &right, nullptr, &solution, nullptr, &permuted, &supernode, &common)) {
      throw std::bad_alloc();
    }
    x = Eigen::Map<const Matrix>(static_cast<const double*>(solution->x), x.rows(), x.cols());
  }
};
static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));

CholmodSolver::CholmodSolver(int threads) : state_(std::make_unique<State>()) {
  cholmod_l_start(&state_->common);
  state_->common.supernodal = CHOLMOD_SUPERNODAL;
  state_->common.print = 0;
  // Two orderings are tried; the one with the sparser factor is used.
  state_->common.nmethods = 2;
  state_->common.method[0].ordering = CHOLMOD_METIS;
  state_->common.method[1].ordering = CHOLMOD_AMD;
  state_->threads = threads;
  set_blas_threads(threads);
}

CholmodSolver::~CholmodSolver() {
  for (cholmod_dense** dense : {&state_->solution, &state_->permuted, &state_->supernode}) {
    cholmod_l_free_dense(dense, &state_->common);
  }
  cholmod_l_free_factor(&state_->factor, &state_->common);
  cholmod_l_finish(&state_->common);
}

void CholmodSolver::analyse(const SymmetricMatrix& matrix) {
  cholmod_l_free_factor(&state_->factor, &state_->common);
  cholmod_sparse sparse = State::view(matrix);
  state_->factor = cholmod_l_analyze(&sparse, &state_->common);
  if (!state_->factor) throw std::bad_alloc();
}

bool CholmodSolver::factorise(const SymmetricMatrix& matrix) {
  cholmod_sparse sparse = State::view(matrix);
  cholmod_l_factorize(&sparse, state_->factor, &state_->common);
  if (state_->common.status < CHOLMOD_OK) throw std::bad_alloc();
  return state_->common.status == CHOLMOD_OK && state_->factor->minor == state_->factor->n;
}

void CholmodSolver::solve(Eigen::VectorXd& x) { state_->solve(CHOLMOD_A, x); }

void CholmodSolver::solve_columns(Eigen::MatrixXd& x) { state_->solve(CHOLMOD_A, x); }

void CholmodSolver::solve_lower(Eigen::VectorXd& x) {
  state_->solve(CHOLMOD_P, x);
  state_->solve(CHOLMOD_L, x);
}

void CholmodSolver::solve_upper(Eigen::VectorXd& x) {
  state_->solve(CHOLMOD_Lt, x);
  state_->solve(CHOLMOD_Pt, x);
}

std::int64_t CholmodSolver::predicted_factor_bytes() const noexcept {
  if (!state_->factor) return 0;
  const cholmod_factor& factor = *state_->factor;
  return static_cast<std::int64_t>(sizeof(double) * (factor.xsize + factor.maxcsize) +
                                   sizeof(SuiteSparse_long) * (factor.ssize + 3 * factor.nsuper + 2 * factor.n));
}

double CholmodSolver::factor_cost_in_solves() const noexcept {
  if (!state_->factor) return 0.0;
  return state_->common.fl / (4.0 * static_cast<double>(state_->factor->xsize) * factor_speed_over_solve_speed);
}

std::string CholmodSolver::description() const {
  return "CHOLMOD " + std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) + "." +
         std::to_string(CHOLMOD_SUBSUB_VERSION) + " on " + blas_description(state_->threads);
}

}  // namespace touchstone::reference
