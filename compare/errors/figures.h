// The stable keys of summary.json: what each means and how it is filled.
#pragma once

#include "compare/errors/errors.h"
#include "reference/solver.h"
#include "scene/output/figures.h"

#include <string>
#include <string_view>

namespace touchstone::compare {

/// End of the key that gives an error's uncertainty.
inline constexpr std::string_view uncertainty_suffix = "_uncertainty";

/// The errors in the order of the design, each followed by "<key>_uncertainty". An undefined figure is a text
/// that says why.
[[nodiscard]] scene::Figures error_figures(const Errors& errors);

/// Every figure of a comparison: errors, the reference's figures, and those of the model alone.
[[nodiscard]] scene::Figures make_figures(const Errors& errors, const reference::Result& result,
                                          scene::Figures of_model);

/// Which value of several contacts is the worst.
enum class Worst {
  largest,   ///< in magnitude: an error
  smallest,  ///< an agreement
  none,      ///< describes one side only
};
[[nodiscard]] Worst worst_of(std::string_view key);

/// One line on what a key means, for people; the same for a key and its uncertainty.
[[nodiscard]] std::string_view figure_meaning(std::string_view key);

/// The figure's formatted value: scaled to a suitable unit, a ratio as a percentage.
[[nodiscard]] std::string figure_text(const scene::Figure& figure);

}  // namespace touchstone::compare
