// The page of one tuning: the tuned models' errors on held-out contacts, then how they were tuned.
#pragma once

#include "compare/tune/tuning.h"
#include "scene/output/results.h"

#include <string>

namespace touchstone::compare {

/// The largest relative force errors by which the regime map sorts the instants.
inline constexpr double regime_limits[] = {0.05, 0.10, 0.20};

[[nodiscard]] std::string tuning_report_html(const Tuning& tuning, const scene::Manifest& manifest);

}  // namespace touchstone::compare
