// Graded meshes of 9-node quadrilaterals and 27-node hexahedra with hanging nodes, as plain arrays.
// deal.II builds them (mesh.cc is the only file that sees it); everything after is free of it.
#pragma once

#include "scene/model/scene.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace touchstone::reference {

/// What a piece of the boundary is to the problem.
enum class Boundary {
  free,     ///< may touch the tool
  held,     ///< the support: no displacement
  plane_x,  ///< symmetry plane x = 0, and the axis r = 0 in two dimensions
  plane_y,  ///< symmetry plane y = 0
};

/// Quadratic mesh at rest. dim = 3: world coordinates; dim = 2: the meridian plane (r, z) of a body of revolution.
/// Nodes of a cell or face are in lexicographic order, first coordinate fastest.
template <int dim>
struct Mesh {
  static constexpr int nodes_per_cell = dim == 3 ? 27 : 9;
  static constexpr int nodes_per_face = dim == 3 ? 9 : 3;
  using Point = Eigen::Matrix<double, dim, 1>;

  struct Face {
    std::array<int, nodes_per_face> nodes;
    Boundary boundary;
  };
  /// A node on the middle of a coarser neighbour's side: its displacement is the weighted sum of its masters',
  /// and so is its place, which keeps curved meshes conforming.
  struct Hanging {
    int node;
    std::vector<std::pair<int, double>> masters;  ///< node and weight; never hanging themselves
  };

  Eigen::Matrix<double, dim, Eigen::Dynamic> points_m;  ///< one column per node
  std::vector<std::array<int, nodes_per_cell>> cells;
  std::vector<Face> faces;  ///< of the boundary
  std::vector<Hanging> hanging;
  /// Per cell and Gauss point its material: 0 the body's, k inclusion_materials[k - 1]. Empty: all the body's.
  std::vector<std::array<std::uint8_t, nodes_per_cell>> materials;
  std::vector<scene::Material> inclusion_materials;

  /// Of one cell, or nullptr when all of the mesh is of the body's material.
  [[nodiscard]] const std::array<std::uint8_t, nodes_per_cell>* materials_of(int cell) const noexcept {
    return materials.empty() ? nullptr : &materials[static_cast<std::size_t>(cell)];
  }
  [[nodiscard]] int node_count() const noexcept { return static_cast<int>(points_m.cols()); }
  [[nodiscard]] int cell_count() const noexcept { return static_cast<int>(cells.size()); }
};

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
[[nodiscard]] Mesh<3> block_mesh(const BlockSpec& spec);

/// Cylinder 0 <= r <= radius, 0 <= z <= height; z = 0 is held, r = 0 is the axis.
struct CylinderSpec {
  double radius_m = 0.0, height_m = 0.0;
  Grading<2> grading;
};
[[nodiscard]] Mesh<2> cylinder_mesh(const CylinderSpec& spec);

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
[[nodiscard]] Mesh<dim> mapped_mesh(const MappedSpec<dim>& spec);

}  // namespace touchstone::reference
