// From displacements to nodal forces and the global matrix.
#include "reference/contact/contact_problem.h"
#include "reference/contact/contact_shares.h"
#include "scene/base/stopwatch.h"

#include <algorithm>
#include <thread>

namespace touchstone::reference {
namespace {

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

}  // namespace

template <int dim>
void ContactProblem<dim>::build_pattern() {
  std::vector<std::vector<int>> neighbours(mesh_.node_count());
  std::vector<int> together;
  const std::vector<char> contact_cells = cells_of_nodes(mesh_, contact_nodes_);
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (rank_of_cell_[c] != ranks::own() && !(ranks::first() && contact_cells[c])) continue;
    together.clear();
    for (const int node : mesh_.cells[c]) {
      if (hanging_[node] < 0) {
        together.push_back(node);
      } else {
        for (const auto& [master, weight] : mesh_.hanging[hanging_[node]].masters) together.push_back(master);
      }
    }
    std::sort(together.begin(), together.end());
    together.erase(std::unique(together.begin(), together.end()), together.end());
    for (const int a : together) {
      for (const int b : together) {
        if (b >= a) neighbours[a].push_back(b);
      }
    }
  }
  matrix_.column_begin.assign(1, 0);
  matrix_.row.clear();
  for (int a = 0; a < mesh_.node_count(); ++a) {
    std::sort(neighbours[a].begin(), neighbours[a].end());
    neighbours[a].erase(std::unique(neighbours[a].begin(), neighbours[a].end()), neighbours[a].end());
    for (int i = 0; i < dim; ++i) {
      const int column = unknown_[a * dim + i];
      if (column < 0) continue;
      for (const int b : neighbours[a]) {
        for (int j = 0; j < dim; ++j) {
          if (unknown_[b * dim + j] >= column) matrix_.row.push_back(unknown_[b * dim + j]);
        }
      }
      matrix_.column_begin.push_back(static_cast<std::int64_t>(matrix_.row.size()));
    }
  }
  matrix_.value.assign(matrix_.row.size(), 0.0);
  lanes_.assign(threads_, {std::vector<double>(matrix_.row.size()), std::vector<double>(unknowns_)});
  scratch_.resize(threads_);
}

template <int dim>
typename ContactProblem<dim>::Forces ContactProblem<dim>::forces(const State<dim>& state) const {
  Forces sum = jointly(Order::forces, [&] {
    send(state);
    return forces_of_share(state);
  });
  for (const auto& hanging : mesh_.hanging) {
    for (const auto& [master, weight] : hanging.masters) {
      sum.nodal_n.col(master) += weight * sum.nodal_n.col(hanging.node);
    }
    sum.nodal_n.col(hanging.node).setZero();
  }
  if (dead_force_n_.size() > 0) sum.nodal_n -= dead_force_n_;
  return sum;
}

