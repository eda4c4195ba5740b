// What the benchmark says about a sample of durations.
#pragma once

#include "fast/run.h"

#include <vector>

namespace touchstone::bench {

/// Nearest rank: the smallest duration that at least this part of the sample does not exceed; 0 when empty.
/// @param part in (0, 1]
[[nodiscard]] double percentile_us(std::vector<double> sample_us, double part);

[[nodiscard]] fast::Percentiles percentiles(std::vector<double> sample_us);

/// NaN where nothing was measured.
[[nodiscard]] double median(std::vector<double> sample);

/// NaN unless both are finite and the lower one is above zero.
[[nodiscard]] double ratio(double upper, double lower) noexcept;

}  // namespace touchstone::bench
