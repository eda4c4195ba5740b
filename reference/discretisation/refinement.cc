#include "reference/discretisation/refinement.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/mapping.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/vector.h>
#include <deal.II/numerics/error_estimator.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace touchstone::reference {

template <int dim>
Eigen::VectorXd squared_error_estimate(const Discretisation<dim>& mesh,
                                       const typename Discretisation<dim>::Nodal& displacement_m) {
  dealii::Vector<float> jumps(static_cast<unsigned int>(mesh.cell_count()));
  dealii::KellyErrorEstimator<dim>::estimate(
      mesh.mapping(), mesh.dof_handler(), dealii::QGauss<dim - 1>(3), {},
      dealii::Vector<double>(displacement_m.data(), displacement_m.data() + displacement_m.size()), jumps);
  Eigen::VectorXd squared(mesh.cell_count());
  for (int cell = 0; cell < mesh.cell_count(); ++cell) {
    squared[cell] = static_cast<double>(jumps[cell]) * static_cast<double>(jumps[cell]);
    if constexpr (dim == 2) squared[cell] *= mesh.pressure_frame(cell).first.x();
  }
  return squared;
}

std::vector<char> worst_cells(const Eigen::VectorXd& squared_error, double share) {
  std::vector<int> cells(static_cast<std::size_t>(squared_error.size()));
  std::iota(cells.begin(), cells.end(), 0);
  std::stable_sort(cells.begin(), cells.end(), [&](int a, int b) { return squared_error[a] > squared_error[b]; });
  std::vector<char> worst(cells.size(), 0);
  const auto count = static_cast<std::size_t>(std::ceil(share * static_cast<double>(cells.size())));
  for (std::size_t k = 0; k < count; ++k) worst[cells[k]] = 1;
  return worst;
}

template <int dim>
Discretisation<dim> Discretisation<dim>::refined(const std::vector<char>& divided) const {
  if (static_cast<int>(divided.size()) != cell_count()) throw std::invalid_argument("flags of another mesh");
  const auto grid = std::make_shared<dealii::Triangulation<dim>>();
  grid->copy_triangulation(dof_handler().get_triangulation());
  for (const auto& cell : grid->active_cell_iterators()) {
    if (divided[cell->active_cell_index()]) cell->set_refine_flag();
  }
  grid->execute_coarsening_and_refinement();
  return place_in_cell_m_ ? Discretisation(grid, place_in_cell_m_) : Discretisation(grid, place_m_);
}

template Discretisation<2> Discretisation<2>::refined(const std::vector<char>&) const;
template Discretisation<3> Discretisation<3>::refined(const std::vector<char>&) const;
template Eigen::VectorXd squared_error_estimate<2>(const Discretisation<2>&, const Discretisation<2>::Nodal&);
template Eigen::VectorXd squared_error_estimate<3>(const Discretisation<3>&, const Discretisation<3>::Nodal&);

}  // namespace touchstone::reference
