// The figures that a table over many results shows, each with the reference's own uncertainty under it.
#pragma once

#include "scene/output/figures.h"

#include <string>

namespace touchstone::compare {

/// Head cells of the table.
[[nodiscard]] std::string headline_heads();

/// The cells of one result under them.
[[nodiscard]] std::string headline_cells(const scene::Figures& figures);

/// The findings of the table, as a paragraph below it.
[[nodiscard]] std::string headline_note();

}  // namespace touchstone::compare
