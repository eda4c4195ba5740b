// Friction at the touching nodes.
#include "reference/contact/contact_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::reference {

template <int dim>
void ContactProblem<dim>::set_friction(const scene::Friction& friction, double region_gap_m) {
  friction_.emplace(friction);
  region_gap_m_ = region_gap_m;
}

template <int dim>
void ContactProblem<dim>::note_places(const RigidTool<dim>& tool, State<dim>& state) const {
  state.on_tool_m = Eigen::Matrix3Xd::Zero(3, mesh_.node_count());
  for (const int node : contact_nodes_) {
    state.on_tool_m.col(node) = tool.in_tool_frame(mesh_.points_m.col(node) + state.u_m.col(node));
  }
}

template <int dim>
typename ContactProblem<dim>::Point ContactProblem<dim>::contact_place_m(const State<dim>& state, int node) const {
  if (kinematics_ == scene::Kinematics::small) return mesh_.points_m.col(node);
  return mesh_.points_m.col(node) + state.u_m.col(node);
}

template <int dim>
typename ContactProblem<dim>::Touching ContactProblem<dim>::touching_points(const State<dim>& state,
                                                                            double region_gap_m) const {
  Touching touching;
  std::vector<int> index(mesh_.node_count(), -1);
  for (const int node : contact_nodes_) {
    if (!state.touching[node]) continue;
    index[node] = static_cast<int>(touching.nodes.size());
    touching.nodes.push_back(node);
  }
  for (const double x : {1.0, -1.0}) {
    for (const double y : {1.0, -1.0}) {
      if ((x > 0.0 || (dim == 3 && mirror_x_)) && (y > 0.0 || (dim == 3 && mirror_y_))) {
        touching.mirrors.emplace_back(x, y, 1.0);
      }
    }
  }
  const int count = static_cast<int>(touching.nodes.size());
  if constexpr (dim == 3) {
    Eigen::Matrix3Xd points_m(3, count * static_cast<int>(touching.mirrors.size()));
    std::vector<std::pair<int, int>> links;
    for (std::size_t m = 0; m < touching.mirrors.size(); ++m) {
      const int first = static_cast<int>(m) * count;
      for (int i = 0; i < count; ++i) {
        points_m.col(first + i) = touching.mirrors[m].cwiseProduct(contact_place_m(state, touching.nodes[i]));
      }
      for (const auto& face : mesh_.faces) {
        int before = -1;
        for (const int node : face.nodes) {
          const int here = index[node];
          if (here >= 0 && before >= 0) links.emplace_back(first + before, first + here);
          if (here >= 0) before = here;
        }
      }
    }
    touching.region_of = region_of_points(points_m, links, region_gap_m);
  } else {
    touching.region_of.assign(count, 0);
  }
  return touching;
}

template <int dim>
bool ContactProblem<dim>::can_slip(int node) const {
  int free = 0;
  for (int i = 0; i < dim; ++i) free += prescribed_[node * dim + i] ? 0 : 1;
  return free > 1;
}

template <int dim>
typename ContactProblem<dim>::Point ContactProblem<dim>::along_surface(int node, const Point& normal,
                                                                       Point vector) const {
  for (int i = 0; i < dim; ++i) {
    if (prescribed_[node * dim + i]) vector[i] = 0.0;
  }
  return vector - vector.dot(normal) * normal;
}

