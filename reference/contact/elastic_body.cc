#include "reference/contact/elastic_body.h"

#include "reference/contact/contact_ranks.h"
#include "reference/linear/distributed_solver.h"
#include "reference/linear/record.h"
#include "reference/linear/tangent_solver.h"
#include "scene/base/stopwatch.h"

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/affine_constraints.templates.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/vector.h>

#include <algorithm>
#include <map>
#include <thread>

namespace touchstone::reference {
namespace {

using Dof = dealii::types::global_dof_index;

/// Runs work(lane, begin, end) on `lanes` contiguous shares of [0, count). The shares, and so every sum's order,
/// depend on nothing but the numbers given.
template <class Work>
void in_lanes(int lanes, int count, const Work& work) {
  const auto begin = [&](int lane) { return static_cast<int>(static_cast<long>(count) * lane / lanes); };
  std::vector<std::thread> others;
  for (int lane = 1; lane < lanes; ++lane) {
    others.emplace_back([&, lane] { work(lane, begin(lane), begin(lane + 1)); });
  }
  work(0, begin(0), begin(1));
  for (std::thread& thread : others) thread.join();
}

std::vector<MixedMaterial> mixed(const std::vector<scene::Material>& materials, scene::Kinematics kinematics) {
  std::vector<MixedMaterial> result;
  for (const scene::Material& material : materials) result.emplace_back(material, kinematics);
  return result;
}

/// Values on the pattern of a symmetric matrix, to which deal.II's constraints add rows of degrees of freedom.
struct LowerTriangle {
  const SymmetricMatrix& pattern;
  const std::vector<int>& unknown;
  std::vector<double>& value;

  LowerTriangle(const SymmetricMatrix& pattern_in, const std::vector<int>& unknown_in, std::vector<double>& value_in)
      : pattern(pattern_in), unknown(unknown_in), value(value_in) {}
  virtual ~LowerTriangle() = default;  // deal.II asks for the dynamic type
  // deal.II's debug library asks for the sizes.
  [[nodiscard]] std::size_t m() const { return unknown.size(); }
  [[nodiscard]] std::size_t n() const { return unknown.size(); }
  /// @param dofs  ascending, and so their unknowns
  void add(Dof row, Dof count, const Dof* dofs, const double* values, bool /*elide_zeros*/, bool /*sorted*/) {
    std::int64_t k = pattern.column_begin[unknown[row]];
    for (const Dof* dof = std::lower_bound(dofs, dofs + count, row); dof != dofs + count; ++dof) {
      while (pattern.row[k] < unknown[*dof]) ++k;
      value[k] += values[dof - dofs];
    }
  }
  /// The diagonal of what is constrained, which has no unknown.
  void add(Dof, Dof, double) {}
};

/// The same for a right-hand side.
struct RightSide {
  using value_type = double;
  const std::vector<int>& unknown;
  double* value;

  void add(const std::vector<Dof>& dofs, const std::vector<double>& values) {
    for (std::size_t k = 0; k < dofs.size(); ++k) (*this)(dofs[k]) += values[k];
  }
  double& operator()(Dof dof) { return value[unknown[dof]]; }
  [[nodiscard]] std::size_t size() const { return unknown.size(); }
};

}  // namespace

template <int dim>
ElasticBody<dim>::ElasticBody(Discretisation<dim> mesh, const scene::Material& material, scene::Kinematics kinematics,
                              int threads, const Numerics& numerics)
    : mesh_(std::move(mesh)),
      threads_(threads),
      element_(MixedMaterial(material, kinematics), mixed(mesh_.inclusion_materials, kinematics),
               numerics.numerical_bulk),
      geometry_(mesh_.cell_geometry()),
      lead_(make_parts(material, kinematics, numerics)),
      rank_of_cell_(mesh_.partition(ranks::count())) {
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (rank_of_cell_[c] == ranks::own()) cells_.push_back(c);
  }
  if (ranks::count() == 1) {
    solver_ = std::make_unique<TangentSolver>(threads_);
  } else {
    solver_ = std::make_unique<DistributedSolver>(lead_.get(), threads_);
  }
}

template <int dim>
ElasticBody<dim>::~ElasticBody() {
  lead_.reset();  // the solvers of all ranks end together
}

template <int dim>
void ElasticBody<dim>::number_unknowns(const std::vector<char>& prescribed, const std::vector<int>& contact_nodes) {
  prescribed_ = prescribed;
  may_touch_ = mesh_.cells_of(contact_nodes);
  unknown_.assign(prescribed_.size(), -1);
  unknowns_ = 0;
  for (std::size_t dof = 0; dof < unknown_.size(); ++dof) {
    if (!mesh_.hangs(static_cast<int>(dof) / dim) && !prescribed_[dof]) unknown_[dof] = unknowns_++;
  }
  matrix_ = {};
}

