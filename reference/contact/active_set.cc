#include "reference/contact/active_set.h"

#include <algorithm>
#include <cmath>

namespace touchstone::reference {

template <int dim>
ActiveSet<dim>::ActiveSet(const ContactModel<dim>& model, double contact_parameter)
    : model_(model),
      contact_parameter_(contact_parameter),
      gaps_(model.mesh.node_count()),
      lambda_n_(model.mesh.node_count(), 0.0),
      direction_(model.mesh.node_count(), -1) {}

template <int dim>
void ActiveSet<dim>::measure(const State<dim>& state, const Nodal& forces_n) {
  if (!model_.tool) return;
  for (const int node : model_.nodes) {
    gaps_[node] = model_.gap(state, node);
    double normal2 = 0.0;
    lambda_n_[node] = 0.0;
    for (int i = 0; i < dim && state.touching[node]; ++i) {
      if (model_.is_prescribed(node, i)) continue;
      lambda_n_[node] += gaps_[node].gradient[i] * forces_n(i, node);
      normal2 += gaps_[node].gradient[i] * gaps_[node].gradient[i];
    }
    if (normal2 > 0.0) lambda_n_[node] /= normal2;
  }
}

template <int dim>
double ActiveSet<dim>::update(State<dim>& state, bool late, bool& changed) const {
  changed = false;
  double open_m = 0.0;
  if (!model_.tool) return open_m;
  const double c_pa_per_m = contact_parameter_ * model_.material.youngs_modulus_pa / model_.tool->half_width_m();
  double largest_pa = 0.0;
  for (const int node : model_.nodes) {
    if (model_.area_m2[node] > 0.0) largest_pa = std::max(largest_pa, lambda_n_[node] / model_.area_m2[node]);
  }
  // A node exactly on the contact's edge may flip between two equal answers. Late in the solve it is let go only when
  // it pulls noticeably.
  const double tolerated_pull_pa = late ? 1e-5 * largest_pa : 0.0;
  // What presses on a node of the axis, which has no area, holds its partner too. In a contact narrower than the two
  // the partner alone pulls, and would be let go and caught again for ever.
  std::vector<double> held_n = lambda_n_;
  for (const int node : model_.nodes) {
    const int partner = model_.axis_partner[node];
    if (partner >= 0) held_n[partner] += std::max(lambda_n_[node], 0.0);
  }
  std::vector<char> next(state.touching.size(), 0);
  for (const int node : model_.nodes) {
    const double g_m = gaps_[node].value_m;
    const bool touches =
        state.touching[node] ? held_n[node] / model_.area_m2[node] - c_pa_per_m * g_m > -tolerated_pull_pa : g_m < 0.0;
    next[node] = touches ? 1 : 0;
  }
  if constexpr (dim == 2) {
    for (const int node : model_.nodes) {
      if (model_.axis_partner[node] >= 0) next[node] = next[model_.axis_partner[node]];
    }
  }
  for (const int node : model_.nodes) {
    changed = changed || next[node] != state.touching[node];
    if (next[node]) open_m = std::max(open_m, std::abs(gaps_[node].value_m));
  }
  state.touching = std::move(next);
  return open_m;
}

template <int dim>
void ActiveSet<dim>::eliminate(const State<dim>& state, const std::function<bool(int)>& sticks) {
  eliminated_nodes_.clear();
  for (const int node : model_.nodes) {
    direction_[node] = -1;
    if (!state.touching[node]) continue;
    double largest = 0.0;
    for (int i = 0; i < dim; ++i) {
      if (model_.is_prescribed(node, i) || std::abs(gaps_[node].gradient[i]) <= largest) continue;
      largest = std::abs(gaps_[node].gradient[i]);
      direction_[node] = i;
    }
    if (sticks(node)) direction_[node] = all_directions;
    if (direction_[node] >= 0) eliminated_nodes_.push_back(node);
  }
}

template <int dim>
std::vector<typename ElasticBody<dim>::Line> ActiveSet<dim>::lines(const Nodal& stick_m) const {
  std::vector<typename ElasticBody<dim>::Line> lines;
  for (const int node : eliminated_nodes_) {
    const int direction = direction_[node];
    for (int i = 0; i < dim; ++i) {
      if (model_.is_prescribed(node, i) || (direction != i && direction != all_directions)) continue;
      auto& line = lines.emplace_back();
      line.dof = node * dim + i;
      line.offset_m = direction == all_directions ? stick_m(i, node) : -gaps_[node].value_m / gaps_[node].gradient[i];
      // Solved for the largest component of n.
      for (int j = 0; j < dim && direction != all_directions; ++j) {
        const double weight = -gaps_[node].gradient[j] / gaps_[node].gradient[i];
        if (j != i && weight != 0.0) line.terms.emplace_back(node * dim + j, weight);
      }
    }
  }
  return lines;
}

template class ActiveSet<2>;
template class ActiveSet<3>;

}  // namespace touchstone::reference
