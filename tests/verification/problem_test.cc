// When a problem passes or misses. The problems themselves are run by `touchstone verify --quick`.
#include "reference/verification/problem.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace touchstone::verification {
namespace {

TEST(Check, ErrorIsRelativeToTheTargetOrItsScale) {
  const Check force{"force", "N", -2.0, -2.1, 0.06, 0.0, {}, {}}, off{"off", "", 0.0, 1e-3, 1e-2, 1.0, {}, {}};
  EXPECT_NEAR(force.error(), -0.05, 1e-15);
  EXPECT_TRUE(force.passes());
  EXPECT_DOUBLE_EQ(off.error(), 1e-3);
  EXPECT_TRUE(off.passes());
  EXPECT_FALSE((Check{"force", "N", -2.0, -2.1, 0.04, 0.0, {}, {}}).passes());
}

TEST(Check, NothingButANumberPasses) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE((Check{"force", "N", 1.0, bad, 1e9, 0.0, {}, {}}).passes());
  }
  EXPECT_FALSE((Check{"nothing to compare with", "", 0.0, 0.0, 0.1, 0.0, {}, {}}).passes());
}

TEST(Levels, OrderIsThatOfAPowerSeries) {
  for (const double order : {1.0, 2.0, 3.0}) {
    std::vector<double> values;
    for (const double h : {1.0, 0.5, 0.25, 0.125}) values.push_back(7.0 + 0.3 * std::pow(h, order));
    const Check check = from_levels("value", "", 7.0, 1.0, values);
    EXPECT_NEAR(check.order.value(), order, 1e-9);
    EXPECT_DOUBLE_EQ(check.value, values.back());
    // The uncertainty covers the true error.
    EXPECT_GE(check.mesh_band.value(), std::abs(check.error()));
  }
}

TEST(Levels, NoOrderWhereTheDifferencesTurn) {
  EXPECT_FALSE(from_levels("value", "", 1.0, 1.0, {1.1, 0.95, 1.02}).order);
  EXPECT_FALSE(from_levels("value", "", 1.0, 1.0, {1.0, 1.01, 1.05}).order);
  const Check two = from_levels("value", "", 1.0, 1.0, {1.1, 1.05});
  EXPECT_FALSE(two.order);
  EXPECT_FALSE(two.mesh_band);
}

TEST(Problems, HaveNamesOfTheirOwnAndSources) {
  std::set<std::string> names;
  for (const Problem& problem : problems()) {
    EXPECT_TRUE(names.insert(problem.name).second) << problem.name;
    EXPECT_FALSE(problem.title.empty());
    EXPECT_FALSE(problem.source.empty());
  }
  EXPECT_GE(names.size(), 15u);
}

}  // namespace
}  // namespace touchstone::verification