template <int dim>
std::vector<NodeContact<dim>> ContactProblem<dim>::contacts_of(const State<dim>& state, const Nodal& forces_n,
                                                               const Touching& touching) const {
  const int count = static_cast<int>(touching.nodes.size());
  std::vector<NodeContact<dim>> contacts(count);
  for (int i = 0; i < count; ++i) {
    NodeContact<dim>& contact = contacts[i];
    const int node = contact.node = touching.nodes[i];
    contact.normal = gap(state, node).gradient;
    for (int k = 0; k < dim; ++k) {
      if (prescribed_[node * dim + k]) contact.normal[k] = 0.0;
    }
    contact.normal.normalize();
    contact.normal_n = contact.normal.dot(forces_n.col(node));
    contact.friction_n = along_surface(node, contact.normal, forces_n.col(node));
    contact.slips = friction_ && !state.slipping.empty() && state.slipping[node];
    contact.region = touching.region_of[i];
  }
  if (!friction_ || count == 0) return contacts;
  std::vector<double> normal_n(1 + *std::max_element(touching.region_of.begin(), touching.region_of.end()), 0.0);
  std::vector<char> sliding(normal_n.size(), 0);
  for (std::size_t point = 0; point < touching.region_of.size(); ++point) {
    const NodeContact<dim>& contact = contacts[point % count];
    normal_n[touching.region_of[point]] += contact.normal_n;
    if (!state.sliding.empty() && state.sliding[contact.node]) sliding[touching.region_of[point]] = 1;
  }
  // While nothing presses yet, next to nothing stands for it.
  const double length_m = tool_->half_width_m();
  const double least_n = 1e-10 * material_.shear_modulus_pa() * length_m * length_m;
  for (NodeContact<dim>& contact : contacts) {
    contact.coefficient =
        friction_->coefficient(std::max(normal_n[contact.region], least_n), sliding[contact.region] != 0);
  }
  return contacts;
}

template <int dim>
std::vector<NodeContact<dim>> ContactProblem<dim>::node_contacts(const State<dim>& state, double region_gap_m) const {
  if (!tool_) return {};
  std::vector<NodeContact<dim>> contacts =
      contacts_of(state, forces(state).nodal_n, touching_points(state, region_gap_m));
  std::erase_if(contacts, [&](const NodeContact<dim>& contact) { return !can_slip(contact.node); });
  return contacts;
}

template <int dim>
void ContactProblem<dim>::begin_increment(State<dim>& state) {
  state.slipping.resize(mesh_.node_count(), 0);
  state.sliding.resize(mesh_.node_count(), 0);
  const Eigen::Vector3d nowhere = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  anchors_m_ = nowhere.replicate(1, mesh_.node_count());
  slip_direction_ = Nodal::Zero(dim, mesh_.node_count());
  slip_stiffness_n_per_m_.assign(mesh_.node_count(), 0.0);
  for (const int node : contact_nodes_) {
    slip_stiffness_n_per_m_[node] = material_.youngs_modulus_pa * std::sqrt(area_m2_[node]);
  }
  if (state.on_tool_m.cols() == 0 || !tool_) return;
  for (const int node : contact_nodes_) {
    if (!state.touching[node]) continue;
    // A sticking node cannot make up for a gap that the last solution left it.
    anchors_m_.col(node) = kinematics_ == scene::Kinematics::finite
                               ? tool_->entry_T_m(nowhere, state.on_tool_m.col(node))
                               : scene::Vec3(state.on_tool_m.col(node));
  }
}

