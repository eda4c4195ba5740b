// A live run over time in a bounded number of intervals: enough to draw it, however long it lasted.
#pragma once

#include "fast/live/tick_record.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchstone::live {

/// The ticks of some grid points in a row.
struct Interval {
  std::int64_t ticks = 0;          ///< recorded
  std::int64_t missed = 0;         ///< grid points without a tick, just before one of these ticks
  double force_max_n = 0.0;        ///< largest published force
  double model_force_max_n = 0.0;  ///< largest force of the model
};

/// Equal intervals from the first grid point on. When there are too many, neighbours are joined and all are twice as
/// long.
class RunHistory {
 public:
  static constexpr std::size_t most_intervals = 512;

  /// Records in the order of their ticks. Those that were dropped in between are not counted as missed.
  void add(const TickRecord& record);

  [[nodiscard]] const std::vector<Interval>& intervals() const noexcept { return intervals_; }
  /// Grid points in an interval.
  [[nodiscard]] std::int64_t length() const noexcept { return length_; }

 private:
  std::vector<Interval> intervals_;
  std::int64_t length_ = 1;
  std::int64_t next_index_ = 0, next_sequence_ = 0;
};

}  // namespace touchstone::live
