#include "reference/contact/slipping.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::reference {

template <int dim>
void Slipping<dim>::begin_increment(State<dim>& state) {
  state.slipping.resize(model_.mesh.node_count(), 0);
  state.sliding.resize(model_.mesh.node_count(), 0);
  const Eigen::Vector3d nowhere = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  anchors_m_ = nowhere.replicate(1, model_.mesh.node_count());
  slip_direction_ = Nodal::Zero(dim, model_.mesh.node_count());
  slip_stiffness_n_per_m_.assign(model_.mesh.node_count(), 0.0);
  for (const int node : model_.nodes) {
    slip_stiffness_n_per_m_[node] = model_.material.youngs_modulus_pa * std::sqrt(model_.area_m2[node]);
  }
  if (state.on_tool_m.cols() == 0 || !model_.tool) return;
  for (const int node : model_.nodes) {
    if (!state.touching[node]) continue;
    // A sticking node cannot make up for a gap that the last solution left it.
    anchors_m_.col(node) = model_.kinematics == scene::Kinematics::finite
                               ? model_.tool->entry_T_m(nowhere, state.on_tool_m.col(node))
                               : scene::Vec3(state.on_tool_m.col(node));
  }
}

template <int dim>
double Slipping<dim>::update(State<dim>& state, const std::vector<char>& before, const Nodal& forces_n,
                             const ActiveSet<dim>& active_set, int iteration, double force_tolerance, bool& changed) {
  contacts_.clear();
  slips_.clear();
  contact_of_.assign(model_.mesh.node_count(), -1);
  slip_row_.assign(model_.mesh.node_count(), -1);
  slip_rows_ = 0;
  stick_m_.setZero(dim, model_.mesh.node_count());
  double unplaced_m = 0.0;
  if (!model_.tool) return unplaced_m;
  constexpr double steepest_turning = 1e4;
  // How much k_n falls where a slip turns round without coming to rest: it was above twice what the body resists with,
  // and the slip would swing between two sides for ever.
  constexpr double softer = 0.25;
  std::vector<NodeContact<dim>> contacts =
      model_.contacts_of(state, forces_n, model_.touching_points(state, model_.region_gap_m));
  double acting_n = 0.0;
  for (const NodeContact<dim>& contact : contacts) acting_n += std::abs(contact.normal_n);
  std::vector<char> next(state.slipping.size(), 0);
  for (NodeContact<dim>& contact : contacts) {
    const int node = contact.node;
    if (!model_.can_slip(node)) continue;
    const Point x_m = model_.mesh.points_m.col(node) + state.u_m.col(node);
    if (!anchors_m_.col(node).allFinite()) {
      const scene::Vec3 from_T_m =
          state.on_tool_m.cols() > 0 ? scene::Vec3(state.on_tool_m.col(node)) : scene::Vec3(anchors_m_.col(node));
      anchors_m_.col(node) = model_.tool->entry_T_m(from_T_m, model_.tool->in_tool_frame(x_m));
    }
    Point to_anchor_m = model_.tool->in_world(anchors_m_.col(node)) - x_m;
    contact.slip_m = -model_.along_surface(node, contact.normal, to_anchor_m);
    const double limit_n = contact.coefficient * std::max(contact.normal_n, 0.0);
    const auto trial = [&]() -> Point { return contact.friction_n - slip_stiffness_n_per_m_[node] * contact.slip_m; };
    Point trial_n = trial();
    if (before[node] && trial_n.norm() > limit_n && trial_n.dot(slip_direction_.col(node)) < 0.0) {
      slip_stiffness_n_per_m_[node] *= softer;
      trial_n = trial();
    }
    // A node that comes to touch has no normal force yet: for one iteration it has no friction either.
    contact.slips = state.slipping[node] != 0 || !before[node];
    if (iteration > 0 && before[node]) {
      contact.slips = contact.slips ? trial_n.norm() > limit_n
                                    : contact.friction_n.norm() > limit_n + 0.1 * force_tolerance * acting_n;
    }
    next[node] = contact.slips ? 1 : 0;
    Slip slip;
    if (contact.slips) slip_row_[node] = slip_rows_++;
    if (contact.slips && before[node]) {
      slip.direction = trial_n / std::max(trial_n.norm(), std::numeric_limits<double>::min());
      slip.turning_n_per_m =
          slip_stiffness_n_per_m_[node] * limit_n /
          std::max(trial_n.norm() - limit_n, limit_n / steepest_turning + std::numeric_limits<double>::min());
    }
    slip_direction_.col(node) = slip.direction;
    if (!contact.slips) {
      if (model_.kinematics == scene::Kinematics::small) {
        to_anchor_m = -contact.slip_m - active_set.gap(node).value_m * contact.normal;
      }
      for (int i = 0; i < dim; ++i) {
        if (!model_.prescribed[node * dim + i]) stick_m_(i, node) = to_anchor_m[i];
      }
      unplaced_m = std::max(unplaced_m, stick_m_.col(node).norm());
    }
    contact_of_[node] = static_cast<int>(contacts_.size());
    contacts_.push_back(contact);
    slips_.push_back(slip);
  }
  changed = changed || next != state.slipping;
  state.slipping = std::move(next);
  return unplaced_m;
}

