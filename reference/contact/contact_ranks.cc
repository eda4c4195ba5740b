#include "reference/contact/contact_ranks.h"

#include "reference/contact/contact_problem.h"
#include "reference/linear/distributed_solver.h"
#include "reference/linear/record.h"
#include "reference/linear/tangent_solver.h"

#include <algorithm>
#include <functional>

namespace touchstone::reference {
namespace {

/// Everything of a mesh and its materials.
template <class Archive>
void serialize(Archive& archive, auto& mesh, auto& material, auto& kinematics, auto& numerics) {
  int nodes = mesh.node_count();
  archive(nodes);
  if constexpr (Archive::reads) mesh.points_m.resize(mesh.points_m.rows(), nodes);
  archive(mesh.points_m);
  archive.sized(mesh.cells, mesh.faces);
  archive.size(mesh.hanging);
  for (auto& hanging : mesh.hanging) {
    archive(hanging.node);
    archive.sized(hanging.masters);
  }
  archive.sized(mesh.materials, mesh.inclusion_materials);
  archive(material, kinematics, numerics);
}

template <int dim>
std::unique_ptr<ranks::Part> receive_part() {
  std::size_t size = 0;
  ranks::receive(&size, sizeof size);
  std::string bytes(size, '\0');
  ranks::receive(bytes);
  RecordReader record(bytes);
  Mesh<dim> mesh;
  scene::Material material;
  scene::Kinematics kinematics;
  Numerics numerics;
  serialize(record, mesh, material, kinematics, numerics);
  return std::make_unique<ContactProblem<dim>>(std::move(mesh), material, kinematics, false, false, ranks::threads(),
                                               numerics);
}

}  // namespace

void follow_first_rank() { ranks::follow_orders({{2, receive_part<2>}, {3, receive_part<3>}}); }

template <int dim>
std::unique_ptr<ranks::Lead> ContactProblem<dim>::make_parts() const {
  if (ranks::count() == 1 || !ranks::first()) return nullptr;
  RecordWriter record;
  serialize(record, mesh_, material_, kinematics_, numerics_);
  const std::size_t size = record.bytes().size();
  auto lead = std::make_unique<ranks::Lead>(dim);
  ranks::send(&size, sizeof size);
  ranks::send(record.bytes());
  return lead;
}

template <int dim>
std::unique_ptr<LinearSolver> ContactProblem<dim>::make_solver() const {
  if (ranks::count() == 1) return std::make_unique<TangentSolver>(threads_);
  return std::make_unique<DistributedSolver>(lead_.get(), threads_);
}

template <int dim>
void ContactProblem<dim>::send(const State<dim>& state) {
  ranks::send(state.u_m);
  ranks::send(state.p_pa);
}

template <int dim>
State<dim> ContactProblem<dim>::receive_state() const {
  State<dim> state = rest();
  ranks::receive(state.u_m);
  ranks::receive(state.p_pa);
  return state;
}

template <int dim>
void ContactProblem<dim>::take_cells(const std::vector<char>& in_contact) {
  tangent_cells_.clear();
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (in_contact[c] ? ranks::first() : rank_of_cell_[c] == ranks::own()) tangent_cells_.push_back(c);
  }
  pressure_gain_.resize(tangent_cells_.size());
  pressure_offset_pa_.resize(dim + 1, static_cast<Eigen::Index>(tangent_cells_.size()));
}

template <int dim>
void ContactProblem<dim>::follow(Order order) {
  switch (order) {
    case Order::forces:
      (void)forces_of_share(receive_state());
      break;
    case Order::pattern:
      ranks::receive(prescribed_);
      number_unknowns();
      build_pattern();
      break;
    case Order::assemble: {
      const State<dim> state = receive_state();
      ranks::receive(step_offset_m_);
      std::vector<char> in_contact(mesh_.cells.size());
      ranks::receive(in_contact);
      take_cells(in_contact);
      std::array<Stiffness, 1> stiffness{};
      ranks::receive(stiffness);
      assemble(state, stiffness[0]);
      (void)sum_of_lanes();
      break;
    }
    case Order::pressures: {
      Nodal du_m(dim, mesh_.node_count());
      ranks::receive(du_m);
      (void)pressure_change_of_share(du_m);
      break;
    }
    default:
      dynamic_cast<DistributedSolver&>(*solver_).follow(order, matrix_);
  }
}

template std::unique_ptr<ranks::Lead> ContactProblem<2>::make_parts() const;
template std::unique_ptr<LinearSolver> ContactProblem<2>::make_solver() const;
template void ContactProblem<2>::send(const State<2>&);
template void ContactProblem<2>::take_cells(const std::vector<char>&);
template void ContactProblem<2>::follow(Order);
template std::unique_ptr<ranks::Lead> ContactProblem<3>::make_parts() const;
template std::unique_ptr<LinearSolver> ContactProblem<3>::make_solver() const;
template void ContactProblem<3>::send(const State<3>&);
template void ContactProblem<3>::take_cells(const std::vector<char>&);
template void ContactProblem<3>::follow(Order);

}  // namespace touchstone::reference
