#include "reference/linear/cholmod_solver.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <new>

namespace touchstone::reference {
namespace {

/// Lower triangle of [4 1 0; 1 d 2; 0 2 5].
SymmetricMatrix three_by_three(double d) { return {{0, 2, 4, 5}, {0, 1, 1, 2, 2}, {4.0, 1.0, d, 2.0, 5.0}}; }

void expect_solves(double d, const Eigen::VectorXd& x) {
  EXPECT_NEAR(4.0 * x[0] + x[1], 1.0, 1e-14);
  EXPECT_NEAR(x[0] + d * x[1] + 2.0 * x[2], 2.0, 1e-14);
  EXPECT_NEAR(2.0 * x[1] + 5.0 * x[2], 3.0, 1e-14);
}

TEST(CholmodSolver, SolvesSeveralMatricesOnOnePattern) {
  CholmodSolver solver(2);
  solver.analyse(three_by_three(6.0));
  for (const double d : {6.0, 3.0}) {
    ASSERT_TRUE(solver.factorise(three_by_three(d)));
    Eigen::VectorXd x = Eigen::Vector3d(1.0, 2.0, 3.0);
    solver.solve(x);
    expect_solves(d, x);
  }
  EXPECT_NE(solver.description().find("CHOLMOD"), std::string::npos);
}

TEST(CholmodSolver, RefusesAnIndefiniteMatrix) {
  CholmodSolver solver(1);
  solver.analyse(three_by_three(-1.0));
  EXPECT_FALSE(solver.factorise(three_by_three(-1.0)));
}

TEST(Blas, SaysThatItLacksMemoryAndDoesNotTryWithoutEnd) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::alarm(20);
    const rlimit small{std::size_t{2} << 30, RLIM_INFINITY};
    ::setrlimit(RLIMIT_AS, &small);
    bool said = false;
    try {
      CholmodSolver solver(64);
    } catch (const std::bad_alloc&) {
      said = true;
    }
    ::_exit(said ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace touchstone::reference