template <int dim>
void ElasticBody<dim>::make_pattern(const std::vector<char>& in_contact) {
  const dealii::DoFHandler<dim>& dofs = mesh_.dof_handler();
  const dealii::AffineConstraints<double>& hanging = mesh_.hanging_nodes();
  dealii::DynamicSparsityPattern pattern(dofs.n_dofs());
  dealii::DoFTools::make_sparsity_pattern(dofs, pattern, hanging, false,
                                          static_cast<dealii::types::subdomain_id>(ranks::own()));
  if (ranks::count() > 1 && ranks::first()) {
    std::vector<Dof> of_cell(dofs.get_fe().n_dofs_per_cell());
    for (const auto& cell : dofs.active_cell_iterators()) {
      if (!in_contact[cell->active_cell_index()]) continue;
      cell->get_dof_indices(of_cell);
      hanging.add_entries_local_to_global(of_cell, pattern, false);
    }
  }
  matrix_.column_begin.assign(1, 0);
  matrix_.row.clear();
  for (Dof dof = 0; dof < dofs.n_dofs(); ++dof) {
    const int column = unknown_[dof];
    if (column < 0) continue;
    for (auto entry = pattern.begin(dof); entry != pattern.end(dof); ++entry) {
      if (unknown_[entry->column()] >= column) matrix_.row.push_back(unknown_[entry->column()]);
    }
    matrix_.column_begin.push_back(static_cast<std::int64_t>(matrix_.row.size()));
  }
  matrix_.value.assign(matrix_.row.size(), 0.0);
  lanes_.resize(static_cast<std::size_t>(threads_));
}

template <int dim>
void ElasticBody<dim>::load(Nodal force_n) {
  dead_n_ = std::move(force_n);
  mesh_.condense(dead_n_);
}

template <int dim>
typename ElasticBody<dim>::Forces ElasticBody<dim>::forces(const State<dim>& state) const {
  const scene::CpuTimeAdder watch(assembly_s_);
  Forces sum = jointly(Order::forces, [&] {
    ranks::send(state.u_m);
    ranks::send(state.p_pa);
    return forces_of_share(state);
  });
  mesh_.condense(sum.nodal_n);
  if (dead_n_.size() > 0) sum.nodal_n -= dead_n_;
  return sum;
}

template <int dim>
typename ElasticBody<dim>::Forces ElasticBody<dim>::forces_of_share(const State<dim>& state) const {
  std::vector<Forces> shares(static_cast<std::size_t>(threads_));
  in_lanes(threads_, static_cast<int>(cells_.size()), [&](int lane, int begin, int end) {
    Forces& share = shares[lane];
    share.nodal_n = Nodal::Zero(dim, mesh_.node_count());
    CellResult<dim> result;
    for (int k = begin; k < end && share.admissible; ++k) {
      const int c = cells_[k];
      const auto& nodes = mesh_.cells[c];
      share.admissible = element_.evaluate(geometry_[c], state.u_m(Eigen::all, nodes), state.p_pa.col(c),
                                           Stiffness::none, result, mesh_.materials_of(c));
      for (int i = 0; i < dim; ++i) {
        for (int a = 0; a < mesh_.nodes_per_cell; ++a) {
          share.nodal_n(i, nodes[a]) += result.force_n[i * mesh_.nodes_per_cell + a];
        }
      }
      share.volume_error_rel =
          std::max(share.volume_error_rel, result.volume_m3.cwiseAbs().maxCoeff() / result.rest_volume_m3);
    }
  });
  Forces sum{Nodal::Zero(dim, mesh_.node_count())};
  for (const Forces& share : shares) {
    sum.nodal_n += share.nodal_n;
    sum.volume_error_rel = std::max(sum.volume_error_rel, share.volume_error_rel);
    sum.admissible = sum.admissible && share.admissible;
  }
  ranks::sum_on_first(sum.nodal_n.data(), static_cast<std::size_t>(sum.nodal_n.size()));
  sum.volume_error_rel = ranks::largest_on_first(sum.volume_error_rel);
  sum.admissible = ranks::largest_on_first(sum.admissible ? 0.0 : 1.0) == 0.0;
  return sum;
}

