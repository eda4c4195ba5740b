#include "reference/contact/interior.h"

#include "reference/fe/element.h"

#include <Eigen/LU>

namespace touchstone::reference {

template <int dim>
Interior interior(const Discretisation<dim>& mesh, const scene::Material& material, scene::Kinematics kinematics,
                  const State<dim>& state) {
  constexpr int count = Discretisation<dim>::nodes_per_cell;
  // Per Gauss point the share of every node's value, and back.
  Eigen::Matrix<double, count, count> at_points;
  for (int q = 0; q < count; ++q) at_points.row(q) = gauss_points<dim>()[q].shape.value.transpose();
  const Eigen::Matrix<double, count, count> to_nodes = at_points.inverse().transpose();

  std::vector<MixedMaterial> inclusions;
  for (const scene::Material& inclusion : mesh.inclusion_materials) inclusions.emplace_back(inclusion, kinematics);
  const Element<dim> element(MixedMaterial(material, kinematics), inclusions);
  const std::vector<CellGeometry<dim>> geometry = mesh.cell_geometry();
  Interior result;
  result.stress_pa.resize(9, Eigen::Index{count} * mesh.cell_count());
  result.J_minus_1.resize(result.stress_pa.cols());
  CellResult<dim> forces;
  for (int cell = 0; cell < mesh.cell_count(); ++cell) {
    typename Element<dim>::PointStates points;
    (void)element.evaluate(geometry[cell], state.u_m(Eigen::all, mesh.cells[cell]), state.p_pa.col(cell),
                           Stiffness::none, forces, mesh.materials_of(cell), &points);
    Eigen::Matrix<double, 9, count> stress_pa;
    Eigen::Matrix<double, 1, count> J_minus_1;
    for (int q = 0; q < count; ++q) {
      stress_pa.col(q) = points[q].stress_pa.reshaped();
      J_minus_1[q] = points[q].J_minus_1;
    }
    result.stress_pa.template middleCols<count>(Eigen::Index{count} * cell) = stress_pa * to_nodes;
    result.J_minus_1.template segment<count>(Eigen::Index{count} * cell) = J_minus_1 * to_nodes;
  }
  return result;
}

template Interior interior(const Discretisation<2>&, const scene::Material&, scene::Kinematics, const State<2>&);
template Interior interior(const Discretisation<3>&, const scene::Material&, scene::Kinematics, const State<3>&);

}  // namespace touchstone::reference
