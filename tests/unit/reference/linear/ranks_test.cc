// Run by mpirun: the first rank runs the tests, the others follow.
#include "reference/linear/ranks.h"

#include "reference/linear/distributed_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

namespace touchstone::reference {
namespace {

constexpr int side = 20, unknowns = side * side;

/// The five-point Laplacian on a square, shifted by a multiple of the identity.
struct Laplacian {
  double shift = 0.0;
  bool first_is_free = false;  // coupled to nothing and without a diagonal: exactly singular

  [[nodiscard]] double diagonal(int j) const { return first_is_free && j == 0 ? 0.0 : 4.0 - shift; }
  [[nodiscard]] double coupling(int j) const { return first_is_free && j == 0 ? 0.0 : -1.0; }
  [[nodiscard]] static std::vector<int> neighbours_after(int j) {
    std::vector<int> after;
    if (j % side + 1 < side) after.push_back(j + 1);
    if (j + side < unknowns) after.push_back(j + side);
    return after;
  }

  [[nodiscard]] Eigen::VectorXd times(const Eigen::VectorXd& x) const {
    Eigen::VectorXd product = Eigen::VectorXd::Zero(unknowns);
    for (int j = 0; j < unknowns; ++j) {
      product[j] += diagonal(j) * x[j];
      for (const int i : neighbours_after(j)) {
        product[i] += coupling(j) * x[j];
        product[j] += coupling(j) * x[i];
      }
    }
    return product;
  }

  /// Unequal parts of every diagonal entry, and every count-th entry below it.
  [[nodiscard]] SymmetricMatrix part_of_this_rank() const {
    const double share = (ranks::own() + 1.0) / (0.5 * ranks::count() * (ranks::count() + 1));
    SymmetricMatrix part;
    part.column_begin.push_back(0);
    int number = 0;
    for (int j = 0; j < unknowns; ++j) {
      part.row.push_back(j);
      part.value.push_back(share * diagonal(j));
      for (const int i : neighbours_after(j)) {
        if (number++ % ranks::count() != ranks::own()) continue;
        part.row.push_back(i);
        part.value.push_back(coupling(j));
      }
      part.column_begin.push_back(static_cast<std::int64_t>(part.row.size()));
    }
    return part;
  }

  /// The k-th eigenvalue, counted from the smallest.
  [[nodiscard]] static double eigenvalue(int k) {
    const auto one = [](int m) { return 2.0 - 2.0 * std::cos(m * std::numbers::pi / (side + 1)); };
    return k == 0 ? 2.0 * one(1) : one(1) + one(2);
  }
};

/// A Laplacian distributed over all ranks, and its solver.
class SpreadLaplacian : public ranks::Part {
 public:
  static constexpr int kind = 1;
  SpreadLaplacian() : lead_(ranks::first() ? std::make_unique<ranks::Lead>(kind) : nullptr), solver_(lead_.get(), 1) {}
  ~SpreadLaplacian() override { lead_.reset(); }

  void set(const Laplacian& laplacian) {
    const double shift = laplacian.shift, free = laplacian.first_is_free;
    lead_->jointly(Order::assemble, [&] {
      for (const double& number : {shift, free}) ranks::send(&number, sizeof number);
      part_ = laplacian.part_of_this_rank();
    });
  }
  void follow(Order order) override {
    if (order != Order::assemble) return solver_.follow(order, part_);
    double shift, free;
    for (double* number : {&shift, &free}) ranks::receive(number, sizeof *number);
    part_ = Laplacian{shift, free != 0.0}.part_of_this_rank();
  }
  void analyse() { solver_.analyse(part_); }
  [[nodiscard]] bool factorise() { return solver_.factorise(part_); }
  [[nodiscard]] const SymmetricMatrix& part() const { return part_; }
  [[nodiscard]] DistributedSolver& solver() { return solver_; }