template <int dim>
double ElasticBody<dim>::volume_change_rel(const State<dim>& state) const {
  double change_m3 = 0.0, rest_m3 = 0.0;
  CellResult<dim> result;
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    element_.evaluate(geometry_[c], state.u_m(Eigen::all, mesh_.cells[c]), state.p_pa.col(c), Stiffness::none, result,
                      mesh_.materials_of(c));
    change_m3 += result.volume_change_m3;
    rest_m3 += result.rest_volume_m3;
  }
  return change_m3 / rest_m3;
}

template <int dim>
void ElasticBody<dim>::constrain(const Nodal& step_m, const std::vector<Line>& lines) {
  const scene::CpuTimeAdder watch(assembly_s_);
  step_m_ = step_m;
  constraints_ = std::make_unique<dealii::AffineConstraints<double>>();
  for (const auto& line : mesh_.hanging_nodes().get_lines()) {
    constraints_->add_line(line.index);
    constraints_->add_entries(line.index, line.entries);
  }
  for (std::size_t dof = 0; dof < prescribed_.size(); ++dof) {
    if (!prescribed_[dof] || mesh_.hangs(static_cast<int>(dof) / dim)) continue;
    constraints_->add_line(dof);
    constraints_->set_inhomogeneity(dof, step_m.data()[dof]);
  }
  for (const Line& line : lines) {
    const auto dof = static_cast<Dof>(line.dof);
    constraints_->add_line(dof);
    for (const auto& [other, weight] : line.terms) constraints_->add_entry(dof, static_cast<Dof>(other), weight);
    constraints_->set_inhomogeneity(dof, line.offset_m);
  }
  constraints_->close();
}

template <int dim>
void ElasticBody<dim>::assemble(const State<dim>& state, Stiffness stiffness, const std::vector<int>& constrained_nodes,
                                double their_stiffness_n_per_m, const std::vector<InReaction>& reactions) {
  const scene::CpuTimeAdder watch(assembly_s_);
  if (matrix_.column_begin.empty()) {
    jointly(Order::pattern, [&] {
      ranks::send(prescribed_);
      make_pattern(may_touch_);
    });
    solver_->analyse(matrix_);
  }
  jointly(Order::assemble, [&] {
    ranks::send(state.u_m);
    ranks::send(state.p_pa);
    ranks::send(step_m_);
    const std::vector<char> in_contact = mesh_.cells_of(constrained_nodes);
    ranks::send(in_contact);
    ranks::send(std::array{stiffness});
    assemble_share(state, stiffness, in_contact, reactions);
  });
  RightSide right{unknown_, right_n_.data()};
  for (Eigen::Index dof = 0; dof < dead_n_.size(); ++dof) {
    const double force_n = dead_n_.data()[dof];
    if (force_n != 0.0) constraints_->distribute_local_to_global(static_cast<Dof>(dof), force_n, right);
  }
  for (const int node : constrained_nodes) {
    for (int i = 0; i < dim; ++i) {
      const int unknown = unknown_[node * dim + i];
      if (unknown < 0 || !constraints_->is_constrained(node * dim + i)) continue;
      matrix_.value[matrix_.column_begin[unknown]] = their_stiffness_n_per_m;
    }
  }
}

