#include "reference/discretisation/volume_file.h"

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_dgq.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/vector.h>
#include <deal.II/numerics/data_out.h>

#include <sstream>

namespace touchstone::reference {

template <int dim>
std::string volume_file(const Discretisation<dim>& mesh, const std::vector<CellField>& fields) {
  using namespace dealii;
  constexpr int count = Discretisation<dim>::nodes_per_cell;
  std::vector<std::string> names;
  std::vector<DataComponentInterpretation::DataComponentInterpretation> meaning;
  for (const CellField& field : fields) {
    const bool vector = field.values.rows() > 1;
    for (Eigen::Index row = 0; row < field.values.rows(); ++row) {
      names.push_back(field.name);
      meaning.push_back(vector ? DataComponentInterpretation::component_is_part_of_vector
                               : DataComponentInterpretation::component_is_scalar);
    }
  }
  // Its numbering of a cell's nodes is lexicographic.
  const FESystem<dim> element(FE_DGQ<dim>(2), static_cast<unsigned int>(names.size()));
  DoFHandler<dim> dofs(mesh.dof_handler().get_triangulation());
  dofs.distribute_dofs(element);
  Vector<double> values(dofs.n_dofs());
  std::vector<types::global_dof_index> of_cell(element.n_dofs_per_cell());
  for (const auto& cell : dofs.active_cell_iterators()) {
    cell->get_dof_indices(of_cell);
    const Eigen::Index first = Eigen::Index{count} * cell->active_cell_index();
    unsigned int component = 0;
    for (const CellField& field : fields) {
      for (Eigen::Index row = 0; row < field.values.rows(); ++row, ++component) {
        for (int a = 0; a < count; ++a) {
          values[of_cell[element.component_to_system_index(component, a)]] = field.values(row, first + a);
        }
      }
    }
  }
  DataOut<dim> out;
  out.add_data_vector(dofs, values, names, meaning);
  out.build_patches(mesh.mapping(), 2, DataOut<dim>::curved_inner_cells);
  DataOutBase::VtkFlags flags;
  flags.print_date_and_time = false;
  out.set_flags(flags);
  std::ostringstream file;
  out.write_vtu(file);
  return file.str();
}

template std::string volume_file(const Discretisation<2>&, const std::vector<CellField>&);
template std::string volume_file(const Discretisation<3>&, const std::vector<CellField>&);

}  // namespace touchstone::reference
