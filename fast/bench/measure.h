// Measuring one case: step and floor in alternating blocks, so that clock drift affects both.
#pragma once

#include "fast/bench/counters.h"
#include "fast/bench/workload.h"
#include "fast/realtime/stage_clock.h"
#include "fast/run/percentiles.h"

#include <array>
#include <cstdint>
#include <limits>
#include <string>

namespace touchstone::bench {

/// NaN: not measured.
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// How long to measure.
struct Effort {
  double seconds_per_case = 1.5;
  int ticks_min = 1024;   ///< also where that takes longer
  int ticks_max = 20000;  ///< no more where a tick is short
  int ticks = 0;          ///< this many in every case; 0: by the time
  int block_ticks = 32;   ///< of the step, then of the floor, then of the step with its stage clock
};
[[nodiscard]] Effort effort_of(bool quick, int ticks);

/// Durations of one kind of work: percentiles by the wall clock, and the thread's own time, which leaves out what other
/// processes took: the median over the blocks of a block's mean.
struct Durations {
  fast::Percentiles wall;
  double cpu_us = not_measured;
};

struct CaseResult {
  Case which;
  bool available = true;  ///< else this build cannot run the case, and `why` gives the reason
  std::string why;
  int triangles = 0, vertices = 0, ticks = 0;
  int regions_least = 0, regions_most = 0;  ///< contact regions that pressed, over the measured ticks
  int points = 0;                           ///< contact points of all regions together, at the end
  std::uint32_t status = 0;                 ///< OR of the fast::StepStatus bits of the measured ticks
  double setup_s = 0.0;                     ///< building the model
  std::size_t memory_bytes = 0;             ///< of the model and its state
  Durations floor, step;
  fast::Percentiles force;                                  ///< of step(), pose to force
  std::array<fast::Percentiles, fast::stage_count> stages;  ///< from ticks of their own, since reading the clock costs
  double instructions = not_measured, cycles = not_measured;  ///< per step, where they can be counted

  /// Medians by the wall clock; NaN where the case did not run.
  [[nodiscard]] double step_over_floor() const noexcept;
  [[nodiscard]] double force_us_per_region() const noexcept;
  /// Every measured tick had the regions it should, and nothing went other than planned.
  [[nodiscard]] bool as_planned() const noexcept;
};

/// @param counters those of this thread
[[nodiscard]] CaseResult measure(const Case& which, const Effort& effort, HardwareCounters& counters);

/// CPU time of this thread [us].
[[nodiscard]] double thread_cpu_us() noexcept;

}  // namespace touchstone::bench
