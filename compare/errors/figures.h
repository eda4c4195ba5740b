// The stable keys of summary.json: what each means and how it is filled.
#pragma once

#include "compare/errors/errors.h"
#include "fast/run/run.h"
#include "reference/solver.h"

#include <string>
#include <string_view>

namespace touchstone::compare {

/// End of the key that gives an error's uncertainty.
inline constexpr std::string_view uncertainty_suffix = "_uncertainty";

/// Every figure of a comparison in the order of the design, errors followed by "<key>_uncertainty". A figure
/// without a meaning is a text that says why.
[[nodiscard]] scene::Figures make_figures(const Errors& errors, const fast::Run& run, const reference::Result& result);

/// One line on what a key means, for people; the same for a key and its uncertainty.
[[nodiscard]] std::string_view figure_meaning(std::string_view key);

/// The figure's value as people read it: scaled to a handy unit, a ratio as a percentage.
[[nodiscard]] std::string figure_text(const scene::Figure& figure);

}  // namespace touchstone::compare
