#include "fast/bench/statistics.h"

#include "fast/run/percentiles.h"

#include <cmath>
#include <limits>

namespace touchstone::bench {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

double median(std::vector<double> sample) {
  return sample.empty() ? nothing : fast::percentile_us(std::move(sample), 0.5);
}

double ratio(double upper, double lower) noexcept {
  return std::isfinite(upper) && std::isfinite(lower) && lower > 0.0 ? upper / lower : nothing;
}

}  // namespace touchstone::bench
