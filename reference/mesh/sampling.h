// Nodal vectors at points of the rest surface, on any of our meshes.
#pragma once

#include "reference/discretisation/discretisation.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace touchstone::reference {

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

}  // namespace touchstone::reference