template <int dim>
typename ContactProblem<dim>::Forces ContactProblem<dim>::forces_of_share(const State<dim>& state) const {
  struct Share {
    Nodal nodal_n;
    double volume_error_rel = 0.0;
    bool admissible = true;
  };
  std::vector<Share> shares(threads_);
  in_lanes(threads_, static_cast<int>(cells_.size()), [&](int lane, int begin, int end) {
    Share& share = shares[lane];
    share.nodal_n = Nodal::Zero(dim, mesh_.node_count());
    CellResult<dim> result;
    typename Element<dim>::Nodal X, u;
    for (int k = begin; k < end && share.admissible; ++k) {
      const int c = cells_[k];
      const auto& cell = mesh_.cells[c];
      for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
        X.col(a) = mesh_.points_m.col(cell[a]);
        u.col(a) = state.u_m.col(cell[a]);
      }
      share.admissible = element_.evaluate(X, u, state.p_pa.col(c), Stiffness::none, result, mesh_.materials_of(c));
      for (int i = 0; i < dim; ++i) {
        for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
          share.nodal_n(i, cell[a]) += result.force_n[i * Mesh<dim>::nodes_per_cell + a];
        }
      }
      share.volume_error_rel =
          std::max(share.volume_error_rel, result.volume_m3.cwiseAbs().maxCoeff() / result.rest_volume_m3);
    }
  });
  Forces sum{Nodal::Zero(dim, mesh_.node_count())};
  for (const Share& share : shares) {
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
typename ContactProblem<dim>::Nodal ContactProblem<dim>::internal_forces(const State<dim>& state) const {
  return forces(state).nodal_n;
}

template <int dim>
void ContactProblem<dim>::expand(int node, int direction, double weight, Expansion& out) const {
  if (hanging_[node] >= 0) {
    for (const auto& [master, share] : mesh_.hanging[hanging_[node]].masters) {
      expand(master, direction, weight * share, out);
    }
    return;
  }
  if (prescribed_[node * dim + direction]) {
    out.offset_m += weight * step_offset_m_(direction, node);
  } else if (eliminated_[node] == all_directions) {
    out.offset_m += weight * stick_m_(direction, node);
  } else if (eliminated_[node] == direction) {
    // n . du = -g, solved for the largest component of n.
    const Gap<dim>& g = gaps_[node];
    const double n_c = g.gradient[direction];
    out.offset_m -= weight * g.value_m / n_c;
    for (int j = 0; j < dim; ++j) {
      if (j == direction) continue;
      if (prescribed_[node * dim + j]) {
        out.offset_m -= weight * g.gradient[j] / n_c * step_offset_m_(j, node);
      } else {
        out.terms.emplace_back(unknown_[node * dim + j], -weight * g.gradient[j] / n_c);
      }
    }
  } else {
    out.terms.emplace_back(unknown_[node * dim + direction], weight);
  }
}

template <int dim>
void ContactProblem<dim>::scatter(const std::vector<std::pair<int, int>>& places, const double* K, const double* f,
                                  Lane& lane, bool with_slip) const {
  // du = T x + offset for the unknowns x that these places depend on: add T' K T and -T' (f + K offset).
  const int n = static_cast<int>(places.size());
  std::vector<Expansion> expansions(n);
  std::vector<int> unknowns;
  for (int r = 0; r < n; ++r) {
    expand(places[r].first, places[r].second, 1.0, expansions[r]);
    for (const auto& [unknown, weight] : expansions[r].terms) unknowns.push_back(unknown);
  }
  std::sort(unknowns.begin(), unknowns.end());
  unknowns.erase(std::unique(unknowns.begin(), unknowns.end()), unknowns.end());
  const int m = static_cast<int>(unknowns.size());
  for (Expansion& expansion : expansions) {
    for (auto& [unknown, weight] : expansion.terms) {
      unknown = static_cast<int>(std::lower_bound(unknowns.begin(), unknowns.end(), unknown) - unknowns.begin());
    }
  }
  using Vector = Eigen::VectorXd;
  const Eigen::Map<const Eigen::MatrixXd> K_in(K, n, n);  // symmetric, so its storage order does not matter
  Vector out_of_balance_n = Eigen::Map<const Vector>(f, n);
  Eigen::MatrixXd KT = Eigen::MatrixXd::Zero(n, m);
  for (int c = 0; c < n; ++c) {
    if (expansions[c].offset_m != 0.0) out_of_balance_n += expansions[c].offset_m * K_in.col(c);
    for (const auto& [column, weight] : expansions[c].terms) KT.col(column) += weight * K_in.col(c);
  }
  Eigen::MatrixXd TKT = Eigen::MatrixXd::Zero(m, m);  // by columns: row r of T' (K T) is column r of its transpose
  const Eigen::MatrixXd KT_transposed = KT.transpose();
  for (int r = 0; r < n; ++r) {
    for (const auto& [row, weight] : expansions[r].terms) {
      TKT.col(row) += weight * KT_transposed.col(r);
      lane.right[unknowns[row]] -= weight * out_of_balance_n[r];
    }
  }
  add_sorted(unknowns.data(), m, TKT.data(), lane);
  if (with_slip) add_slip_rows(places, unknowns, KT, out_of_balance_n, lane);
}

template <int dim>
void ContactProblem<dim>::add_sorted(const int* unknowns, int count, const double* K, Lane& lane) const {
  for (int c = 0; c < count; ++c) {
    // Both lists are sorted: walk them together.
    std::int64_t k = matrix_.column_begin[unknowns[c]];
    for (int r = c; r < count; ++r, ++k) {
      while (matrix_.row[k] < unknowns[r]) ++k;
      lane.value[k] += K[c * count + r];
    }
  }
}

template <int dim>
void ContactProblem<dim>::scatter_plain(const std::array<int, Mesh<dim>::nodes_per_cell>& cell,
                                        const CellResult<dim>& result, Lane& lane) const {
  constexpr int n = CellResult<dim>::unknowns;
  std::array<std::pair<int, int>, n> sorted;  // unknown, local index
  int count = 0;
  for (int i = 0; i < dim; ++i) {
    for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
      const int unknown = unknown_[cell[a] * dim + i];
      if (unknown >= 0) sorted[count++] = {unknown, i * Mesh<dim>::nodes_per_cell + a};
    }
  }
  std::sort(sorted.begin(), sorted.begin() + count);
  std::array<int, n> unknowns;
  std::array<double, n * n> K;
  for (int c = 0; c < count; ++c) {
    unknowns[c] = sorted[c].first;
    lane.right[unknowns[c]] -= result.condensed_force_n[sorted[c].second];
    for (int r = c; r < count; ++r) K[c * count + r] = result.stiffness(sorted[c].second, sorted[r].second);
  }
  add_sorted(unknowns.data(), count, K.data(), lane);
}

