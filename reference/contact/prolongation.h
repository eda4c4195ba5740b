// Carries a solved state from one mesh of a body to a finer one: where Newton starts there.
#pragma once

#include "reference/contact/contact_problem.h"
#include "reference/mesh/mesh.h"

#include <vector>

namespace touchstone::reference {

/// The cell and the unit coordinates in which the nodes and cell middles of one mesh lie in another, found once.
/// Both meshes are of one body; places outside the other mesh, by the difference of two curved surfaces, go to the
/// nearest cell.
template <int dim>
class Prolongation {
 public:
  /// Both meshes must outlive it.
  Prolongation(const Mesh<dim>& from, const Mesh<dim>& to);

  /// Displacement through the shape functions; in each cell the pressure that is linear in the one its middle lies in;
  /// a surface node is active when the active nodes of its cell have most of its weight.
  [[nodiscard]] State<dim> operator()(const State<dim>& state) const;

 private:
  struct Place {
    int cell;
    Eigen::Matrix<double, dim, 1> xi;
  };
  const Mesh<dim>& from_;
  const Mesh<dim>& to_;
  std::vector<Place> nodes_, middles_;
};

}  // namespace touchstone::reference