 private:
  std::unique_ptr<ranks::Lead> lead_;
  DistributedSolver solver_;
  SymmetricMatrix part_;
};

/// Answers every order with its rank's number.
class Counter : public ranks::Part {
 public:
  static constexpr int kind = 2;
  static std::array<double, 2> numbers() { return {ranks::own() + 1.0, 1e-9}; }
  void follow(Order) override {
    auto own = numbers();
    ranks::sum_on_first(own.data(), own.size());
    (void)ranks::largest_on_first(own[0]);
  }
};

Eigen::VectorXd wave() {
  Eigen::VectorXd x(unknowns);
  for (int j = 0; j < unknowns; ++j) x[j] = std::sin(0.1 * j * j);
  return x;
}

TEST(Ranks, AddUpAndFindTheLargest) {
  ASSERT_GT(ranks::count(), 1);
  const ranks::Lead lead(Counter::kind);
  auto sum = Counter::numbers();
  double largest = 0.0;
  lead.jointly(Order::forces, [&] {
    ranks::sum_on_first(sum.data(), sum.size());
    largest = ranks::largest_on_first(1.0);
  });
  EXPECT_EQ(sum[0], 0.5 * ranks::count() * (ranks::count() + 1));
  EXPECT_DOUBLE_EQ(sum[1], 1e-9 * ranks::count());
  EXPECT_EQ(largest, ranks::count());
  EXPECT_EQ(ranks::on_this_machine(), ranks::count());
  EXPECT_GE(ranks::threads(), 1);
}

TEST(DistributedSolver, SolvesTheSumOfAllParts) {
  SpreadLaplacian spread;
  spread.set({});
  spread.analyse();
  for (const double shift : {0.0, -3.0}) {
    spread.set({shift});
    ASSERT_TRUE(spread.factorise());
    const Eigen::VectorXd expected = wave();
    Eigen::VectorXd x = Laplacian{shift}.times(expected);
    spread.solver().solve(x);
    EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm());
  }
  EXPECT_THAT(spread.solver().description(),
              testing::HasSubstr(" on " + std::to_string(ranks::count()) + " processes"));
}

TEST(DistributedSolver, CallsAMatrixDefiniteExactlyWhenItIs) {
  SpreadLaplacian spread;
  spread.set({});
  spread.analyse();
  // Just below and just above the smallest eigenvalue, and between the next ones.
  const double lowest = Laplacian::eigenvalue(0), next = Laplacian::eigenvalue(1);
  for (const auto& [shift, definite] : {std::pair{lowest * (1.0 - 1e-6), true},
                                        {lowest * (1.0 + 1e-6), false},
                                        {0.5 * (lowest + next), false},
                                        {next * 1.001, false}}) {
    spread.set({shift});
    EXPECT_EQ(spread.factorise(), definite) << shift;
  }
}

TEST(DistributedSolver, RefusesASingularMatrix) {
  SpreadLaplacian spread;
  spread.set({0.0, true});
  spread.analyse();
  EXPECT_FALSE(spread.factorise());
  // The next factorisation works.
  spread.set({});
  EXPECT_TRUE(spread.factorise());
}

TEST(DistributedSolver, SeveralLiveSideBySide) {
  SpreadLaplacian one;
  one.set({});
  one.analyse();
  ASSERT_TRUE(one.factorise());
  {
    SpreadLaplacian other;
    other.set({-1.0});
    other.analyse();
    ASSERT_TRUE(other.factorise());
  }
  const Eigen::VectorXd expected = wave();
  Eigen::VectorXd x = Laplacian{}.times(expected);
  one.solver().solve(x);
  EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm());
}

}  // namespace
}  // namespace touchstone::reference

int main(int argc, char** argv) {
  using namespace touchstone::reference;
  const ranks::Session session;
  if (!ranks::first()) {
    ranks::follow_orders({{SpreadLaplacian::kind, [] { return std::make_unique<SpreadLaplacian>(); }},
                          {Counter::kind, [] { return std::make_unique<Counter>(); }}});
    return 0;
  }
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
