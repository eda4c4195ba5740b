// Where a point of a cell lies in the coarse cell that it was divided from. Includes deal.II.
#pragma once

#include <Eigen/Core>

#include <deal.II/base/geometry_info.h>
#include <deal.II/grid/cell_id.h>
#include <deal.II/grid/tria.h>
#include <deal.II/grid/tria_accessor.h>

#include <array>
#include <utility>

namespace touchstone::reference {

/// @param unit  in the cell's unit coordinates
/// @returns the coarse cell's vertices and the point's unit coordinates there
template <int dim>
[[nodiscard]] std::pair<std::array<int, 1 << dim>, Eigen::Matrix<double, dim, 1>> in_coarse_cell(
    const typename dealii::Triangulation<dim>::cell_iterator& cell, dealii::Point<dim> unit) {
  const dealii::CellId id = cell->id();
  const auto children = id.get_child_indices();
  typename dealii::Triangulation<dim>::cell_iterator coarse = cell;
  for (std::size_t level = children.size(); level-- > 0;) {
    unit = dealii::GeometryInfo<dim>::child_to_cell_coordinates(unit, children[level]);
    coarse = coarse->parent();
  }
  std::pair<std::array<int, 1 << dim>, Eigen::Matrix<double, dim, 1>> result;
  for (const unsigned int v : coarse->vertex_indices()) result.first[v] = static_cast<int>(coarse->vertex_index(v));
  for (int d = 0; d < dim; ++d) result.second[d] = unit[d];
  return result;
}

}  // namespace touchstone::reference