template <int dim>
void ContactProblem<dim>::assemble(const State<dim>& state, Stiffness stiffness) {
  in_lanes(threads_, static_cast<int>(tangent_cells_.size()), [&](int number, int begin, int end) {
    Lane& lane = lanes_[number];
    std::fill(lane.value.begin(), lane.value.end(), 0.0);
    std::fill(lane.right.begin(), lane.right.end(), 0.0);
    lane.slip_rows.clear();
    lane.slip_normal_n.assign(slip_rows_, 0.0);
    CellResult<dim>& result = scratch_[number];
    typename Element<dim>::Nodal X, u;
    std::vector<std::pair<int, int>> places(CellResult<dim>::unknowns);
    for (int k = begin; k < end; ++k) {
      const int c = tangent_cells_[k];
      const auto& cell = mesh_.cells[c];
      bool plain = true;
      for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
        X.col(a) = mesh_.points_m.col(cell[a]);
        u.col(a) = state.u_m.col(cell[a]);
        plain = plain && hanging_[cell[a]] < 0 && eliminated_[cell[a]] < 0 && step_offset_m_.col(cell[a]).isZero(0.0);
      }
      element_.evaluate(X, u, state.p_pa.col(c), stiffness, result, mesh_.materials_of(c));
      pressure_gain_[k] = result.pressure_gain;
      pressure_offset_pa_.col(k) = result.pressure_offset_pa;
      if (plain) {
        scatter_plain(cell, result, lane);
        continue;
      }
      for (int i = 0; i < dim; ++i) {
        for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) places[i * Mesh<dim>::nodes_per_cell + a] = {cell[a], i};
      }
      scatter(places, result.stiffness.data(), result.condensed_force_n.data(), lane, slip_rows_ > 0);
    }
  });
  if (dead_force_n_.size() > 0) add_dead_forces();
  // An eliminated component stays in the pattern as an equation of its own, scaled like its neighbours.
  for (const int node : contact_nodes_) {
    if (eliminated_[node] < 0) continue;
    for (int i = 0; i < dim; ++i) {
      const int unknown = unknown_[node * dim + i];
      if (unknown < 0 || (eliminated_[node] != i && eliminated_[node] != all_directions)) continue;
      lanes_[0].value[matrix_.column_begin[unknown]] = material_.shear_modulus_pa() * tool_->half_width_m();
    }
  }
}

template <int dim>
void ContactProblem<dim>::add_dead_forces() {
  Expansion expansion;
  for (int node = 0; node < mesh_.node_count(); ++node) {
    for (int i = 0; i < dim; ++i) {
      if (dead_force_n_(i, node) == 0.0) continue;
      expansion.clear();
      expand(node, i, dead_force_n_(i, node), expansion);
      for (const auto& [unknown, force_n] : expansion.terms) lanes_[0].right[unknown] += force_n;
    }
  }
}

template <int dim>
void ContactProblem<dim>::add_curvature() {
  // The tangent of -lambda grad g at the touching nodes: -lambda hessian g.
  std::vector<std::pair<int, int>> places(dim);
  const Point no_force = Point::Zero();
  for (const int node : contact_nodes_) {
    if (eliminated_[node] < 0) continue;
    for (int i = 0; i < dim; ++i) places[i] = {node, i};
    const Eigen::Matrix<double, dim, dim> K = -lambda_n_[node] * gaps_[node].hessian_per_m;
    scatter(places, K.data(), no_force.data(), lanes_[0]);
  }
}

template <int dim>
Eigen::VectorXd ContactProblem<dim>::sum_of_lanes() {
  matrix_.value = lanes_[0].value;
  Eigen::VectorXd right = Eigen::Map<const Eigen::VectorXd>(lanes_[0].right.data(), unknowns_);
  for (std::size_t lane = 1; lane < lanes_.size(); ++lane) {
    for (std::size_t k = 0; k < matrix_.value.size(); ++k) matrix_.value[k] += lanes_[lane].value[k];
    right += Eigen::Map<const Eigen::VectorXd>(lanes_[lane].right.data(), unknowns_);
  }
  ranks::sum_on_first(right.data(), static_cast<std::size_t>(right.size()));
  return right;
}

