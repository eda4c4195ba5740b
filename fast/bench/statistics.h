// What the benchmark makes of its samples.
#pragma once

#include <vector>

namespace touchstone::bench {

/// NaN where nothing was measured.
[[nodiscard]] double median(std::vector<double> sample);

/// NaN unless both are finite and the lower one is above zero.
[[nodiscard]] double ratio(double upper, double lower) noexcept;

}  // namespace touchstone::bench
