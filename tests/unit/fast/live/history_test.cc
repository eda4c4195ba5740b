// The history of a run.
#include "fast/live/history.h"

#include <gtest/gtest.h>

namespace touchstone::live {
namespace {

TickRecord record(std::int64_t index, std::int64_t sequence, double sent_n, double model_n) {
  TickRecord out;
  out.tick.index = index;
  out.sequence = sequence;
  out.published.force_n = scene::Vec3(0.0, 0.0, sent_n);
  out.model.force_n = scene::Vec3(0.0, model_n, 0.0);
  return out;
}

TEST(RunHistory, AShortRunKeepsEveryTick) {
  RunHistory history;
  for (int i = 0; i < 100; ++i) history.add(record(i, i, 0.1 * i, 0.2 * i));
  EXPECT_EQ(history.length(), 1);
  ASSERT_EQ(history.intervals().size(), 100u);
  EXPECT_DOUBLE_EQ(history.intervals()[30].force_max_n, 3.0);
  EXPECT_DOUBLE_EQ(history.intervals()[30].model_force_max_n, 6.0);
}

TEST(RunHistory, ALongRunStaysSmallAndLosesNeitherTicksNorPeaks) {
  RunHistory history;
  constexpr std::int64_t ticks = 100'003;
  for (std::int64_t i = 0; i < ticks; ++i) history.add(record(i, i, i == 77'777 ? 5.0 : 1.0, 1.0));
  EXPECT_LE(history.intervals().size(), RunHistory::most_intervals);
  EXPECT_GT(history.intervals().size(), RunHistory::most_intervals / 4);
  std::int64_t counted = 0;
  for (const Interval& one : history.intervals()) {
    counted += one.ticks;
    EXPECT_EQ(one.missed, 0);
  }
  EXPECT_EQ(counted, ticks);
  for (std::size_t i = 0; i < history.intervals().size(); ++i) {
    const bool peak = static_cast<std::int64_t>(i) == 77'777 / history.length();
    EXPECT_DOUBLE_EQ(history.intervals()[i].force_max_n, peak ? 5.0 : 1.0) << i;
  }
}

TEST(RunHistory, TellsMissedTicksFromDroppedRecords) {
  RunHistory history;
  history.add(record(2, 0, 1.0, 1.0));  // two missed at the start
  history.add(record(3, 1, 1.0, 1.0));
  history.add(record(10, 5, 1.0, 1.0));  // six grid points, of which three ticks were done and their records dropped
  EXPECT_EQ(history.intervals()[2].missed, 2);
  EXPECT_EQ(history.intervals()[3].missed, 0);
  EXPECT_EQ(history.intervals()[10].missed, 3);
  EXPECT_EQ(history.intervals()[5].ticks, 0);
}

}  // namespace
}  // namespace touchstone::live
