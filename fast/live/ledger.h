// Statistics of a live run: timing, and forces sent.
#pragma once

#include "fast/realtime/stage_clock.h"
#include "fast/run/duration_histogram.h"

#include <array>
#include <cstdint>

namespace touchstone::live {

/// Written by the loop's thread, read when it has ended.
struct Ledger {
  fast::DurationHistogram lateness;  ///< of every wake after its grid point, those too late for a tick with them
  fast::DurationHistogram force;     ///< read to published force
  fast::DurationHistogram shape;     ///< shape step and its publication
  fast::DurationHistogram step;      ///< the whole tick
  std::array<fast::DurationHistogram, fast::stage_count> stages;  ///< of the model, over the ticks in which they ran

  std::int64_t ticks = 0;          ///< done
  std::int64_t missed = 0;         ///< grid points without a tick
  std::int64_t bad_poses = 0;      ///< ticks without a pose, or one that was not finite
  std::int64_t limited_ticks = 0;  ///< ticks whose published wrench was not the model's
  double force_max_n = 0.0;        ///< largest published force
  double model_force_max_n = 0.0;  ///< largest force of the model
  std::uint32_t status = 0;        ///< OR of the fast::StepStatus bits
};

}  // namespace touchstone::live
