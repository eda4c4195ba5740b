#include "reference/linear/distributed_solver.h"

#include "reference/linear/blas.h"

#include <dmumps_c.h>

#include <limits>
#include <stdexcept>

namespace touchstone::reference {
namespace {

constexpr int use_all_ranks = -987654;  // MUMPS' constant for MPI_COMM_WORLD; no MPI header is needed here
enum Job { initialise = -1, end = -2, analysis = 1, factorisation = 2, solution = 3 };

// INFOG(1) of a factorisation.
constexpr int singular = -10;
constexpr int too_small_workspace[] = {-8, -9, -14, -15, -17, -20};

bool workspace_was_too_small(int info) {
  for (const int code : too_small_workspace) {
    if (info == code) return true;
  }
  return false;
}

}  // namespace

struct DistributedSolver::State {
  DMUMPS_STRUC_C mumps{};
  const ranks::Lead* lead;
  int threads;
  std::vector<MUMPS_INT> row, column;  // counted from one, as in MUMPS

  // Indexed as in the manual.
  MUMPS_INT& icntl(int k) { return mumps.icntl[k - 1]; }
  [[nodiscard]] int infog(int k) const { return mumps.infog[k - 1]; }

  void call(Job job) {
    mumps.job = job;
    dmumps_c(&mumps);
  }

  template <class Share>
  void jointly(Order order, const Share& share) const {
    lead ? lead->jointly(order, share) : share();
  }

  void analyse_share(const SymmetricMatrix& part) {
    row.resize(part.row.size());
    column.resize(part.row.size());
    for (std::int64_t j = 0; j < part.size(); ++j) {
      for (std::int64_t k = part.column_begin[j]; k < part.column_begin[j + 1]; ++k) {
        row[k] = static_cast<MUMPS_INT>(part.row[k] + 1);
        column[k] = static_cast<MUMPS_INT>(j + 1);
      }
    }
    mumps.n = static_cast<MUMPS_INT>(part.size());
    mumps.nnz_loc = static_cast<MUMPS_INT8>(row.size());
    mumps.irn_loc = row.data();
    mumps.jcn_loc = column.data();
    call(analysis);
  }

  void factorise_share(const SymmetricMatrix& part) {
    mumps.a_loc = const_cast<double*>(part.value.data());  // read only
    call(factorisation);
    // Pivoting may need more memory than the analysis estimated. All ranks see the same INFOG and so decide alike.
    while (workspace_was_too_small(infog(1)) && icntl(14) < 1000) {
      icntl(14) *= 2;
      call(factorisation);
    }
  }

  void fail(const std::string& what) const {
    if (infog(1) == -13 || infog(1) == -19) throw std::bad_alloc();
    throw std::runtime_error("MUMPS could not " + what + ": it says INFOG(1) = " + std::to_string(infog(1)) +
                             ", INFOG(2) = " + std::to_string(infog(2)));
  }
};

DistributedSolver::DistributedSolver(const ranks::Lead* lead, int threads) : state_(std::make_unique<State>()) {
  state_->lead = lead;
  state_->threads = threads;
  set_blas_threads(threads);
  state_->mumps.comm_fortran = use_all_ranks;
  state_->mumps.par = 1;  // the first rank works too
  state_->mumps.sym = 2;  // symmetric indefinite
  state_->call(initialise);
  for (const int channel : {1, 2, 3, 4}) state_->icntl(channel) = 0;  // no output
  state_->icntl(18) = 3;   // every rank gives its entries; equal entries are summed
  state_->icntl(28) = 1;   // the ordering is made on the first rank,
  state_->icntl(7) = 5;    // by METIS
  state_->icntl(13) = 1;   // pivots are not counted in a last block given to ScaLAPACK
  state_->icntl(14) = 40;  // percent of workspace above the estimate
}

DistributedSolver::~DistributedSolver() { state_->call(end); }

void DistributedSolver::analyse(const SymmetricMatrix& own_part) {
  if (own_part.size() > std::numeric_limits<MUMPS_INT>::max()) state_->fail("number so many unknowns");
  state_->jointly(Order::analyse, [&] { state_->analyse_share(own_part); });
  if (state_->infog(1) < 0) state_->fail("analyse the matrix");
}

bool DistributedSolver::factorise(const SymmetricMatrix& own_part) {
  state_->jointly(Order::factorise, [&] { state_->factorise_share(own_part); });
  if (state_->infog(1) == singular) return false;
  if (state_->infog(1) < 0) state_->fail("factorise");
  return state_->infog(12) == 0;
}

void DistributedSolver::solve(Eigen::VectorXd& x) {
  state_->mumps.rhs = x.data();
  state_->mumps.nrhs = 1;
  state_->mumps.lrhs = static_cast<MUMPS_INT>(x.size());
  state_->jointly(Order::solve, [&] { state_->call(solution); });
  if (state_->infog(1) < 0) state_->fail("solve");
}

void DistributedSolver::follow(Order order, const SymmetricMatrix& own_part) {
  if (order == Order::analyse) {
    state_->analyse_share(own_part);
  } else if (order == Order::factorise) {
    state_->factorise_share(own_part);
  } else {
    state_->call(solution);
  }
}

std::string DistributedSolver::description() const {
  return "MUMPS " + std::string(state_->mumps.version_number) + " on " + std::to_string(ranks::count()) +
         (ranks::count() == 1 ? " process and " : " processes and ") + blas_description(state_->threads) + " each";
}

}  // namespace touchstone::reference
