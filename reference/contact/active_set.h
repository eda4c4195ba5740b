// Which nodes touch the tool, by the primal-dual active set method, and what they ask of the displacement.
#pragma once

#include "reference/contact/contact_model.h"
#include "reference/contact/elastic_body.h"

#include <functional>
#include <vector>

namespace touchstone::reference {

/// Of the current Newton iteration. See contact_problem.h for the method.
template <int dim>
class ActiveSet {
 public:
  using Nodal = typename Discretisation<dim>::Nodal;

  /// @param contact_parameter  factor on c. @param model  must outlive it
  ActiveSet(const ContactModel<dim>& model, double contact_parameter);

  /// Gaps of all nodes that may touch, and the forces at those that do.
  void measure(const State<dim>& state, const Nodal& forces_n);
  /// Next active set; late in a solve it changes less easily. @returns the largest |gap| over active nodes [m]
  double update(State<dim>& state, bool late, bool& changed) const;
  /// Chooses which component of each active node's displacement the others give; all of them where it sticks.
  void eliminate(const State<dim>& state, const std::function<bool(int node)>& sticks);

  [[nodiscard]] const Gap<dim>& gap(int node) const { return gaps_[node]; }
  /// lambda of a node.
  [[nodiscard]] double force_n(int node) const { return lambda_n_[node]; }
  /// The nodes with eliminated components.
  [[nodiscard]] const std::vector<int>& eliminated() const noexcept { return eliminated_nodes_; }
  /// n . du = -g at active nodes, or du = stick_m where they stick.
  [[nodiscard]] std::vector<typename ElasticBody<dim>::Line> lines(const Nodal& stick_m) const;

 private:
  static constexpr int all_directions = dim;

  const ContactModel<dim>& model_;
  double contact_parameter_;
  std::vector<Gap<dim>> gaps_;         // per node
  std::vector<double> lambda_n_;       // per node
  std::vector<int> direction_;         // per node: of the component given by the others, `all_directions`, or -1
  std::vector<int> eliminated_nodes_;  // ascending
};

}  // namespace touchstone::reference
