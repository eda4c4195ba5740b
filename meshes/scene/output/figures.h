// Figures: what summary.json holds.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace touchstone::scene {

/// Figures by stable dotted key (design: Results), in the order they were measured.
/// Numbers and strings are kept apart only when written; `unit` is "" for a ratio or a text.
struct Figure {
  std::string key;
  double number = 0.0;
  std::string text;  ///< not empty: the figure is this text; beside a number that is NaN: why there is none
  std::string unit;
};
using Figures = std::vector<Figure>;

/// The figure of this key, or null.
[[nodiscard]] const Figure* find_figure(const Figures& figures, std::string_view key);

}  // namespace touchstone::scene
