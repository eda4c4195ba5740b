// What is said about a sample of durations.
#pragma once

#include "scene/output/figures.h"

#include <string>
#include <vector>

namespace touchstone::fast {

/// Percentiles of a sample of durations [us].
struct Percentiles {
  double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0, max_us = 0.0;
};

/// Nearest rank: the smallest duration that at least this part of the sample does not exceed; 0 when empty.
/// @param part in (0, 1]
[[nodiscard]] double percentile_us(std::vector<double> sample_us, double part);

[[nodiscard]] Percentiles percentiles(std::vector<double> sample_us);

/// <key>.p50, .p99, .p999 and .max.
void add_figures(const std::string& key, const Percentiles& percentiles, scene::Figures& figures);

}  // namespace touchstone::fast
