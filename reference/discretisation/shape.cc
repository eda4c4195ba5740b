#include "reference/discretisation/shape.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/tensor_product_polynomials.h>

namespace touchstone::reference {

template <int dim>
Shape<dim>::Shape(const Eigen::Matrix<double, dim, 1>& xi) {
  static const dealii::TensorProductPolynomials<dim> polynomials(
      dealii::Polynomials::LagrangeEquidistant::generate_complete_basis(2));
  dealii::Point<dim> place;
  for (int d = 0; d < dim; ++d) place[d] = xi[d];
  for (int a = 0; a < size; ++a) {
    value[a] = polynomials.compute_value(a, place);
    const dealii::Tensor<1, dim> slope = polynomials.compute_grad(a, place);
    for (int d = 0; d < dim; ++d) gradient(a, d) = slope[d];
  }
}

template <int dim>
const std::vector<GaussPoint<dim>>& gauss_points() {
  static const std::vector<GaussPoint<dim>> points = [] {
    const dealii::QGauss<dim> rule(3);
    std::vector<GaussPoint<dim>> list;
    for (unsigned int q = 0; q < rule.size(); ++q) {
      Eigen::Matrix<double, dim, 1> xi;
      for (int d = 0; d < dim; ++d) xi[d] = rule.point(q)[d];
      list.push_back({xi, rule.weight(q), Shape<dim>(xi)});
    }
    return list;
  }();
  return points;
}

template struct Shape<1>;
template struct Shape<2>;
template struct Shape<3>;
template const std::vector<GaussPoint<1>>& gauss_points();
template const std::vector<GaussPoint<2>>& gauss_points();
template const std::vector<GaussPoint<3>>& gauss_points();

}  // namespace touchstone::reference