template <int dim>
double ContactProblem<dim>::update_slipping(State<dim>& state, const std::vector<char>& before, const Nodal& forces_n,
                                            int iteration, bool& changed) {
  contacts_.clear();
  slips_.clear();
  contact_of_.assign(mesh_.node_count(), -1);
  slip_row_.assign(mesh_.node_count(), -1);
  slip_rows_ = 0;
  stick_m_.setZero(dim, mesh_.node_count());
  double unplaced_m = 0.0;
  if (!tool_) return unplaced_m;
  constexpr double steepest_turning = 1e4;
  // How much k_n falls where a slip turns round without coming to rest: it was above twice what the body resists with,
  // and the slip would swing between two sides for ever.
  constexpr double softer = 0.25;
  std::vector<NodeContact<dim>> contacts = contacts_of(state, forces_n, touching_points(state, region_gap_m_));
  double acting_n = 0.0;
  for (const NodeContact<dim>& contact : contacts) acting_n += std::abs(contact.normal_n);
  std::vector<char> next(state.slipping.size(), 0);
  for (NodeContact<dim>& contact : contacts) {
    const int node = contact.node;
    if (!can_slip(node)) continue;
    const Point x_m = mesh_.points_m.col(node) + state.u_m.col(node);
    if (!anchors_m_.col(node).allFinite()) {
      const scene::Vec3 from_T_m =
          state.on_tool_m.cols() > 0 ? scene::Vec3(state.on_tool_m.col(node)) : scene::Vec3(anchors_m_.col(node));
      anchors_m_.col(node) = tool_->entry_T_m(from_T_m, tool_->in_tool_frame(x_m));
    }
    Point to_anchor_m = tool_->in_world(anchors_m_.col(node)) - x_m;
    contact.slip_m = -along_surface(node, contact.normal, to_anchor_m);
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
      if (kinematics_ == scene::Kinematics::small) {
        to_anchor_m = -contact.slip_m - gaps_[node].value_m * contact.normal;
      }
      for (int i = 0; i < dim; ++i) {
        if (!prescribed_[node * dim + i]) stick_m_(i, node) = to_anchor_m[i];
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
std::vector<typename ContactProblem<dim>::RegionFriction> ContactProblem<dim>::region_frictions(
    const State<dim>& state) const {
  const Touching touching = touching_points(state, region_gap_m_);
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
bool ContactProblem<dim>::begin_sliding(State<dim>& state) const {
  // Slip in all directions, as when the tool is pressed, is not the tool's sliding.
  constexpr double one_way_share = 0.9;
  const std::vector<RegionFriction> regions = region_frictions(state);
  bool weaker = false;
  for (const NodeContact<dim>& contact : contacts_) {
    const RegionFriction& region = regions[contact.region];
    if (region.slides || region.sticks_somewhere || region.friction_n.norm() < one_way_share * region.limit_n) continue;
    weaker = weaker || friction_->mu_D() < contact.coefficient;
    state.sliding[contact.node] = 1;
  }
  return weaker;
}

template <int dim>
void ContactProblem<dim>::keep_history(State<dim>& state) const {
  if (!tool_) return;
  const std::vector<RegionFriction> regions = region_frictions(state);
  const double images = (mirror_x_ ? 2.0 : 1.0) * (mirror_y_ ? 2.0 : 1.0);
  std::fill(state.sliding.begin(), state.sliding.end(), 0);
  for (const NodeContact<dim>& contact : contacts_) {
    const RegionFriction& region = regions[contact.region];
    state.sliding[contact.node] = region.slides && region.slipping_normal_n > 0.5 * region.normal_n;
    if (contact.slips) {
      const double limit_n = contact.coefficient * std::max(contact.normal_n, 0.0);
      state.dissipated_j -= images * limit_n * slips_[contact_of_[contact.node]].direction.dot(contact.slip_m);
    }
  }
  note_places(*tool_, state);
}

template <int dim>
std::vector<typename ElasticBody<dim>::InReaction> ContactProblem<dim>::in_slip_rows() const {
  if (slip_rows_ == 0) return {};
  // A slipping node's normal force is the sum of its nodal forces times the normal's components.
  std::vector<typename ElasticBody<dim>::InReaction> result(prescribed_.size());
  for (const NodeContact<dim>& contact : contacts_) {
    for (int i = 0; i < dim && contact.slips; ++i) {
      if (!prescribed_[contact.node * dim + i])
        result[contact.node * dim + i] = {slip_row_[contact.node], contact.normal[i]};
    }
  }
  return result;
}

template <int dim>
void ContactProblem<dim>::add_turning() {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const NodeContact<dim>& contact = contacts_[k];
    if (!contact.slips || dim == 2) continue;
    Eigen::Matrix<double, dim, dim> K = Eigen::Matrix<double, dim, dim>::Identity();
    for (int i = 0; i < dim; ++i) {
      if (prescribed_[contact.node * dim + i]) K(i, i) = 0.0;
    }
    K -= contact.normal * contact.normal.transpose() + slips_[k].direction * slips_[k].direction.transpose();
    K *= slips_[k].turning_n_per_m;
    body_.add(contact.node, K, K * contact.slip_m);
  }
}

template <int dim>
SlipCoupling ContactProblem<dim>::slip_coupling() const {
  SlipCoupling slip;
  slip.normal_n = body_.reactions().value_n;
  slip.guess_n.setZero(slip_rows_);
  std::vector<Eigen::Triplet<double>> rows = body_.reactions().row, columns;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const NodeContact<dim>& contact = contacts_[k];
    if (!contact.slips) continue;
    const int row = slip_row_[contact.node];
    const Point friction = (contact.normal_n > 0.0 ? contact.coefficient : 0.0) * slips_[k].direction;
    // Where the tool bends, the normal turns towards the friction as the node moves: dN = (dn) . t.
    const Point turned = gaps_[contact.node].hessian_per_m * contact.friction_n;
    slip.guess_n[row] = contact.normal_n;
    for (int i = 0; i < dim; ++i) {
      slip.normal_n[row] += turned[i] * body_.expand(contact.node * dim + i, [&](int unknown, double weight) {
        columns.emplace_back(unknown, row, -weight * friction[i]);
        rows.emplace_back(row, unknown, weight * turned[i]);
      });
    }
  }
  slip.row.resize(slip_rows_, unknowns());
  slip.row.setFromTriplets(rows.begin(), rows.end());
  slip.column.resize(unknowns(), slip_rows_);
  slip.column.setFromTriplets(columns.begin(), columns.end());
  return slip;
}

template void ContactProblem<2>::set_friction(const scene::Friction&, double);
template void ContactProblem<2>::note_places(const RigidTool<2>&, State<2>&) const;
template std::vector<NodeContact<2>> ContactProblem<2>::node_contacts(const State<2>&, double) const;
template std::vector<NodeContact<2>> ContactProblem<2>::contacts_of(const State<2>&, const Nodal&,
                                                                    const Touching&) const;
template ContactProblem<2>::Touching ContactProblem<2>::touching_points(const State<2>&, double) const;
template ContactProblem<2>::Point ContactProblem<2>::contact_place_m(const State<2>&, int) const;
template void ContactProblem<2>::begin_increment(State<2>&);
template double ContactProblem<2>::update_slipping(State<2>&, const std::vector<char>&, const Nodal&, int, bool&);
template std::vector<ContactProblem<2>::RegionFriction> ContactProblem<2>::region_frictions(const State<2>&) const;
template bool ContactProblem<2>::begin_sliding(State<2>&) const;
template void ContactProblem<2>::keep_history(State<2>&) const;
template std::vector<ElasticBody<2>::InReaction> ContactProblem<2>::in_slip_rows() const;
template void ContactProblem<2>::add_turning();
template SlipCoupling ContactProblem<2>::slip_coupling() const;
template void ContactProblem<3>::set_friction(const scene::Friction&, double);
template void ContactProblem<3>::note_places(const RigidTool<3>&, State<3>&) const;
template std::vector<NodeContact<3>> ContactProblem<3>::node_contacts(const State<3>&, double) const;
template std::vector<NodeContact<3>> ContactProblem<3>::contacts_of(const State<3>&, const Nodal&,
                                                                    const Touching&) const;
template ContactProblem<3>::Touching ContactProblem<3>::touching_points(const State<3>&, double) const;
template ContactProblem<3>::Point ContactProblem<3>::contact_place_m(const State<3>&, int) const;
template void ContactProblem<3>::begin_increment(State<3>&);
template double ContactProblem<3>::update_slipping(State<3>&, const std::vector<char>&, const Nodal&, int, bool&);
template std::vector<ContactProblem<3>::RegionFriction> ContactProblem<3>::region_frictions(const State<3>&) const;
template bool ContactProblem<3>::begin_sliding(State<3>&) const;
template void ContactProblem<3>::keep_history(State<3>&) const;
template std::vector<ElasticBody<3>::InReaction> ContactProblem<3>::in_slip_rows() const;
template void ContactProblem<3>::add_turning();
template SlipCoupling ContactProblem<3>::slip_coupling() const;

}  // namespace touchstone::reference
