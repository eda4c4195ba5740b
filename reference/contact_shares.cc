#include "reference/contact_shares.h"

#include "reference/cholmod_solver.h"
#include "reference/contact_problem.h"
#include "reference/distributed_solver.h"
#include "reference/store.h"

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

/// Everything of a mesh and its materials, as one run of bytes.
template <int dim>
Record to_record(const Mesh<dim>& mesh, const scene::Material& material, scene::Kinematics kinematics) {
  Record record;
  record.put(mesh.node_count());
  record.put(mesh.points_m.data(), static_cast<std::size_t>(mesh.points_m.size()));
  const auto put_all = [&](const auto& list) {
    record.put(static_cast<int>(list.size()));
    record.put(list.data(), list.size());
  };
  put_all(mesh.cells);
  put_all(mesh.faces);
  record.put(static_cast<int>(mesh.hanging.size()));
  for (const auto& hanging : mesh.hanging) {
    record.put(hanging.node);
    put_all(hanging.masters);
  }
  put_all(mesh.materials);
  put_all(mesh.inclusion_materials);
  record.put(&material, 1);
  record.put(&kinematics, 1);
  return record;
}

template <int dim>
std::unique_ptr<ranks::Part> from_record(Record record) {
  Mesh<dim> mesh;
  mesh.points_m.resize(dim, record.take_int());
  record.take(mesh.points_m.data(), static_cast<std::size_t>(mesh.points_m.size()));
  const auto take_all = [&](auto& list) {
    list.resize(static_cast<std::size_t>(record.take_int()));
    record.take(list.data(), list.size());
  };
  take_all(mesh.cells);
  take_all(mesh.faces);
  mesh.hanging.resize(static_cast<std::size_t>(record.take_int()));
  for (auto& hanging : mesh.hanging) {
    hanging.node = record.take_int();
    take_all(hanging.masters);
  }
  take_all(mesh.materials);
  take_all(mesh.inclusion_materials);
  scene::Material material;
  scene::Kinematics kinematics;
  record.take(&material, 1);
  record.take(&kinematics, 1);
  return std::make_unique<ContactProblem<dim>>(std::move(mesh), material, kinematics, false, false);
}

template <int dim>
std::unique_ptr<ranks::Part> receive_part() {
  std::size_t size = 0;
  ranks::receive(&size, sizeof size);
  std::string bytes(size, '\0');
  ranks::receive(bytes);
  return from_record<dim>(Record(std::move(bytes)));
}

}  // namespace

template <int dim>
std::vector<char> cells_of_nodes(const Mesh<dim>& mesh, const std::vector<int>& nodes) {
  std::vector<char> is_one(mesh.node_count(), 0);
  for (const int node : nodes) is_one[node] = 1;
  for (const auto& hanging : mesh.hanging) {
    for (const auto& [master, weight] : hanging.masters) is_one[hanging.node] |= is_one[master];
  }
  std::vector<char> result;
  for (const auto& cell : mesh.cells) {
    result.push_back(std::any_of(cell.begin(), cell.end(), [&](int node) { return is_one[node] != 0; }) ? 1 : 0);
  }
  return result;
}

template <int dim>
std::vector<int> cells_of_rank(const Mesh<dim>& mesh, const std::vector<char>& of_the_first, int rank, int ranks) {
  std::vector<int> own, open;
  std::vector<typename Mesh<dim>::Point> middle_m;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    middle_m.push_back(mesh.points_m.col(mesh.cells[c][Mesh<dim>::nodes_per_cell / 2]));
    (of_the_first[c] ? own : open).push_back(c);
  }
  if (rank > 0) own.clear();
  // The first rank's share of the open cells is what it lacks, the others' are equal.
  const double mean = static_cast<double>(mesh.cell_count()) / ranks;
  const double already = static_cast<double>(mesh.cell_count()) - static_cast<double>(open.size());
  const double first_share = std::max(0.0, mean - already);
  const double other_share = ranks > 1 ? (static_cast<double>(open.size()) - first_share) / (ranks - 1) : 0.0;
  const auto share_of = [&](int begin, int count) {
    return begin == 0 ? first_share + (count - 1) * other_share : count * other_share;
  };
  for (int begin = 0, count = ranks; count > 1 && !open.empty();) {
    typename Mesh<dim>::Point low = middle_m[open.front()], high = low;
    for (const int c : open) {
      low = low.cwiseMin(middle_m[c]);
      high = high.cwiseMax(middle_m[c]);
    }
    int side = 0;
    (high - low).maxCoeff(&side);
    const int below = count / 2;
    const double share_below = share_of(begin, below) / share_of(begin, count);
    const auto cut = open.begin() + std::lround(static_cast<double>(open.size()) * share_below);
    const auto before = [&](int a, int b) {
      return middle_m[a][side] != middle_m[b][side] ? middle_m[a][side] < middle_m[b][side] : a < b;
    };
    if (cut != open.end()) std::nth_element(open.begin(), cut, open.end(), before);
    if (rank < begin + below) {
      open.erase(cut, open.end());
      count = below;
    } else {
      open.erase(open.begin(), cut);
      begin += below;
      count -= below;
    }
  }
  own.insert(own.end(), open.begin(), open.end());
  std::sort(own.begin(), own.end());
  return own;
}

void follow_first_rank() { ranks::follow_orders({{2, receive_part<2>}, {3, receive_part<3>}}); }

template <int dim>
std::unique_ptr<ranks::Lead> ContactProblem<dim>::make_parts() const {
  if (ranks::count() == 1 || !ranks::first()) return nullptr;
  const Record record = to_record(mesh_, material_, kinematics_);
  const std::size_t size = record.bytes().size();
  auto lead = std::make_unique<ranks::Lead>(dim);
  ranks::send(&size, sizeof size);
  ranks::send(record.bytes());
  return lead;
}

template <int dim>
std::unique_ptr<LinearSolver> ContactProblem<dim>::make_solver() const {
  if (ranks::count() == 1) return std::make_unique<CholmodSolver>(threads_);
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
      assemble(state);
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
template void ContactProblem<2>::follow(Order);
template std::vector<char> cells_of_nodes<2>(const Mesh<2>&, const std::vector<int>&);
template std::vector<int> cells_of_rank<2>(const Mesh<2>&, const std::vector<char>&, int, int);
template std::unique_ptr<ranks::Lead> ContactProblem<3>::make_parts() const;
template std::unique_ptr<LinearSolver> ContactProblem<3>::make_solver() const;
template void ContactProblem<3>::send(const State<3>&);
template void ContactProblem<3>::follow(Order);
template std::vector<char> cells_of_nodes<3>(const Mesh<3>&, const std::vector<int>&);
template std::vector<int> cells_of_rank<3>(const Mesh<3>&, const std::vector<char>&, int, int);

}  // namespace touchstone::reference
