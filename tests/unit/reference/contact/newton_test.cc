// When Newton's method stops, and how exactly it solves for a step.
#include "reference/contact/newton.h"

#include <gtest/gtest.h>

namespace touchstone::reference {
namespace {

TEST(Balance, IsReachedWhenEveryCriterionIsMet) {
  EXPECT_TRUE(Balance{}.reached());
  for (Criterion Balance::*one : {&Balance::force, &Balance::gap, &Balance::volume, &Balance::places}) {
    Balance balance;
    (balance.*one).value = 0.99 * (balance.*one).limit;
    EXPECT_TRUE(balance.reached());
    (balance.*one).value = 1.01 * (balance.*one).limit;
    EXPECT_FALSE(balance.reached());
  }
  Balance changing;
  changing.status_changes = true;
  EXPECT_FALSE(changing.reached());
}

TEST(Balance, StepsAreSolvedForNoMoreExactlyThanTheyAreWorth) {
  Balance balance;
  balance.force.value = 1e-3;
  balance.volume.value = 1e-6;
  EXPECT_DOUBLE_EQ(balance.step_tolerance_rel(), 1e-4);  // a tenth of how far away it is
  balance.force.value = 1.0;
  EXPECT_DOUBLE_EQ(balance.step_tolerance_rel(), 1e-2);  // at most
  // In the last step as exactly as the criteria need.
  balance.force.value = 5e-8;
  balance.volume.value = 1e-12;
  EXPECT_DOUBLE_EQ(balance.step_tolerance_rel(), 0.01 * 0.2);
}

}  // namespace
}  // namespace touchstone::reference
