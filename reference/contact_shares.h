// A contact problem on several ranks: who has which cells, and what goes between the first rank and the others.
#pragma once

#include "reference/mesh.h"

#include <vector>

namespace touchstone::reference {

/// Which cells depend on one of these nodes, be it through a hanging one. One per cell.
template <int dim>
[[nodiscard]] std::vector<char> cells_of_nodes(const Mesh<dim>& mesh, const std::vector<int>& nodes);

/// A rank's share of the cells, ascending. The first rank has all of `of_the_first`; the rest is shared out so that all
/// have equally many, as far as that goes, each in a box, so that shares have few nodes in common. The boxes come from
/// cutting across the longest side again and again. Source: M. J. Berger, S. H. Bokhari, IEEE Trans. Comput. C-36
/// (1987) 570-580.
template <int dim>
[[nodiscard]] std::vector<int> cells_of_rank(const Mesh<dim>& mesh, const std::vector<char>& of_the_first, int rank,
                                             int ranks);

/// The life of every rank but the first, until the first one's session ends.
void follow_first_rank();

}  // namespace touchstone::reference
