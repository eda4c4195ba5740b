#include "fast/bench/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::bench {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

double at_rank(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

}  // namespace

double percentile_us(std::vector<double> sample_us, double part) {
  std::sort(sample_us.begin(), sample_us.end());
  return at_rank(sample_us, part);
}

fast::Percentiles percentiles(std::vector<double> sample_us) {
  std::sort(sample_us.begin(), sample_us.end());
  return {at_rank(sample_us, 0.5), at_rank(sample_us, 0.99), at_rank(sample_us, 0.999), at_rank(sample_us, 1.0)};
}

double median(std::vector<double> sample) { return sample.empty() ? nothing : percentile_us(std::move(sample), 0.5); }

double ratio(double upper, double lower) noexcept {
  return std::isfinite(upper) && std::isfinite(lower) && lower > 0.0 ? upper / lower : nothing;
}

}  // namespace touchstone::bench
