// Durations of any number in fixed memory.
#pragma once

#include "fast/run/percentiles.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace touchstone::fast {

/// Counts durations in bins that grow with them: exact up to 128 ns, then 64 bins per doubling, so that a percentile is
/// right to 1 %. Fixed size, no heap.
class DurationHistogram {
 public:
  /// Negative durations count as zero, those beyond 18 minutes as 18 minutes; only the maximum keeps its value.
  void add(std::int64_t duration_ns) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::int64_t max_ns() const noexcept { return max_ns_; }
  /// Nearest rank: the smallest duration that at least this part of them does not exceed; 0 when empty.
  /// @param part in (0, 1]
  [[nodiscard]] double percentile_ns(double part) const noexcept;
  [[nodiscard]] Percentiles percentiles() const noexcept;
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

}  // namespace touchstone::fast
