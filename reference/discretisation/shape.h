// Quadratic shape functions and the points of a cell where integrals are taken, from deal.II.
#pragma once

#include <Eigen/Core>

#include <array>
#include <vector>

namespace touchstone::reference {

/// The shape functions of deal.II's FE_Q(2) at a place of the unit cell [0,1]^dim, nodes in lexicographic order.
template <int dim>
struct Shape {
  static constexpr int size = dim == 3 ? 27 : (dim == 2 ? 9 : 3);
  Eigen::Matrix<double, size, 1> value;
  Eigen::Matrix<double, size, dim> gradient;  ///< with respect to the unit coordinates
  explicit Shape(const Eigen::Matrix<double, dim, 1>& xi);
};

/// A point of deal.II's QGauss(3), exact to degree five in each direction.
template <int dim>
struct GaussPoint {
  Eigen::Matrix<double, dim, 1> xi;
  double weight;
  Shape<dim> shape;
};
template <int dim>
[[nodiscard]] const std::vector<GaussPoint<dim>>& gauss_points();

/// A cell at rest, at its Gauss points. In two dimensions a weight is an area of the meridian plane.
template <int dim>
struct CellGeometry {
  static constexpr int points = Shape<dim>::size;
  std::array<Eigen::Matrix<double, dim, dim>, points> inverse_jacobian_per_m;
  std::array<Eigen::Matrix<double, dim, 1>, points> place_m;
  std::array<double, points> weight;  ///< the rule's times det of the Jacobian [m^dim]
  // Origin and unit of the pressure's slopes: middle and longest side of the box around the nodes.
  Eigen::Matrix<double, dim, 1> center_m;
  double scale_m;
};

}  // namespace touchstone::reference
