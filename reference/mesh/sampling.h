// Values at points of the body at rest, on any of our meshes.
#pragma once

#include "reference/discretisation/discretisation.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace touchstone::reference {

/// A point of the whole body, folded onto the part of it that is meshed.
template <int dim>
struct Folded {
  Eigen::Matrix<double, dim, 1> point_m;
  /// Turns the mesh's directions into the world's: x, y, z; or r, z and around the axis, on it x, z, y.
  Eigen::Matrix3d to_world;
};
template <int dim>
[[nodiscard]] Folded<dim> folded(const Eigen::Vector3d& point_m, bool mirror_x, bool mirror_y);

/// Interpolation weights of rest points in the boundary faces of one mesh, found once.
template <int dim>
class SurfaceSampler {
 public:
  /// @param rest_points_m  3 x n, on the body's rest surface, world frame; mirror images and all angles around the axis
  ///                       are folded onto the mesh
  /// @throws scene::InputError when a point is not on the surface (further than a thousandth of the body's size)
  SurfaceSampler(const Discretisation<dim>& mesh, const Eigen::Matrix3Xd& rest_points_m, bool mirror_x, bool mirror_y);

  /// @param nodal  a vector per node, such as its displacement; @returns 3 x n, world frame
  [[nodiscard]] Eigen::Matrix3Xd at_points(const Eigen::Matrix<double, dim, Eigen::Dynamic>& nodal) const;

 private:
  struct Sample {
    std::array<int, Discretisation<dim>::nodes_per_face> nodes;
    Eigen::Matrix<double, Discretisation<dim>::nodes_per_face, 1> weights;
    Eigen::Matrix<double, 3, dim> to_world;  // unfolds the mesh's directions at this point
  };
  std::vector<Sample> samples_;
};

/// Interpolation weights of points anywhere in the body in the cells of one mesh, found once. Where a point lies in
/// several cells, on their common side, it takes the mean of what they give.
template <int dim>
class BodySampler {
 public:
  /// @param points_m  3 x n, in the body at rest or on its surface, world frame; folded like the surface's
  /// @throws scene::InputError when a point is outside (further than a thousandth of the body's size)
  BodySampler(const Discretisation<dim>& mesh, const Eigen::Matrix3Xd& points_m, bool mirror_x, bool mirror_y);

  /// @param nodal  a vector per node, such as its displacement; @returns 3 x n, world frame
  [[nodiscard]] Eigen::Matrix3Xd vectors(const Eigen::Matrix<double, dim, Eigen::Dynamic>& nodal) const;
  /// @param values  numbers per cell and node, one column each, in the order of Discretisation::cells
  [[nodiscard]] Eigen::RowVectorXd numbers(const Eigen::RowVectorXd& values) const;
  /// @param values  3 x 3 matrices by columns, likewise, in the mesh's directions; @returns the same in the world's
  [[nodiscard]] Eigen::Matrix<double, 9, Eigen::Dynamic> tensors(
      const Eigen::Matrix<double, 9, Eigen::Dynamic>& values) const;

 private:
  struct InCell {
    int cell;
    Eigen::Matrix<double, Discretisation<dim>::nodes_per_cell, 1> weights;
  };
  struct Sample {
    std::vector<InCell> cells;
    Eigen::Matrix3d to_world;
  };
  const Discretisation<dim>& mesh_;
  std::vector<Sample> samples_;
};

}  // namespace touchstone::reference
