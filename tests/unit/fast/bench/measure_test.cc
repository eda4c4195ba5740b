#include "fast/bench/measure.h"

#include "fast/step/state.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace touchstone::bench {
namespace {

CaseResult measured(int regions, int ticks) {
  HardwareCounters counters;
  return measure({scene::BodyShape::box, "1k", regions}, effort_of(true, ticks), counters);
}

TEST(Measure, PressesInEveryRegionAndTimesEveryStage) {
  for (const int regions : {1, 2}) {
    const CaseResult result = measured(regions, 40);
    ASSERT_TRUE(result.available) << result.why;
    EXPECT_TRUE(result.as_planned()) << fast::status_text(result.status) << " " << result.regions_least;
    EXPECT_EQ(result.ticks, 40);
    EXPECT_EQ(result.triangles, 972);
    EXPECT_GT(result.points, 10 * regions);
    EXPECT_GT(result.floor.wall.p50_us, 0.0);
    EXPECT_GT(result.floor.cpu_us, 0.0);
    EXPECT_GT(result.step_over_floor(), 1.0) << "a step writes all that the floor copies";
    EXPECT_GT(result.force.p50_us, 0.0);
    EXPECT_LT(result.force.p50_us, result.step.wall.p50_us);
    EXPECT_DOUBLE_EQ(result.force_us_per_region(), result.force.p50_us / regions);
    for (const fast::Stage stage : {fast::Stage::detection, fast::Stage::force, fast::Stage::skeleton,
                                    fast::Stage::interpolation, fast::Stage::local_factor, fast::Stage::normals}) {
      const fast::Percentiles& p = result.stages[static_cast<std::size_t>(stage)];
      EXPECT_GT(p.p50_us, 0.0) << fast::stage_names[static_cast<std::size_t>(stage)];
      EXPECT_LE(p.p50_us, p.p99_us);
      EXPECT_LE(p.p99_us, p.max_us);
    }
    EXPECT_EQ(result.stages[static_cast<std::size_t>(fast::Stage::friction)].max_us, 0.0) << "the scene has none";
  }
}

TEST(Measure, TheResponseModelsStages) {
  HardwareCounters counters;
  const CaseResult result = measure({scene::BodyShape::box, "1k", 1, true}, effort_of(true, 40), counters);
  EXPECT_TRUE(result.as_planned()) << fast::status_text(result.status) << " " << result.regions_least;
  EXPECT_EQ(result.triangles, 972);
  EXPECT_LT(result.force.p50_us, result.step.wall.p50_us);
  EXPECT_GT(result.memory_bytes, 100000u);
  for (std::size_t s = 0; s < fast::stage_count; ++s) {
    const auto stage = static_cast<fast::Stage>(s);
    const bool has = stage == fast::Stage::detection || stage == fast::Stage::force ||
                     stage == fast::Stage::interpolation || stage == fast::Stage::local_factor ||
                     stage == fast::Stage::normals;
    EXPECT_EQ(result.stages[s].max_us > 0.0, has) << fast::stage_names[s];
  }
}

TEST(Measure, AThreadsOwnTimeDoesNotRunWhileItSleeps) {
  const double begin_us = thread_cpu_us();
  const auto wall = std::chrono::steady_clock::now() + std::chrono::milliseconds(20);
  while (std::chrono::steady_clock::now() < wall) {
    timespec nap{0, 5000000};
    nanosleep(&nap, nullptr);
  }
  EXPECT_LT(thread_cpu_us() - begin_us, 10000.0);
  const double busy_us = thread_cpu_us();
  while (thread_cpu_us() - busy_us < 1000.0) {
  }
  EXPECT_GE(thread_cpu_us() - begin_us, 1000.0);
}

TEST(Counters, CountMoreForMoreWorkOrSayWhyNot) {
  HardwareCounters counters;
  if (!counters.counting()) {
    EXPECT_TRUE(counters.state().starts_with("not ")) << counters.state();
    counters.start();
    EXPECT_EQ(counters.stop().instructions, 0.0);
    return;
  }
  const auto count = [&](int rounds) {
    counters.start();
    for (int i = 0; i < rounds; ++i) asm volatile("");
    return counters.stop().instructions;
  };
  EXPECT_GT(count(100000), 5.0 * count(10000));
}

}  // namespace
}  // namespace touchstone::bench
