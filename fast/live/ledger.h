// How well the loop kept time, and what it sent.
#pragma once

#include "fast/percentiles.h"
#include "fast/stage_clock.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace touchstone::live {

/// Counts durations in bins that grow with them: exact up to 128 ns, then 64 bins per doubling, so that a percentile is
/// right to 1 %. Fixed size, no heap.
class DurationHistogram {
 public:
  /// Durations below zero count as zero, those beyond 18 minutes as that long, but for the maximum.
  void add(std::int64_t duration_ns) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::int64_t max_ns() const noexcept { return max_ns_; }
  /// Nearest rank: the smallest duration that at least this part of them does not exceed; 0 when empty.
  /// @param part in (0, 1]
  [[nodiscard]] double percentile_ns(double part) const noexcept;
  [[nodiscard]] fast::Percentiles percentiles() const noexcept;
  /// How many lie in [from_ns, to_ns), which may be infinite; right to 1 % of either end.
  [[nodiscard]] std::uint64_t count_between(double from_ns, double to_ns) const noexcept;

 private:
  static constexpr int sub_bits = 6, longest_bits = 40;
  static constexpr std::int64_t longest_ns = (std::int64_t{1} << longest_bits) - 1;
  static std::size_t bin_of(std::int64_t duration_ns) noexcept;
  static double middle_ns(std::size_t bin) noexcept;

  std::array<std::uint64_t, (longest_bits - sub_bits + 1) << sub_bits> bins_{};
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0;
};

/// Written by the loop's thread, read when it has ended.
struct Ledger {
  DurationHistogram lateness;  ///< of every wake after its grid point, those too late for a tick with them
  DurationHistogram force;     ///< read to published force
  DurationHistogram shape;     ///< shape step and its publication
  DurationHistogram step;      ///< the whole tick
  std::array<DurationHistogram, fast::stage_count> stages;  ///< of the model, over the ticks in which they ran

  std::int64_t ticks = 0;          ///< done
  std::int64_t missed = 0;         ///< grid points without a tick
  std::int64_t bad_poses = 0;      ///< ticks without a pose, or one that was not finite
  std::int64_t limited_ticks = 0;  ///< ticks whose published wrench was not the model's
  double force_max_n = 0.0;        ///< largest published force
  double model_force_max_n = 0.0;  ///< largest force of the model
  std::uint32_t status = 0;        ///< OR of the fast::StepStatus bits
};

}  // namespace touchstone::live