template <int dim>
Eigen::VectorXd ContactProblem<dim>::assemble_tangent(const State<dim>& state, Tangent tangent) {
  const scene::CpuTimeAdder watch(assembly_s_);
  if (matrix_.column_begin.empty()) {
    jointly(Order::pattern, [&] {
      ranks::send(prescribed_);
      build_pattern();
    });
    solver_->analyse(matrix_);
  }
  return jointly(Order::assemble, [&] {
    send(state);
    ranks::send(step_offset_m_);
    std::vector<int> eliminated;
    for (const int node : contact_nodes_) {
      if (eliminated_[node] >= 0) eliminated.push_back(node);
    }
    const std::vector<char> in_contact = cells_of_nodes(mesh_, eliminated);
    ranks::send(in_contact);
    take_cells(in_contact);
    const Stiffness stiffness = tangent == Tangent::definite ? Stiffness::definite : Stiffness::consistent;
    ranks::send(std::array{stiffness});
    assemble(state, stiffness);
    if (tangent == Tangent::consistent) add_curvature();
    if (friction_) add_turning();
    return sum_of_lanes();
  });
}

template <int dim>
typename ContactProblem<dim>::Pressures ContactProblem<dim>::pressure_change(const Nodal& du_m) const {
  return jointly(Order::pressures, [&] {
    ranks::send(du_m);
    return pressure_change_of_share(du_m);
  });
}

template <int dim>
typename ContactProblem<dim>::Pressures ContactProblem<dim>::pressure_change_of_share(const Nodal& du_m) const {
  Pressures dp_pa = Pressures::Zero(dim + 1, mesh_.cell_count());
  typename CellResult<dim>::Vector du_cell_m;
  for (std::size_t k = 0; k < tangent_cells_.size(); ++k) {
    for (int i = 0; i < dim; ++i) {
      for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
        du_cell_m[i * Mesh<dim>::nodes_per_cell + a] = du_m(i, mesh_.cells[tangent_cells_[k]][a]);
      }
    }
    dp_pa.col(tangent_cells_[k]) =
        pressure_offset_pa_.col(static_cast<Eigen::Index>(k)) + pressure_gain_[k] * du_cell_m;
  }
  ranks::sum_on_first(dp_pa.data(), static_cast<std::size_t>(dp_pa.size()));
  return dp_pa;
}

template void ContactProblem<2>::assemble(const State<2>&, Stiffness);
template void ContactProblem<2>::add_dead_forces();
template void ContactProblem<2>::add_curvature();
template void ContactProblem<2>::expand(int, int, double, Expansion&) const;
template void ContactProblem<2>::build_pattern();
template ContactProblem<2>::Forces ContactProblem<2>::forces(const State<2>&) const;
template ContactProblem<2>::Forces ContactProblem<2>::forces_of_share(const State<2>&) const;
template Eigen::VectorXd ContactProblem<2>::assemble_tangent(const State<2>&, Tangent);
template Eigen::VectorXd ContactProblem<2>::sum_of_lanes();
template ContactProblem<2>::Pressures ContactProblem<2>::pressure_change(const Nodal&) const;
template ContactProblem<2>::Pressures ContactProblem<2>::pressure_change_of_share(const Nodal&) const;
template ContactProblem<2>::Nodal ContactProblem<2>::internal_forces(const State<2>&) const;
template void ContactProblem<3>::assemble(const State<3>&, Stiffness);
template void ContactProblem<3>::add_dead_forces();
template void ContactProblem<3>::add_curvature();
template void ContactProblem<3>::expand(int, int, double, Expansion&) const;
template void ContactProblem<3>::build_pattern();
template ContactProblem<3>::Forces ContactProblem<3>::forces(const State<3>&) const;
template ContactProblem<3>::Forces ContactProblem<3>::forces_of_share(const State<3>&) const;
template Eigen::VectorXd ContactProblem<3>::assemble_tangent(const State<3>&, Tangent);
template Eigen::VectorXd ContactProblem<3>::sum_of_lanes();
template ContactProblem<3>::Pressures ContactProblem<3>::pressure_change(const Nodal&) const;
template ContactProblem<3>::Pressures ContactProblem<3>::pressure_change_of_share(const Nodal&) const;
template ContactProblem<3>::Nodal ContactProblem<3>::internal_forces(const State<3>&) const;

}  // namespace touchstone::reference
