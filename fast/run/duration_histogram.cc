#include "fast/run/duration_histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace touchstone::fast {

std::size_t DurationHistogram::bin_of(std::int64_t duration_ns) noexcept {
  const auto value = static_cast<std::uint64_t>(std::clamp<std::int64_t>(duration_ns, 0, longest_ns));
  const int octave = std::max(0, static_cast<int>(std::bit_width(value)) - sub_bits - 1);
  // The leading bit of value >> octave gives the octave, the bits below it the position within the octave.
  return (static_cast<std::size_t>(octave) << sub_bits) + static_cast<std::size_t>(value >> octave);
}

double DurationHistogram::middle_ns(std::size_t bin) noexcept {
  const std::size_t in_first = std::size_t{2} << sub_bits;  // bins one nanosecond wide
  if (bin < in_first) return static_cast<double>(bin);
  const std::size_t octave = (bin >> sub_bits) - 1;
  const auto begin = static_cast<double>((bin - (octave << sub_bits)) << octave);
  return begin + 0.5 * (std::ldexp(1.0, static_cast<int>(octave)) - 1.0);
}

void DurationHistogram::add(std::int64_t duration_ns) noexcept {
  ++bins_[bin_of(duration_ns)];
  ++count_;
  max_ns_ = std::max(max_ns_, duration_ns);
}

double DurationHistogram::percentile_ns(double part) const noexcept {
  if (count_ == 0) return 0.0;
  const auto rank = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::ceil(part * double(count_))));
  std::uint64_t below = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    below += bins_[bin];
    if (below >= rank) return std::min(middle_ns(bin), static_cast<double>(max_ns_));
  }
  return static_cast<double>(max_ns_);
}

std::uint64_t DurationHistogram::count_between(double from_ns, double to_ns) const noexcept {
  std::uint64_t count = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    if (middle_ns(bin) >= from_ns && middle_ns(bin) < to_ns) count += bins_[bin];
  }
  return count;
}

Percentiles DurationHistogram::percentiles() const noexcept {
  return {1e-3 * percentile_ns(0.5), 1e-3 * percentile_ns(0.99), 1e-3 * percentile_ns(0.999),
          1e-3 * static_cast<double>(max_ns_)};
}

}  // namespace touchstone::fast
