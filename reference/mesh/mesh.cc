#include "reference/mesh/mesh.h"

#include "reference/discretisation/coarse_cell.h"
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

/// Whether a cell has a side between vertices on the set.
template <int dim>
bool touches(const FineSet<dim>& set, const Corners<dim>& corners_m) {
  constexpr double on_it = 1e-6;  // of the cell's size
  const double near_m = on_it * (corners_m.rowwise().maxCoeff() - corners_m.rowwise().minCoeff()).maxCoeff();
  int count = 0;
  for (const auto& corner_m : corners_m.colwise()) count += std::abs(set.distance_m(corner_m)) < near_m ? 1 : 0;
  return count >= 1 << (dim - 1);
}

/// @param place_m  of a cell's vertex in the body, from the cell and the vertex's number in it
template <int dim, class Place>
void refine(dealii::Triangulation<dim>& grid, const Grading<dim>& grading, const Place& place_m) {
  constexpr double children = 1 << dim;
  // A cell slightly above the requested size is small enough.
  constexpr double slack = 1.0 + 1e-6;
  for (bool changed = true; changed;) {
    changed = false;
    double cells = grid.n_active_cells();
    for (const auto& cell : grid.active_cell_iterators()) {
      Corners<dim> corners_m;
      for (const unsigned int v : cell->vertex_indices()) corners_m.col(v) = place_m(cell, v);
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
      const bool divided = std::all_of(grading.sets.begin(), grading.sets.end(), [&](const FineSet<dim>& set) {
        return cell->level() >= set.divisions || !touches(set, corners_m);
      });
      if (edge > slack * wished || !divided) {
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
  refine(*grid, grading, [](const auto& cell, unsigned int v) { return to_eigen<dim>(cell->vertex(v)); });
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

MappedSpec<3> block_cells(const BlockSpec& spec) {
  const Eigen::Vector3d size_m = spec.upper_m - spec.lower_m;
  const Eigen::Array3d ratio = (size_m / size_m.minCoeff()).array().round();
  if (ratio.prod() > most_cells) return {};
  const Eigen::Array3i count = ratio.cast<int>();
  MappedSpec<3> mapped;
  const auto number = [&](int i, int j, int k) { return i + (count[0] + 1) * (j + (count[1] + 1) * k); };
  for (int k = 0; k <= count[2]; ++k) {
    for (int j = 0; j <= count[1]; ++j) {
      for (int i = 0; i <= count[0]; ++i) {
        const Eigen::Array3d share = Eigen::Array3d(i, j, k) / count.cast<double>();
        mapped.vertices.push_back(spec.lower_m + (share * size_m.array()).matrix());
        if (i == count[0] || j == count[1] || k == count[2]) continue;
        auto& cell = mapped.cells.emplace_back();
        for (int v = 0; v < 8; ++v) cell[v] = number(i + v % 2, j + v / 2 % 2, k + v / 4);
      }
    }
  }
  mapped.place_m = [](const Eigen::Vector3d& x_m) { return x_m; };
  mapped.boundary = [spec, near_m = 1e-9 * size_m.maxCoeff()](const Eigen::Vector3d& middle_m) {
    const auto low = [&](int d) { return middle_m[d] < spec.lower_m[d] + near_m; };
    if (low(2)) return Boundary::held;
    if (spec.symmetric_x && low(0)) return Boundary::plane_x;
    return spec.symmetric_y && low(1) ? Boundary::plane_y : Boundary::free;
  };
  return mapped;
}

namespace {

/// @param boundary  of a coarse face
template <int dim, class BoundaryOf>
std::shared_ptr<dealii::Triangulation<dim>> coarse_grid(const std::vector<Eigen::Matrix<double, dim, 1>>& places,
                                                        std::vector<dealii::CellData<dim>> cells,
                                                        const BoundaryOf& boundary) {
  std::vector<dealii::Point<dim>> vertices(places.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    for (int d = 0; d < dim; ++d) vertices[v][d] = places[v][d];
  }
  // Refinement in the plane relies on both cells at an edge running it the same way.
  if constexpr (dim == 2) dealii::GridTools::consistently_order_cells(cells);
  const auto grid = std::make_shared<dealii::Triangulation<dim>>();
  grid->create_triangulation(vertices, cells, dealii::SubCellData());
  for (const auto& cell : grid->active_cell_iterators()) {
    for (const unsigned int f : cell->face_indices()) {
      const auto face = cell->face(f);
      if (face->at_boundary()) face->set_all_boundary_ids(id_of(boundary(face)));
    }
  }
  return grid;
}

}  // namespace

template <int dim>
Discretisation<dim> mapped_mesh(const MappedSpec<dim>& spec) {
  std::vector<dealii::CellData<dim>> cells(spec.cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) cells[c].vertices.assign(spec.cells[c].begin(), spec.cells[c].end());
  const auto grid = coarse_grid<dim>(spec.vertices, std::move(cells),
                                     [&](const auto& face) { return spec.boundary(to_eigen<dim>(face->center())); });
  refine(*grid, spec.grading,
         [&](const auto& cell, unsigned int v) { return spec.place_m(to_eigen<dim>(cell->vertex(v))); });
  return Discretisation<dim>(grid, spec.place_m);
}

template <int dim>
Discretisation<dim> mapped_mesh(const CellMappedSpec<dim>& spec) {
  std::vector<dealii::CellData<dim>> cells(spec.cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    cells[c].vertices.assign(spec.cells[c].begin(), spec.cells[c].end());
    cells[c].material_id = static_cast<dealii::types::material_id>(spec.materials[c]);
  }
  const auto grid = coarse_grid<dim>(spec.vertices_m, std::move(cells), [&](const auto& face) {
    std::array<int, 1 << (dim - 1)> side;
    for (const unsigned int v : face->vertex_indices()) side[v] = static_cast<int>(face->vertex_index(v));
    return spec.boundary(side);
  });
  refine(*grid, spec.grading, [&](const auto& cell, unsigned int v) {
    const auto [corners, xi] = in_coarse_cell<dim>(cell, dealii::GeometryInfo<dim>::unit_cell_vertex(v));
    return spec.place_m(corners, xi);
  });
  return Discretisation<dim>(grid, spec.place_m);
}

template Discretisation<2> mapped_mesh(const MappedSpec<2>&);
template Discretisation<3> mapped_mesh(const MappedSpec<3>&);
template Discretisation<2> mapped_mesh(const CellMappedSpec<2>&);
template Discretisation<3> mapped_mesh(const CellMappedSpec<3>&);

}  // namespace touchstone::reference
