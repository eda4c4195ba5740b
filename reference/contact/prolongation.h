// Carries a solved state from one mesh of a body to a finer one: where Newton starts there.
#pragma once

#include "reference/contact/contact_problem.h"
#include "reference/discretisation/discretisation.h"

#include <memory>
#include <vector>

namespace touchstone::reference {

/// Pairs of cells of two meshes that are refined from one coarse grid, found once.
template <int dim>
class Prolongation {
 public:
  /// Both meshes must outlive it. @throws std::invalid_argument when their coarse grids differ
  Prolongation(const Discretisation<dim>& from, const Discretisation<dim>& to);
  ~Prolongation();

  /// Displacement through the shape functions; in each cell the pressure that is linear in the cell it was cut from; a
  /// surface node is active when the active nodes of its cell have most of its weight.
  [[nodiscard]] State<dim> operator()(const State<dim>& state) const;

 private:
  struct Pairs;
  const Discretisation<dim>& from_;
  const Discretisation<dim>& to_;
  std::unique_ptr<Pairs> pairs_;
  std::vector<int> parents_;  // per cell: that of the other mesh it lies in
};

}  // namespace touchstone::reference
