#include "reference/contact/prolongation.h"

#include <deal.II/dofs/dof_accessor.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/grid/intergrid_map.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/vector.h>
#include <deal.II/numerics/vector_tools_interpolate.h>

#include <stdexcept>

namespace touchstone::reference {

template <int dim>
struct Prolongation<dim>::Pairs {
  dealii::InterGridMap<dealii::DoFHandler<dim>> cells;
};

template <int dim>
Prolongation<dim>::Prolongation(const Discretisation<dim>& from, const Discretisation<dim>& to)
    : from_(from), to_(to), pairs_(std::make_unique<Pairs>()) {
  const auto roots = [](const Discretisation<dim>& mesh) { return mesh.dof_handler().get_triangulation().n_cells(0); };
  if (roots(from) != roots(to)) throw std::invalid_argument("the meshes are not refined from one coarse grid");
  pairs_->cells.make_mapping(from.dof_handler(), to.dof_handler());
  dealii::InterGridMap<dealii::DoFHandler<dim>> back;
  back.make_mapping(to.dof_handler(), from.dof_handler());
  for (const auto& cell : to.dof_handler().active_cell_iterators()) {
    auto parent = back[cell];
    while (parent->has_children()) parent = parent->child(0);
    parents_.push_back(static_cast<int>(parent->active_cell_index()));
  }
}

template <int dim>
Prolongation<dim>::~Prolongation() = default;

template <int dim>
State<dim> Prolongation<dim>::operator()(const State<dim>& state) const {
  constexpr double most = 0.5;
  const auto interpolated = [&](const dealii::Vector<double>& in) {
    dealii::Vector<double> out(to_.dof_handler().n_dofs());
    dealii::VectorTools::interpolate_to_different_mesh(pairs_->cells, in, to_.hanging_nodes(), out);
    return Eigen::Matrix<double, dim, Eigen::Dynamic>(
        Eigen::Map<const Eigen::Matrix<double, dim, Eigen::Dynamic>>(out.begin(), dim, to_.node_count()));
  };
  State<dim> out;
  const double* u_m = state.u_m.data();
  out.u_m = interpolated(dealii::Vector<double>(u_m, u_m + state.u_m.size()));
  // Hanging nodes of the coarser mesh are never active by themselves: they are as much as their masters.
  dealii::Vector<double> active(from_.dof_handler().n_dofs());
  for (int dof = 0; dof < static_cast<int>(active.size()); ++dof) active[dof] = state.touching[dof / dim] ? 1.0 : 0.0;
  from_.hanging_nodes().distribute(active);
  const auto touching = interpolated(active);
  out.touching.assign(static_cast<std::size_t>(to_.node_count()), 0);
  for (const auto& face : to_.faces) {
    if (face.boundary != Boundary::free) continue;
    for (const int node : face.nodes) out.touching[node] = !to_.hangs(node) && touching(0, node) > most ? 1 : 0;
  }
  out.p_pa.resize(dim + 1, to_.cell_count());
  for (int cell = 0; cell < to_.cell_count(); ++cell) {
    const auto [center_m, scale_m] = to_.pressure_frame(cell);
    const auto [parent_center_m, parent_scale_m] = from_.pressure_frame(parents_[cell]);
    const auto p_pa = state.p_pa.col(parents_[cell]);
    const Eigen::Matrix<double, dim, 1> slope_pa = p_pa.template tail<dim>();
    out.p_pa(0, cell) = p_pa[0] + slope_pa.dot(center_m - parent_center_m) / parent_scale_m;
    out.p_pa.col(cell).template tail<dim>() = slope_pa * (scale_m / parent_scale_m);
  }
  return out;
}

template class Prolongation<2>;
template class Prolongation<3>;

}  // namespace touchstone::reference
