// Graded grids of quadrilaterals and hexahedra with hanging nodes, made by deal.II.
#pragma once

#include "reference/discretisation/discretisation.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

namespace touchstone::reference {

/// Where small cells are wanted: everything within a flat disc of this size, growing with the distance from it.
template <int dim>
struct FineDisc {
  Eigen::Matrix<double, dim, 1> center_m;
  Eigen::Matrix<double, dim, 1> normal;  ///< unit length; in two dimensions the disc is a segment
  double radius_m = 0.0;
  double size_m = 0.0;  ///< largest cell edge inside
};

/// The same about a surface or a line given by its distance, of either sign.
template <int dim>
struct FineSet {
  std::function<double(const Eigen::Matrix<double, dim, 1>&)> distance_m;
  double size_m = 0.0;
  /// Cells with a side between vertices on it are coarse ones divided at least so many times.
  int divisions = 0;
};

/// Cell size as a function of place: cell edge <= max(size_m, growth * distance) for every disc and set, and
/// <= largest_m. The edge of a cell is the longest in each direction, on average over the directions.
template <int dim>
struct Grading {
  std::vector<FineDisc<dim>> discs;
  double growth = 0.5;
  double largest_m = 0.0;
  std::vector<FineSet<dim>> sets = {};
  /// A block's cells are its shortest edge halved a number of times, so that meshes of one family have cells of exactly
  /// 1, 1/2, 1/4, ... of a common size. Otherwise they are the largest that the sizes above allow.
  bool halves_the_block = false;
};

/// Box [lower, upper]; its z = lower face is held. With symmetric_x the box is the half x >= 0 of the body and
/// the face x = lower.x is a symmetry plane; the same for y.
struct BlockSpec {
  Eigen::Vector3d lower_m, upper_m;
  bool symmetric_x = false, symmetric_y = false;
  Grading<3> grading;
};
[[nodiscard]] Discretisation<3> block_mesh(const BlockSpec& spec);

/// Cylinder 0 <= r <= radius, 0 <= z <= height; z = 0 is held, r = 0 is the axis.
struct CylinderSpec {
  double radius_m = 0.0, height_m = 0.0;
  Grading<2> grading;
};
[[nodiscard]] Discretisation<2> cylinder_mesh(const CylinderSpec& spec);

/// A coarse grid in coordinates of its own, its cells between flat sides, and the map that makes the body of it. The
/// map is continuous, and smooth in each coarse cell. Nodes are mapped one by one: those of the boundary lie on the
/// body's surface to round-off, except for hanging ones.
template <int dim>
struct MappedSpec {
  using Point = Eigen::Matrix<double, dim, 1>;
  std::vector<Point> vertices;
  std::vector<std::array<int, 1 << dim>> cells;  ///< vertices in lexicographic order, right-handed
  std::function<Point(const Point&)> place_m;
  std::function<Boundary(const Point&)> boundary;  ///< of the coarse face with this middle, in the grid's coordinates
  Grading<dim> grading;
};
template <int dim>
[[nodiscard]] Discretisation<dim> mapped_mesh(const MappedSpec<dim>& spec);

/// The same block's coarse cells where they halve it; none where they are too many.
[[nodiscard]] MappedSpec<3> block_cells(const BlockSpec& spec);

/// The same with a map of each coarse cell and cells of several materials.
template <int dim>
struct CellMappedSpec {
  using Point = Eigen::Matrix<double, dim, 1>;
  std::vector<Point> vertices_m;
  std::vector<std::array<int, 1 << dim>> cells;
  std::vector<int> materials;  ///< of the cells: numbers as in Discretisation::materials
  typename Discretisation<dim>::CellMap place_m;
  std::function<Boundary(const std::array<int, 1 << (dim - 1)>&)> boundary;  ///< of the coarse face with these vertices
  Grading<dim> grading;
};
template <int dim>
[[nodiscard]] Discretisation<dim> mapped_mesh(const CellMappedSpec<dim>& spec);

}  // namespace touchstone::reference