template <int dim>
void ElasticBody<dim>::assemble_share(const State<dim>& state, Stiffness stiffness, const std::vector<char>& in_contact,
                                      const std::vector<InReaction>& reactions) {
  tangent_cells_.clear();
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (in_contact[c] ? ranks::first() : rank_of_cell_[c] == ranks::own()) tangent_cells_.push_back(c);
  }
  pressure_gain_.resize(tangent_cells_.size());
  pressure_offset_pa_.resize(dim + 1, static_cast<Eigen::Index>(tangent_cells_.size()));
  int sums = 0;
  for (const InReaction& one : reactions) sums = std::max(sums, one.row + 1);
  in_lanes(threads_, static_cast<int>(tangent_cells_.size()), [&](int number, int begin, int end) {
    constexpr int n = CellResult<dim>::unknowns;
    Lane& lane = lanes_[number];
    // The first lane's is the matrix itself.
    std::vector<double>& value = number == 0 ? matrix_.value : lane.value;
    value.assign(matrix_.row.size(), 0.0);
    lane.right_n.assign(static_cast<std::size_t>(unknowns_), 0.0);
    lane.reaction_n.assign(static_cast<std::size_t>(sums), 0.0);
    lane.reaction_rows.clear();
    LowerTriangle matrix(matrix_, unknown_, value);
    RightSide right{unknown_, lane.right_n.data()};
    std::vector<Dof> dofs(n);
    dealii::FullMatrix<double> K(n, n);
    dealii::Vector<double> f(n);
    for (int k = begin; k < end; ++k) {
      const int c = tangent_cells_[k];
      const auto& nodes = mesh_.cells[c];
      element_.evaluate(geometry_[c], state.u_m(Eigen::all, nodes), state.p_pa.col(c), stiffness, lane.cell,
                        mesh_.materials_of(c));
      pressure_gain_[k] = lane.cell.pressure_gain;
      pressure_offset_pa_.col(k) = lane.cell.pressure_offset_pa;
      for (int i = 0; i < dim; ++i) {
        for (int a = 0; a < mesh_.nodes_per_cell; ++a) {
          dofs[i * mesh_.nodes_per_cell + a] = static_cast<Dof>(nodes[a] * dim + i);
        }
      }
      std::copy_n(lane.cell.stiffness.data(), n * n, &K(0, 0));
      for (int r = 0; r < n; ++r) f[r] = -lane.cell.condensed_force_n[r];
      constraints_->distribute_local_to_global(K, f, dofs, matrix, right);
      if (sums > 0) add_reactions(dofs, reactions, lane);
    }
  });
  right_n_ = Eigen::Map<const Eigen::VectorXd>(lanes_[0].right_n.data(), unknowns_);
  reactions_ = {lanes_[0].reaction_rows, Eigen::Map<const Eigen::VectorXd>(lanes_[0].reaction_n.data(), sums)};
  for (std::size_t l = 1; l < lanes_.size(); ++l) {
    const Lane& lane = lanes_[l];
    for (std::size_t k = 0; k < matrix_.value.size(); ++k) matrix_.value[k] += lane.value[k];
    right_n_ += Eigen::Map<const Eigen::VectorXd>(lane.right_n.data(), unknowns_);
    reactions_.row.insert(reactions_.row.end(), lane.reaction_rows.begin(), lane.reaction_rows.end());
    reactions_.value_n += Eigen::Map<const Eigen::VectorXd>(lane.reaction_n.data(), sums);
  }
  ranks::sum_on_first(right_n_.data(), static_cast<std::size_t>(right_n_.size()));
}

template <int dim>
void ElasticBody<dim>::add_reactions(const std::vector<unsigned int>& dofs, const std::vector<InReaction>& reactions,
                                     Lane& lane) const {
  // Per sum the weights of the cell's own degrees of freedom.
  std::map<int, typename CellResult<dim>::Vector> weights;
  const auto add = [&](std::size_t place, Dof dof, double share) {
    const InReaction& in = reactions[dof];
    if (in.row < 0) return;
    const auto [found, is_new] = weights.try_emplace(in.row);
    if (is_new) found->second.setZero();
    found->second[static_cast<Eigen::Index>(place)] += share * in.weight;
  };
  for (std::size_t place = 0; place < dofs.size(); ++place) {
    if (const auto* masters = mesh_.hanging_nodes().get_constraint_entries(dofs[place])) {
      for (const auto& [master, share] : *masters) add(place, master, share);
    } else {
      add(place, dofs[place], 1.0);
    }
  }
  for (const auto& [row, weight] : weights) {
    const typename CellResult<dim>::Vector slope = lane.cell.stiffness * weight;
    lane.reaction_n[row] += weight.dot(lane.cell.condensed_force_n);
    for (std::size_t place = 0; place < dofs.size(); ++place) {
      const double of_place = slope[static_cast<Eigen::Index>(place)];
      lane.reaction_n[row] +=
          of_place * expand(static_cast<int>(dofs[place]), [&, row = row](int unknown, double share) {
            lane.reaction_rows.emplace_back(row, unknown, share * of_place);
          });
    }
  }
}

template <int dim>
double ElasticBody<dim>::expand(int dof, const std::function<void(int, double)>& add) const {
  const auto* entries = constraints_->get_constraint_entries(static_cast<Dof>(dof));
  if (!entries) {
    add(unknown_[dof], 1.0);
    return 0.0;
  }
  for (const auto& [other, weight] : *entries) add(unknown_[other], weight);
  return constraints_->get_inhomogeneity(static_cast<Dof>(dof));
}

template <int dim>
void ElasticBody<dim>::add(int node, const Eigen::Matrix<double, dim, dim>& K,
                           const Eigen::Matrix<double, dim, 1>& f_n) {
  std::vector<Dof> dofs(dim);
  dealii::FullMatrix<double> K_in(dim, dim);
  dealii::Vector<double> f_in(dim);
  for (int i = 0; i < dim; ++i) {
    dofs[i] = static_cast<Dof>(node * dim + i);
    f_in[i] = -f_n[i];
    for (int j = 0; j < dim; ++j) K_in(i, j) = K(i, j);
  }
  LowerTriangle matrix(matrix_, unknown_, matrix_.value);
  RightSide right{unknown_, right_n_.data()};
  constraints_->distribute_local_to_global(K_in, f_in, dofs, matrix, right);
}

