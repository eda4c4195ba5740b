// The estimate of a mesh's cost: what it grows with, how a run's own pace corrects it, how it is said.
#include "reference/run/cost.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::reference {
namespace {

TEST(Cost, GrowsWithLoadStepsUnknownsAndFriction) {
  const MeshWork work{.dim = 3, .unknowns = 20e3, .load_steps = 10};
  const Cost one = expected_cost(work, 1);
  MeshWork other = work;
  other.load_steps = 20;
  EXPECT_NEAR(expected_cost(other, 1).seconds, 2.0 * one.seconds, 1e-9 * one.seconds);
  EXPECT_EQ(expected_cost(other, 1).memory_bytes, one.memory_bytes);
  other = work;
  other.unknowns *= 2.0;
  // Between assembly, which is linear, and a factorisation in space, which is at most quadratic.
  const double growth = expected_cost(other, 1).seconds / one.seconds;
  EXPECT_GT(growth, 2.0);
  EXPECT_LT(growth, 4.0);
  EXPECT_GT(expected_cost(other, 1).memory_bytes, one.memory_bytes);
  other = work;
  other.friction = true;
  EXPECT_GT(expected_cost(other, 1).newton_iterations, one.newton_iterations);
  EXPECT_GT(expected_cost(other, 1).seconds, one.seconds);
}

TEST(Cost, MoreThreadsAreFasterButNotInProportion) {
  const MeshWork work{.dim = 3, .unknowns = 20e3, .load_steps = 10};
  const double one_s = expected_cost(work, 1).seconds, two_s = expected_cost(work, 2).seconds;
  EXPECT_LT(two_s, one_s);
  EXPECT_GT(two_s, 0.5 * one_s);
}

TEST(Cost, APlaneIsCheaperThanSpace) {
  MeshWork work{.dim = 3, .unknowns = 5e3, .load_steps = 10};
  const double space_s = expected_cost(work, 1).seconds;
  work.dim = 2;
  EXPECT_LT(expected_cost(work, 1).seconds, 0.5 * space_s);
}

TEST(Cost, PaceComesFromWhatIsFinished) {
  Pace pace;
  EXPECT_EQ(pace.factor(), 1.0);
  pace.finished(2.0, 6.0);
  EXPECT_GT(pace.factor(), 1.0);
  EXPECT_LT(pace.factor(), 3.0) << "one load step is no proof";
  for (int step = 0; step < 100; ++step) pace.finished(2.0, 6.0);
  EXPECT_NEAR(pace.factor(), 3.0, 0.05);
  // A larger mesh counts for more.
  for (int step = 0; step < 10; ++step) pace.finished(200.0, 200.0);
  EXPECT_LT(pace.factor(), 1.3);
}

TEST(Cost, TimesAndMemoryAreSaidInUnitsThatFit) {
  EXPECT_EQ(duration_text(0.24), "0.2 s");
  EXPECT_EQ(duration_text(75.4), "75 s");
  EXPECT_EQ(duration_text(150.0), "2.5 min");
  EXPECT_EQ(duration_text(3000.0), "50 min");
  EXPECT_EQ(duration_text(9000.0), "2.5 h");
  EXPECT_EQ(duration_text(180000.0), "50 h");
  EXPECT_EQ(memory_text(0.4 * std::exp2(30)), "0.4 GiB");
  EXPECT_EQ(memory_text(31.0 * std::exp2(30)), "31 GiB");
  EXPECT_EQ(memory_text(1234.0 * std::exp2(30)), "1234 GiB");
}

}  // namespace
}  // namespace touchstone::reference
