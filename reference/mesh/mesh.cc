#include "reference/mesh/mesh.h"

#include "reference/mesh/mesh_limit.h"

#include <deal.II/base/geometry_info.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <string>

namespace touchstone::reference {
namespace {

constexpr dealii::types::boundary_id id_of(Boundary boundary) {
  return static_cast<dealii::types::boundary_id>(boundary);
}

template <int dim>
Eigen::Matrix<double, dim, 1> to_eigen(const dealii::Point<dim>& p) {
  Eigen::Matrix<double, dim, 1> x;
  for (int d = 0; d < dim; ++d) x[d] = p[d];
  return x;
}

template <int dim>
double distance_to(const FineDisc<dim>& disc, const Eigen::Matrix<double, dim, 1>& x) {
  const Eigen::Matrix<double, dim, 1> from = x - disc.center_m;
  const double above = from.dot(disc.normal);
  const double beyond = std::max(0.0, (from - above * disc.normal).norm() - disc.radius_m);
  return std::hypot(above, beyond);
}

template <int dim>
using Corners = Eigen::Matrix<double, dim, 1 << dim>;

/// Distance from a cell to a disc: from the nearest point of the cell's bounding box.
template <int dim>
double distance_to(const FineDisc<dim>& disc, const Corners<dim>& corners_m) {
  const Eigen::Matrix<double, dim, 1> low = corners_m.rowwise().minCoeff(), high = corners_m.rowwise().maxCoeff();
  // The box point nearest to the disc's centre is not nearest to the disc, but one projection towards it is.
  Eigen::Matrix<double, dim, 1> near = disc.center_m.cwiseMax(low).cwiseMin(high);
  const Eigen::Matrix<double, dim, 1> from = near - disc.center_m;
  const Eigen::Matrix<double, dim, 1> flat = from - from.dot(disc.normal) * disc.normal;
  const double length = flat.norm();
  if (length > disc.radius_m) {
    const Eigen::Matrix<double, dim, 1> edge = disc.center_m + flat * (disc.radius_m / length);
    near = edge.cwiseMax(low).cwiseMin(high);
  }
  return distance_to(disc, near);
}

/// Distance from a cell to a set: zero where it changes sign, else of the nearest corner. With growth < 1 no set is so
/// small that it hides between the corners.
template <int dim>
double distance_to(const FineSet<dim>& set, const Corners<dim>& corners_m) {
  double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
  for (const auto& corner_m : corners_m.colwise()) {
    const double distance_m = set.distance_m(corner_m);
    low_m = std::min(low_m, distance_m);
    high_m = std::max(high_m, distance_m);
  }
  return std::max({0.0, low_m, -high_m});
}

template <int dim>
Eigen::Matrix<double, dim, 1> unmapped(const Eigen::Matrix<double, dim, 1>& x) {
  return x;
}

template <int dim>
using Map = std::function<Eigen::Matrix<double, dim, 1>(const Eigen::Matrix<double, dim, 1>&)>;

template <int dim>
void refine(dealii::Triangulation<dim>& grid, const Grading<dim>& grading, const Map<dim>& place_m = unmapped<dim>) {
  constexpr double children = 1 << dim;
  // A cell slightly above the requested size is small enough.
  constexpr double slack = 1.0 + 1e-6;
  for (bool changed = true; changed;) {
    changed = false;
    double cells = grid.n_active_cells();
    for (const auto& cell : grid.active_cell_iterators()) {
      Corners<dim> corners_m;
      for (const unsigned int v : cell->vertex_indices()) corners_m.col(v) = place_m(to_eigen<dim>(cell->vertex(v)));
      // The longest edge of each direction, on average.
      std::array<double, dim> longest{};
      for (unsigned int line = 0; line < dealii::GeometryInfo<dim>::lines_per_cell; ++line) {
        const unsigned int from = dealii::GeometryInfo<dim>::line_to_cell_vertices(line, 0);
        const unsigned int to = dealii::GeometryInfo<dim>::line_to_cell_vertices(line, 1);
        // Lexicographic corners of an edge differ in the bit of its direction.
        double& edge = longest[(to - from) / 2];
        edge = std::max(edge, (corners_m.col(to) - corners_m.col(from)).norm());
      }
      const double edge = std::accumulate(longest.begin(), longest.end(), 0.0) / dim;
      double wished = grading.largest_m;
      for (const FineDisc<dim>& disc : grading.discs) {
        wished = std::min(wished, std::max(disc.size_m, grading.growth * distance_to(disc, corners_m)));
      }
      for (const FineSet<dim>& set : grading.sets) {
        wished = std::min(wished, std::max(set.size_m, grading.growth * distance_to(set, corners_m)));
      }
      if (edge > slack * wished) {
        cell->set_refine_flag();
        changed = true;
        cells += children - 1.0;
      }
    }
    if (cells > most_cells) {
      throw MeshTooLarge("the mesh would have more than " + std::to_string(most_cells) +
                         " cells; expected larger cells by reference.element_size_m");
    }
    if (changed) grid.execute_coarsening_and_refinement();
  }
}

/// Cells along each edge of a block's coarse grid.
template <int dim>
std::vector<unsigned int> coarse_cells(const std::vector<double>& lengths, const Grading<dim>& grading) {
  std::vector<unsigned int> cells;
  if (grading.halves_the_block) {
    const double shortest = *std::min_element(lengths.begin(), lengths.end());
    for (const double length : lengths) cells.push_back(static_cast<unsigned int>(std::lround(length / shortest)));
    return cells;
  }
  double edge = grading.largest_m;
  for (const FineDisc<dim>& disc : grading.discs) edge = std::min(edge, disc.size_m);
  while (2.0 * edge <= grading.largest_m) edge *= 2.0;
  for (const double length : lengths)
    cells.push_back(std::max(1u, static_cast<unsigned int>(std::ceil(length / edge - 1e-6))));
  return cells;
}

/// @param sides  lower and upper one of each direction
template <int dim>
Discretisation<dim> rectangular_mesh(const Eigen::Matrix<double, dim, 1>& lower_m,
                                     const Eigen::Matrix<double, dim, 1>& upper_m, const Grading<dim>& grading,
                                     const std::array<Boundary, 2 * dim>& sides) {
  dealii::Point<dim> lower, upper;
  std::vector<double> lengths;
  for (int d = 0; d < dim; ++d) {
    lower[d] = lower_m[d];
    upper[d] = upper_m[d];
    lengths.push_back(upper[d] - lower[d]);
  }
  const auto grid = std::make_shared<dealii::Triangulation<dim>>();
  dealii::GridGenerator::subdivided_hyper_rectangle(*grid, coarse_cells(lengths, grading), lower, upper, true);
  for (const auto& cell : grid->active_cell_iterators()) {
    for (const unsigned int f : cell->face_indices()) {
      if (cell->face(f)->at_boundary()) cell->face(f)->set_all_boundary_ids(id_of(sides[f]));
    }
  }
  refine(*grid, grading);
  return Discretisation<dim>(grid);
}

}  // namespace

Discretisation<3> block_mesh(const BlockSpec& spec) {
  using enum Boundary;
  return rectangular_mesh<3>(
      spec.lower_m, spec.upper_m, spec.grading,
      {spec.symmetric_x ? plane_x : free, free, spec.symmetric_y ? plane_y : free, free, held, free});
}

Discretisation<2> cylinder_mesh(const CylinderSpec& spec) {
  using enum Boundary;
  return rectangular_mesh<2>({0.0, 0.0}, {spec.radius_m, spec.height_m}, spec.grading, {plane_x, free, held, free});
}

template <int dim>
Discretisation<dim> mapped_mesh(const MappedSpec<dim>& spec) {
  std::vector<dealii::Point<dim>> vertices(spec.vertices.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    for (int d = 0; d < dim; ++d) vertices[v][d] = spec.vertices[v][d];
  }
  std::vector<dealii::CellData<dim>> cells(spec.cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c].vertices.assign(spec.cells[c].begin(), spec.cells[c].end());
  // Refinement in the plane relies on both cells at an edge running it the same way.
  if constexpr (dim == 2) dealii::GridTools::consistently_order_cells(cells);
  const auto grid = std::make_shared<dealii::Triangulation<dim>>();
  grid->create_triangulation(vertices, cells, dealii::SubCellData());
  for (const auto& cell : grid->active_cell_iterators()) {
    for (const unsigned int f : cell->face_indices()) {
      const auto face = cell->face(f);
      if (face->at_boundary()) face->set_all_boundary_ids(id_of(spec.boundary(to_eigen<dim>(face->center()))));
    }
  }
  refine(*grid, spec.grading, spec.place_m);
  return Discretisation<dim>(grid, spec.place_m);
}

template Discretisation<2> mapped_mesh(const MappedSpec<2>&);
template Discretisation<3> mapped_mesh(const MappedSpec<3>&);

}  // namespace touchstone::reference