template <int dim>
typename ElasticBody<dim>::Nodal ElasticBody<dim>::displacement_m(const Eigen::VectorXd& x) const {
  dealii::Vector<double> on_dofs(static_cast<Dof>(unknown_.size()));
  for (std::size_t dof = 0; dof < unknown_.size(); ++dof) {
    if (unknown_[dof] >= 0) on_dofs[dof] = x[unknown_[dof]];
  }
  constraints_->distribute(on_dofs);
  return Eigen::Map<const Nodal>(on_dofs.begin(), dim, mesh_.node_count());
}

template <int dim>
typename ElasticBody<dim>::Pressures ElasticBody<dim>::pressure_change_pa(const Nodal& du_m) const {
  return jointly(Order::pressures, [&] {
    ranks::send(du_m);
    return pressure_change_of_share(du_m);
  });
}

template <int dim>
typename ElasticBody<dim>::Pressures ElasticBody<dim>::pressure_change_of_share(const Nodal& du_m) const {
  Pressures dp_pa = Pressures::Zero(dim + 1, mesh_.cell_count());
  for (std::size_t k = 0; k < tangent_cells_.size(); ++k) {
    const int c = tangent_cells_[k];
    const typename CellResult<dim>::Vector du_cell_m = du_m(Eigen::all, mesh_.cells[c]).transpose().reshaped();
    dp_pa.col(c) = pressure_offset_pa_.col(static_cast<Eigen::Index>(k)) + pressure_gain_[k] * du_cell_m;
  }
  ranks::sum_on_first(dp_pa.data(), static_cast<std::size_t>(dp_pa.size()));
  return dp_pa;
}

template <int dim>
std::unique_ptr<ranks::Lead> ElasticBody<dim>::make_parts(const scene::Material& material, scene::Kinematics kinematics,
                                                          const Numerics& numerics) const {
  if (ranks::count() == 1 || !ranks::first()) return nullptr;
  RecordWriter record;
  record.sized(mesh_.bytes());
  record(material, kinematics, numerics);
  const std::size_t size = record.bytes().size();
  auto lead = std::make_unique<ranks::Lead>(dim);
  ranks::send(&size, sizeof size);
  ranks::send(record.bytes());
  return lead;
}

template <int dim>
State<dim> ElasticBody<dim>::receive_state() const {
  State<dim> state{Nodal::Zero(dim, mesh_.node_count()), Pressures::Zero(dim + 1, mesh_.cell_count()), {}};
  ranks::receive(state.u_m);
  ranks::receive(state.p_pa);
  return state;
}

template <int dim>
void ElasticBody<dim>::follow(Order order) {
  switch (order) {
    case Order::forces:
      (void)forces_of_share(receive_state());
      break;
    case Order::pattern:
      prescribed_.resize(dim * static_cast<std::size_t>(mesh_.node_count()));
      ranks::receive(prescribed_);
      number_unknowns(prescribed_, {});
      make_pattern(may_touch_);
      break;
    case Order::assemble: {
      const State<dim> state = receive_state();
      Nodal step_m(dim, mesh_.node_count());
      ranks::receive(step_m);
      constrain(step_m, {});
      std::vector<char> in_contact(mesh_.cells.size());
      ranks::receive(in_contact);
      std::array<Stiffness, 1> stiffness{};
      ranks::receive(stiffness);
      assemble_share(state, stiffness[0], in_contact, {});
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

template <int dim>
std::unique_ptr<ranks::Part> receive_body() {
  std::size_t size = 0;
  ranks::receive(&size, sizeof size);
  std::string bytes(size, '\0');
  ranks::receive(bytes);
  RecordReader record(bytes);
  std::string mesh;
  scene::Material material;
  scene::Kinematics kinematics;
  Numerics numerics;
  record.sized(mesh);
  record(material, kinematics, numerics);
  return std::make_unique<ElasticBody<dim>>(Discretisation<dim>::from_bytes(mesh), material, kinematics,
                                            ranks::threads(), numerics);
}

void follow_first_rank() { ranks::follow_orders({{2, receive_body<2>}, {3, receive_body<3>}}); }

template class ElasticBody<2>;
template class ElasticBody<3>;

}  // namespace touchstone::reference
