// The body at rest in deal.II's classes: its grid, the quadratic displacements on it, hanging nodes and the mapping;
// and views of their numbers for whoever needs no more. This header is free of deal.II.
#pragma once

#include "reference/discretisation/shape.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dealii {
template <int, int>
class Triangulation;
template <int, int>
class DoFHandler;
template <int, int>
class Mapping;
template <typename>
class AffineConstraints;
}  // namespace dealii

namespace touchstone::reference {

/// What a piece of the boundary is to the problem.
enum class Boundary {
  free,     ///< may touch the tool
  held,     ///< the support: no displacement
  plane_x,  ///< symmetry plane x = 0, and the axis r = 0 in two dimensions
  plane_y,  ///< symmetry plane y = 0
};

/// The body at rest, divided into cells of 9 or 27 nodes. dim = 3: world coordinates; dim = 2: the meridian plane (r,
/// z) of a body of revolution. Nodes of a cell or face are in lexicographic order, first coordinate fastest. Degree of
/// freedom `dim * node + i` of the DoFHandler is the displacement of a node in direction i; cells are in the order of
/// deal.II's active cells. Copies share deal.II's objects.
template <int dim>
class Discretisation {
 public:
  static constexpr int nodes_per_cell = Shape<dim>::size;
  static constexpr int nodes_per_face = Shape<dim - 1>::size;
  using Point = Eigen::Matrix<double, dim, 1>;
  using Nodal = Eigen::Matrix<double, dim, Eigen::Dynamic>;  ///< one column per node
  using Map = std::function<Point(const Point&)>;
  /// From a coarse cell's vertices, as the grid numbers them, and unit coordinates in it.
  using CellMap = std::function<Point(const std::array<int, 1 << dim>&, const Point&)>;

  struct Face {
    std::array<int, nodes_per_face> nodes;
    Boundary boundary;
  };

  /// Of no cells.
  Discretisation() = default;

  /// Every node is placed by a map from the grid's coordinates, but for the hanging ones: the place of a node on the
  /// middle of a coarser neighbour's side is the weighted sum of its masters', as its displacement, which keeps
  /// curved meshes conforming. Boundary ids are numbers of `Boundary`.
  explicit Discretisation(
      std::shared_ptr<dealii::Triangulation<dim, dim>> grid, const Map& place_m = [](const Point& x) { return x; });

  /// Every node is placed by its coarse cell's map, and cells have the materials of the grid.
  Discretisation(std::shared_ptr<dealii::Triangulation<dim, dim>> grid, const CellMap& place_m);

  /// Everything as bytes, for other processes on the same machine or alike, and back.
  [[nodiscard]] std::string bytes() const;
  [[nodiscard]] static Discretisation from_bytes(std::string_view bytes);

  /// The same body with these cells divided, one flag per cell, and those that would otherwise differ from a neighbour
  /// by more than one division. Without materials that the grid does not have. Not for a moved mesh, nor one from
  /// bytes.
  [[nodiscard]] Discretisation refined(const std::vector<char>& divided) const;

  /// The same grid with its nodes moved.
  [[nodiscard]] Discretisation moved(const Map& place_m) const;

  Nodal points_m;
  std::vector<std::array<int, nodes_per_cell>> cells;
  std::vector<Face> faces;  ///< of the boundary
  /// Per cell and Gauss point its material: 0 the body's, k inclusion_materials[k - 1]. Empty: all the body's.
  std::vector<std::array<std::uint8_t, nodes_per_cell>> materials;
  std::vector<scene::Material> inclusion_materials;

  /// Of one cell, or nullptr when all of the mesh is of the body's material.
  [[nodiscard]] const std::array<std::uint8_t, nodes_per_cell>* materials_of(int cell) const noexcept {
    return materials.empty() ? nullptr : &materials[static_cast<std::size_t>(cell)];
  }
  [[nodiscard]] int node_count() const noexcept { return static_cast<int>(points_m.cols()); }
  [[nodiscard]] int cell_count() const noexcept { return static_cast<int>(cells.size()); }

  [[nodiscard]] bool hangs(int node) const;
  [[nodiscard]] int hanging_count() const;
  /// Of a hanging node: masters, which never hang, and their weights.
  [[nodiscard]] std::vector<std::pair<int, double>> masters(int node) const;
  /// Gives hanging nodes the weighted sum of their masters' values.
  void distribute(Nodal& values) const;
  /// Passes what acts on hanging nodes on to their masters.
  void condense(Nodal& forces) const;

  /// Of one cell, at its Gauss points.
  [[nodiscard]] std::vector<CellGeometry<dim>> cell_geometry() const;
  /// Origin and unit of the pressure's slopes in a cell: middle and longest side of the box around its nodes.
  [[nodiscard]] std::pair<Point, double> pressure_frame(int cell) const;
  /// Per face, at its nodes: the area that the Gauss-Lobatto rule gives the node [m^(dim - 1)], in two dimensions of
  /// the meridian, and the outward normal of unit length.
  struct FaceGeometry {
    std::array<double, nodes_per_face> weight;
    Eigen::Matrix<double, dim, nodes_per_face> normal;
  };
  [[nodiscard]] std::vector<FaceGeometry> face_geometry() const;

  /// Which cells depend on one of these nodes, be it through a hanging one. One per cell.
  [[nodiscard]] std::vector<char> cells_of(const std::vector<int>& nodes) const;
  /// Divides the cells into parts of equal number along a space-filling curve. @returns the part of every cell
  [[nodiscard]] std::vector<int> partition(int parts) const;

  [[nodiscard]] const dealii::DoFHandler<dim, dim>& dof_handler() const;
  [[nodiscard]] const dealii::AffineConstraints<double>& hanging_nodes() const;
  /// From the grid's cells to those of the body at rest.
  [[nodiscard]] const dealii::Mapping<dim, dim>& mapping() const;

 private:
  struct Parts;
  template <class Place>
  void number(const Place& place_m);
  void place(Nodal places_m);

  Map place_m_;
  CellMap place_in_cell_m_;  // in its place, if any
  std::shared_ptr<Parts> parts_;
};

}  // namespace touchstone::reference
