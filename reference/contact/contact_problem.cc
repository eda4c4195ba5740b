#include "reference/contact/contact_problem.h"

#include <stdexcept>

namespace touchstone::reference {

template <int dim>
ContactProblem<dim>::ContactProblem(Discretisation<dim> mesh, const scene::Material& material,
                                    scene::Kinematics kinematics, bool mirror_x, bool mirror_y, int threads,
                                    const Numerics& numerics)
    : body_(std::move(mesh), material, kinematics, threads, numerics),
      model_(body_.mesh(), material, kinematics, mirror_x, mirror_y),
      newton_(model_, body_, numerics.contact_parameter) {
  body_.number_unknowns(model_.prescribed, model_.nodes);
}

template <int dim>
void ContactProblem<dim>::prescribe(int node, int direction, double displacement_m) {
  model_.prescribed_m(direction, node) = displacement_m;
  if (model_.is_prescribed(node, direction)) return;
  model_.prescribed[node * dim + direction] = 1;
  body_.number_unknowns(model_.prescribed, model_.nodes);
}

template <int dim>
void ContactProblem<dim>::set_friction(const scene::Friction& friction, double region_gap_m) {
  model_.friction.emplace(friction);
  model_.region_gap_m = region_gap_m;
}

template <int dim>
State<dim> ContactProblem<dim>::rest() const {
  const Discretisation<dim>& mesh = body_.mesh();
  return {Discretisation<dim>::Nodal::Zero(dim, mesh.node_count()),
          ElasticBody<dim>::Pressures::Zero(dim + 1, mesh.cell_count()), std::vector<char>(mesh.node_count(), 0)};
}

template <int dim>
std::vector<NodeContact<dim>> ContactProblem<dim>::node_contacts(const State<dim>& state, double region_gap_m) const {
  if (!model_.tool) return {};
  std::vector<NodeContact<dim>> contacts =
      model_.contacts_of(state, body_.forces(state).nodal_n, model_.touching_points(state, region_gap_m));
  std::erase_if(contacts, [&](const NodeContact<dim>& contact) { return !model_.can_slip(contact.node); });
  return contacts;
}

template <int dim>
void ContactProblem<dim>::factorise_at_rest() {
  if (holds_rest_factor_) return;
  const State<dim> at_rest = rest();
  body_.constrain(at_rest.u_m, {});
  body_.assemble(at_rest, Stiffness::consistent, {}, 0.0);
  if (!body_.solver().factorise(body_.matrix())) throw std::runtime_error("the stiffness at rest is singular");
  holds_rest_factor_ = true;
}

template <int dim>
Eigen::Matrix<double, dim, Eigen::Dynamic> ContactProblem<dim>::linear_displacement_m() {
  factorise_at_rest();
  body_.constrain(model_.prescribed_m, {});
  // What the prescribed displacements alone do, then the balance of the rest.
  State<dim> state = rest();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns());
  state.u_m = body_.displacement_m(x);
  state.p_pa = body_.pressure_change_pa(state.u_m);
  const auto forces_n = body_.forces(state).nodal_n;
  for (Eigen::Index dof = 0; dof < forces_n.size(); ++dof) {
    if (const int unknown = body_.unknown(static_cast<int>(dof)); unknown >= 0) x[unknown] = -forces_n.data()[dof];
  }
  body_.solver().solve(x);
  return body_.displacement_m(x);
}

template <int dim>
std::vector<Eigen::Matrix<double, dim, Eigen::Dynamic>> ContactProblem<dim>::linear_displacements_m(
    const std::vector<NodeForce>& forces) {
  factorise_at_rest();
  body_.constrain(rest().u_m, {});
  const auto count = static_cast<Eigen::Index>(forces.size());
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(unknowns(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const NodeForce& one = forces[static_cast<std::size_t>(k)];
    for (int i = 0; i < dim; ++i) {
      if (const int unknown = body_.unknown(one.node * dim + i); unknown >= 0) x(unknown, k) = one.force_n[i];
    }
  }
  body_.solver().solve_columns(x);
  std::vector<typename Discretisation<dim>::Nodal> displacements_m;
  for (const auto& column : x.colwise()) displacements_m.push_back(body_.displacement_m(column));
  return displacements_m;
}

template class ContactProblem<2>;
template class ContactProblem<3>;

}  // namespace touchstone::reference