template <int dim>
std::vector<typename Slipping<dim>::RegionFriction> Slipping<dim>::region_frictions(const State<dim>& state) const {
  const Touching touching = model_.touching_points(state, model_.region_gap_m);
  const int count = static_cast<int>(touching.nodes.size());
  std::vector<RegionFriction> regions(touching.region_of.size());
  for (std::size_t point = 0; point < touching.region_of.size(); ++point) {
    const int index = contact_of_[touching.nodes[point % count]];
    if (index < 0) continue;
    const NodeContact<dim>& contact = contacts_[index];
    RegionFriction& region = regions[touching.region_of[point]];
    region.normal_n += contact.normal_n;
    if (contact.slips) region.slipping_normal_n += contact.normal_n;
    region.limit_n += contact.coefficient * contact.normal_n;
    if constexpr (dim == 3) region.friction_n += touching.mirrors[point / count].cwiseProduct(contact.friction_n);
    region.sticks_somewhere = region.sticks_somewhere || !contact.slips;
    region.slides = region.slides || state.sliding[contact.node];
  }
  return regions;
}

template <int dim>
bool Slipping<dim>::begin_sliding(State<dim>& state) const {
  // Slip in all directions, as when the tool is pressed, is not the tool's sliding.
  constexpr double one_way_share = 0.9;
  const std::vector<RegionFriction> regions = region_frictions(state);
  bool weaker = false;
  for (const NodeContact<dim>& contact : contacts_) {
    const RegionFriction& region = regions[contact.region];
    if (region.slides || region.sticks_somewhere || region.friction_n.norm() < one_way_share * region.limit_n) continue;
    weaker = weaker || model_.friction->mu_D() < contact.coefficient;
    state.sliding[contact.node] = 1;
  }
  return weaker;
}

template <int dim>
void Slipping<dim>::keep_history(State<dim>& state) const {
  if (!model_.tool) return;
  const std::vector<RegionFriction> regions = region_frictions(state);
  const double images = model_.images();
  std::fill(state.sliding.begin(), state.sliding.end(), 0);
  for (const NodeContact<dim>& contact : contacts_) {
    const RegionFriction& region = regions[contact.region];
    state.sliding[contact.node] = region.slides && region.slipping_normal_n > 0.5 * region.normal_n;
    if (contact.slips) {
      const double limit_n = contact.coefficient * std::max(contact.normal_n, 0.0);
      state.dissipated_j -= images * limit_n * slips_[contact_of_[contact.node]].direction.dot(contact.slip_m);
    }
  }
  model_.note_places(*model_.tool, state);
}

template <int dim>
typename Slipping<dim>::Point Slipping<dim>::out_of_balance_n(int node, const Point& along_n) const {
  const NodeContact<dim>* contact = contact_at(node);
  if (!contact) return along_n;
  if (!contact->slips) return Point::Zero();
  return along_n - contact->coefficient * std::max(contact->normal_n, 0.0) * slips_[contact_of_[node]].direction;
}

template <int dim>
std::vector<typename ElasticBody<dim>::InReaction> Slipping<dim>::normal_forces() const {
  if (slip_rows_ == 0) return {};
  // A slipping node's normal force is the sum of its nodal forces times the normal's components.
  std::vector<typename ElasticBody<dim>::InReaction> result(model_.prescribed.size());
  for (const NodeContact<dim>& contact : contacts_) {
    for (int i = 0; i < dim && contact.slips; ++i) {
      if (!model_.prescribed[contact.node * dim + i])
        result[contact.node * dim + i] = {slip_row_[contact.node], contact.normal[i]};
    }
  }
  return result;
}

template <int dim>
void Slipping<dim>::add_turning(ElasticBody<dim>& body) const {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const NodeContact<dim>& contact = contacts_[k];
    if (!contact.slips || dim == 2) continue;
    Eigen::Matrix<double, dim, dim> K = Eigen::Matrix<double, dim, dim>::Identity();
    for (int i = 0; i < dim; ++i) {
      if (model_.prescribed[contact.node * dim + i]) K(i, i) = 0.0;
    }
    K -= contact.normal * contact.normal.transpose() + slips_[k].direction * slips_[k].direction.transpose();
    K *= slips_[k].turning_n_per_m;
    body.add(contact.node, K, K * contact.slip_m);
  }
}

template <int dim>
SlipCoupling Slipping<dim>::coupling(const ElasticBody<dim>& body, const ActiveSet<dim>& active_set) const {
  SlipCoupling slip;
  slip.normal_n = body.reactions().value_n;
  slip.guess_n.setZero(slip_rows_);
  std::vector<Eigen::Triplet<double>> rows = body.reactions().row, columns;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const NodeContact<dim>& contact = contacts_[k];
    if (!contact.slips) continue;
    const int row = slip_row_[contact.node];
    const Point friction = (contact.normal_n > 0.0 ? contact.coefficient : 0.0) * slips_[k].direction;
    // Where the tool bends, the normal turns towards the friction as the node moves: dN = (dn) . t.
    const Point turned = active_set.gap(contact.node).hessian_per_m * contact.friction_n;
    slip.guess_n[row] = contact.normal_n;
    for (int i = 0; i < dim; ++i) {
      slip.normal_n[row] += turned[i] * body.expand(contact.node * dim + i, [&](int unknown, double weight) {
        columns.emplace_back(unknown, row, -weight * friction[i]);
        rows.emplace_back(row, unknown, weight * turned[i]);
      });
    }
  }
  slip.row.resize(slip_rows_, body.unknowns());
  slip.row.setFromTriplets(rows.begin(), rows.end());
  slip.column.resize(body.unknowns(), slip_rows_);
  slip.column.setFromTriplets(columns.begin(), columns.end());
  return slip;
}

template class Slipping<2>;
template class Slipping<3>;

}  // namespace touchstone::reference
