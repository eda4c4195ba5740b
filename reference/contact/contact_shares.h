// Which rank has which cells of a mesh.
#pragma once

#include "reference/mesh/mesh.h"

#include <vector>

namespace touchstone::reference {

/// Which cells depend on one of these nodes, be it through a hanging one. One per cell.
template <int dim>
[[nodiscard]] std::vector<char> cells_of_nodes(const Mesh<dim>& mesh, const std::vector<int>& nodes);

/// Divides the cells into parts of equal number, each in a box, so that the parts have few nodes in common. The boxes
/// come from cutting across the longest side again and again. Source: M. J. Berger, S. H. Bokhari, IEEE Trans. Comput.
/// C-36 (1987) 570-580.
/// @returns the rank of every cell
template <int dim>
[[nodiscard]] std::vector<int> ranks_of_cells(const Mesh<dim>& mesh, int ranks);

}  // namespace touchstone::reference
