// Coarse grids whose cells follow the surfaces of balls and ellipsoids inside the body.
#pragma once

#include "reference/mesh/mesh.h"
#include "scene/model/scene.h"
#include "scene/shape/shape.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace touchstone::reference {

/// A body's coarse cells, divided until each inclusion is some of them. Those cells get a layer of new ones around them
/// on either side ("pillows": S. A. Mitchell, T. J. Tautges, Int. Meshing Roundtable (1995)), so that no cell has two
/// sides on an inclusion's surface, where they would meet at a flat angle. The vertices between the layers lie on the
/// surface; they and their neighbours have places that make the worst angles best. Every mesh of a family begins with
/// this grid.
template <int dim>
struct FollowingGrid {
  using Point = Eigen::Matrix<double, dim, 1>;
  using Corners = std::array<int, 1 << dim>;     ///< of a cell, lexicographic
  using Side = std::array<int, 1 << (dim - 1)>;  ///< corners of a cell's side

  struct Vertex {
    Point place_m;
    Point grid;          ///< in the coordinates of the body's cells; of a new one that of the vertex it comes from
    int surface = 0;     ///< k: on that of inclusions[k - 1]
    bool moved = false;  ///< not where the body's map has it
  };
  struct Cell {
    Corners corners;
    int material = 0;  ///< 0 the body's, k that of inclusions[k - 1]
  };
  std::vector<Vertex> vertices;
  std::vector<Cell> cells;
  std::vector<double>
      edge_m;  ///< per inclusion, of the largest cell at its surface: longest of each direction, on average

  /// Of a point of a coarse cell, from its unit coordinates. Sides between vertices of an inclusion's surface are on
  /// it, those between vertices that are not moved are the body's, others are blended from their edges, and so are
  /// cells.
  [[nodiscard]] Point place_m(const Corners& corners, const Point& xi) const;
  [[nodiscard]] Boundary boundary(const Side& side) const;

  MappedSpec<dim> body;
  std::vector<std::shared_ptr<const scene::Shape>> shapes;  ///< of the inclusions
  std::vector<double> radius_m;                             ///< of the largest ball about each one's middle
};

/// @param body_cells  coarse cells of the body without inclusions
/// @param why_not  in words, where there is none
/// @returns nullptr where an inclusion is no ball or ellipsoid, touches the surface, the support or another inclusion,
///   or is so small that it would take too many coarse cells
template <int dim>
[[nodiscard]] std::shared_ptr<const FollowingGrid<dim>> following_grid(const MappedSpec<dim>& body_cells,
                                                                       const scene::Body& body, std::string& why_not);

template <int dim>
[[nodiscard]] Discretisation<dim> following_mesh(const std::shared_ptr<const FollowingGrid<dim>>& coarse,
                                                 const Grading<dim>& grading);

}  // namespace touchstone::reference
