// Fields inside the body at rest as a file for ParaView, written by deal.II's DataOut.
#pragma once

#include "reference/discretisation/discretisation.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace touchstone::reference {

/// One column per cell and node, in the order of Discretisation::cells.
struct CellField {
  std::string name;        ///< with its unit
  Eigen::MatrixXd values;  ///< one row: a number; more: the components of a vector, at most as many as directions
};

/// The bytes of a VTU file. Every cell is written as 2^dim linear ones between its nodes, which no other cell shares,
/// in the order of Discretisation::cells, so that a field may jump between cells. dim = 2: r is the file's x, z its y.
template <int dim>
[[nodiscard]] std::string volume_file(const Discretisation<dim>& mesh, const std::vector<CellField>& fields);

}  // namespace touchstone::reference
