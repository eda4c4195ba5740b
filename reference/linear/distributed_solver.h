// Sparse direct solver for a matrix of which every rank has a part: MUMPS, whose factor is distributed over all ranks.
// Source: P. R. Amestoy, I. S. Duff, J. Koster, J.-Y. L'Excellent, SIAM J. Matrix Anal. Appl. 23 (2001) 15-41.
#pragma once

#include "reference/linear/linear_solver.h"
#include "reference/linear/ranks.h"

#include <memory>

namespace touchstone::reference {

/// L D L' with the number of negative pivots, which shows whether the matrix, the sum of all ranks' parts, is definite;
/// the same factor solves when it is not. On the first rank the methods have the other ranks' solvers follow; there
/// they are not called. Made and dropped on all ranks together.
class DistributedSolver : public LinearSolver {
 public:
  /// @param lead     on the first rank the hold on the parts of which the other solvers are members; it must outlive
  ///                 this; nullptr on the other ranks, and on the first when it is alone
  /// @param threads  of the BLAS of this rank; set for the process
  DistributedSolver(const ranks::Lead* lead, int threads);
  ~DistributedSolver() override;
  DistributedSolver(const DistributedSolver&) = delete;
  DistributedSolver& operator=(const DistributedSolver&) = delete;

  void analyse(const SymmetricMatrix& own_part) override;
  [[nodiscard]] bool factorise(const SymmetricMatrix& own_part) override;
  void solve(Eigen::VectorXd& x) override;
  [[nodiscard]] std::string description() const override;

  /// The other ranks' side of analyse, factorise and solve.
  void follow(Order order, const SymmetricMatrix& own_part);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace touchstone::reference
