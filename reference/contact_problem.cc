#include "reference/contact_problem.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
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

std::vector<MixedMaterial> mixed(const std::vector<scene::Material>& materials, scene::Kinematics kinematics) {
  std::vector<MixedMaterial> result;
  for (const scene::Material& material : materials) result.emplace_back(material, kinematics);
  return result;
}

/// Weights of the three Gauss-Lobatto points on [0,1], which are the nodes of a quadratic side.
constexpr double simpson[3] = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};

}  // namespace

template <int dim>
ContactProblem<dim>::ContactProblem(Mesh<dim> mesh, const scene::Material& material, scene::Kinematics kinematics,
                                    bool mirror_x, bool mirror_y, int threads)
    : mesh_(std::move(mesh)),
      material_(material),
      kinematics_(kinematics),
      mirror_x_(mirror_x),
      mirror_y_(mirror_y),
      threads_(threads),
      element_(MixedMaterial(material, kinematics), mixed(mesh_.inclusion_materials, kinematics)),
      solver_(threads) {
  const int n = mesh_.node_count();
  hanging_.assign(n, -1);
  for (std::size_t k = 0; k < mesh_.hanging.size(); ++k) hanging_[mesh_.hanging[k].node] = static_cast<int>(k);
  prescribed_.assign(n * dim, 0);
  prescribed_m_ = Nodal::Zero(dim, n);
  step_offset_m_ = Nodal::Zero(dim, n);
  surface_normal_ = Nodal::Zero(dim, n);
  area_m2_.assign(n, 0.0);
  axis_partner_.assign(n, -1);
  eliminated_.assign(n, -1);
  gaps_.resize(n);
  lambda_n_.assign(n, 0.0);
  largest_extent_m_ = (mesh_.points_m.rowwise().maxCoeff() - mesh_.points_m.rowwise().minCoeff()).maxCoeff();

  for (const auto& face : mesh_.faces) {
    for (const int node : face.nodes) {
      for (int i = 0; i < dim; ++i) {
        const bool fixed = face.boundary == Boundary::held || (face.boundary == Boundary::plane_x && i == 0) ||
                           (face.boundary == Boundary::plane_y && i == 1);
        if (fixed) prescribed_[node * dim + i] = 1;
      }
    }
  }
  // Areas and normals of the surface that may touch. Lumping at the nodes keeps every weight positive.
  for (const auto& face : mesh_.faces) {
    if (face.boundary != Boundary::free) continue;
    Eigen::Matrix<double, dim, Mesh<dim>::nodes_per_face> X;
    for (int a = 0; a < Mesh<dim>::nodes_per_face; ++a) X.col(a) = mesh_.points_m.col(face.nodes[a]);
    for (int a = 0; a < Mesh<dim>::nodes_per_face; ++a) {
      Eigen::Matrix<double, dim - 1, 1> xi;
      double weight = 1.0;
      for (int d = 0, index = a; d < dim - 1; ++d, index /= 3) {
        xi[d] = 0.5 * (index % 3);
        weight *= simpson[index % 3];
      }
      const Eigen::Matrix<double, dim, dim - 1> tangents = X * Q2<dim - 1>(xi).gradient;
      Point normal;  // its length is the area per unit of (xi)
      if constexpr (dim == 3) {
        normal = Eigen::Vector3d(tangents.col(0)).cross(Eigen::Vector3d(tangents.col(1)));
      } else {
        normal = Eigen::Vector2d(tangents(1), -tangents(0));
        weight *= 2.0 * std::numbers::pi * X(0, a);
      }
      const int node = face.nodes[a];
      area_m2_[node] += weight * normal.norm();
      surface_normal_.col(node) += normal.normalized();
      if constexpr (dim == 2) {
        // The node on the axis carries no force: alone it would flip freely, so it follows its neighbour.
        const double on_axis_m = 1e-9 * largest_extent_m_;
        if (X(0, a) < on_axis_m) axis_partner_[node] = face.nodes[1];
      }
    }
  }
  for (const auto& hanging : mesh_.hanging) {
    for (const auto& [master, weight] : hanging.masters) area_m2_[master] += weight * area_m2_[hanging.node];
  }
  // Outward is away from the cell behind the face; on convex bodies that is the side away from the nodes' mean.
  const Point middle = mesh_.points_m.rowwise().mean();
  for (const auto& face : mesh_.faces) {
    if (face.boundary != Boundary::free) continue;
    for (const int node : face.nodes) {
      surface_normal_.col(node).normalize();
      if (surface_normal_.col(node).dot(mesh_.points_m.col(node) - middle) < 0.0) surface_normal_.col(node) *= -1.0;
    }
  }
  for (const auto& face : mesh_.faces) {
    if (face.boundary == Boundary::free) {
      contact_nodes_.insert(contact_nodes_.end(), face.nodes.begin(), face.nodes.end());
    }
  }
  std::sort(contact_nodes_.begin(), contact_nodes_.end());
  contact_nodes_.erase(std::unique(contact_nodes_.begin(), contact_nodes_.end()), contact_nodes_.end());
  std::erase_if(contact_nodes_, [&](int node) {
    bool all_fixed = true;
    for (int i = 0; i < dim; ++i) all_fixed = all_fixed && prescribed_[node * dim + i];
    return hanging_[node] >= 0 || all_fixed;
  });
  pressure_gain_.resize(mesh_.cell_count());
  pressure_offset_pa_.resize(dim + 1, mesh_.cell_count());
  number_unknowns();
}

template <int dim>
void ContactProblem<dim>::prescribe(int node, int direction, double displacement_m) {
  prescribed_m_(direction, node) = displacement_m;
  if (prescribed_[node * dim + direction]) return;
  prescribed_[node * dim + direction] = 1;
  number_unknowns();
}

template <int dim>
void ContactProblem<dim>::number_unknowns() {
  unknown_.assign(mesh_.node_count() * dim, -1);
  unknowns_ = 0;
  for (int node = 0; node < mesh_.node_count(); ++node) {
    if (hanging_[node] >= 0) continue;
    for (int i = 0; i < dim; ++i) {
      if (!prescribed_[node * dim + i]) unknown_[node * dim + i] = unknowns_++;
    }
  }
  matrix_ = {};
}

template <int dim>
void ContactProblem<dim>::build_pattern() {
  std::vector<std::vector<int>> neighbours(mesh_.node_count());
  std::vector<int> together;
  for (const auto& cell : mesh_.cells) {
    together.clear();
    for (const int node : cell) {
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
  solver_.analyse(matrix_);
}

template <int dim>
State<dim> ContactProblem<dim>::rest() const {
  return {Nodal::Zero(dim, mesh_.node_count()),
          Eigen::Matrix<double, dim + 1, Eigen::Dynamic>::Zero(dim + 1, mesh_.cell_count()),
          std::vector<char>(mesh_.node_count(), 0)};
}

template <int dim>
typename ContactProblem<dim>::Forces ContactProblem<dim>::forces(const State<dim>& state) const {
  struct Share {
    Nodal nodal_n;
    double volume_error_rel = 0.0;
    bool admissible = true;
  };
  std::vector<Share> shares(threads_);
  in_lanes(threads_, mesh_.cell_count(), [&](int lane, int begin, int end) {
    Share& share = shares[lane];
    share.nodal_n = Nodal::Zero(dim, mesh_.node_count());
    CellResult<dim> result;
    typename Element<dim>::Nodal X, u;
    for (int c = begin; c < end && share.admissible; ++c) {
      const auto& cell = mesh_.cells[c];
      for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
        X.col(a) = mesh_.points_m.col(cell[a]);
        u.col(a) = state.u_m.col(cell[a]);
      }
      share.admissible = element_.evaluate(X, u, state.p_pa.col(c), false, result, mesh_.materials_of(c));
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
  for (const auto& hanging : mesh_.hanging) {
    for (const auto& [master, weight] : hanging.masters) {
      sum.nodal_n.col(master) += weight * sum.nodal_n.col(hanging.node);
    }
    sum.nodal_n.col(hanging.node).setZero();
  }
  return sum;
}

template <int dim>
typename ContactProblem<dim>::Nodal ContactProblem<dim>::internal_forces(const State<dim>& state) const {
  return forces(state).nodal_n;
}

template <int dim>
Gap<dim> ContactProblem<dim>::gap(const State<dim>& state, int node) const {
  const Point X = mesh_.points_m.col(node), u = state.u_m.col(node);
  return kinematics_ == scene::Kinematics::finite ? tool_->gap(X + u)
                                                  : tool_->gap_along(X, surface_normal_.col(node), u);
}

template <int dim>
bool ContactProblem<dim>::tool_reaches_rest_surface() const {
  const State<dim> at_rest = rest();
  return std::any_of(contact_nodes_.begin(), contact_nodes_.end(),
                     [&](int node) { return gap(at_rest, node).value_m < 0.0; });
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
                                  Lane& lane) const {
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
void ContactProblem<dim>::assemble(const State<dim>& state) {
  if (matrix_.column_begin.empty()) build_pattern();
  in_lanes(threads_, mesh_.cell_count(), [&](int number, int begin, int end) {
    Lane& lane = lanes_[number];
    std::fill(lane.value.begin(), lane.value.end(), 0.0);
    std::fill(lane.right.begin(), lane.right.end(), 0.0);
    CellResult<dim>& result = scratch_[number];
    typename Element<dim>::Nodal X, u;
    std::vector<std::pair<int, int>> places(CellResult<dim>::unknowns);
    for (int c = begin; c < end; ++c) {
      const auto& cell = mesh_.cells[c];
      bool plain = true;
      for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
        X.col(a) = mesh_.points_m.col(cell[a]);
        u.col(a) = state.u_m.col(cell[a]);
        plain = plain && hanging_[cell[a]] < 0 && eliminated_[cell[a]] < 0 && step_offset_m_.col(cell[a]).isZero(0.0);
      }
      element_.evaluate(X, u, state.p_pa.col(c), true, result, mesh_.materials_of(c));
      pressure_gain_[c] = result.pressure_gain;
      pressure_offset_pa_.col(c) = result.pressure_offset_pa;
      if (plain) {
        scatter_plain(cell, result, lane);
        continue;
      }
      for (int i = 0; i < dim; ++i) {
        for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) places[i * Mesh<dim>::nodes_per_cell + a] = {cell[a], i};
      }
      scatter(places, result.stiffness.data(), result.condensed_force_n.data(), lane);
    }
  });
  // An eliminated component stays in the pattern as an equation of its own, scaled like its neighbours.
  for (const int node : contact_nodes_) {
    if (eliminated_[node] < 0) continue;
    const int unknown = unknown_[node * dim + eliminated_[node]];
    lanes_[0].value[matrix_.column_begin[unknown]] = material_.shear_modulus_pa() * tool_->radius_m;
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
double ContactProblem<dim>::update_touching(State<dim>& state, int iteration, bool& changed) const {
  changed = false;
  double open_m = 0.0;
  if (!tool_) return open_m;
  const double c_pa_per_m = material_.youngs_modulus_pa / tool_->radius_m;
  double largest_pa = 0.0;
  for (const int node : contact_nodes_) {
    if (area_m2_[node] > 0.0) largest_pa = std::max(largest_pa, lambda_n_[node] / area_m2_[node]);
  }
  // A node exactly on the contact's edge may flip between two equal answers. Late in the solve it is let go only when
  // it pulls noticeably.
  const double tolerated_pull_pa = iteration > largest_iterations / 2 ? 1e-5 * largest_pa : 0.0;
  std::vector<char> next(state.touching.size(), 0);
  for (const int node : contact_nodes_) {
    const double g_m = gaps_[node].value_m;
    const bool touches =
        state.touching[node] ? lambda_n_[node] / area_m2_[node] - c_pa_per_m * g_m > -tolerated_pull_pa : g_m < 0.0;
    next[node] = touches ? 1 : 0;
  }
  if constexpr (dim == 2) {
    for (const int node : contact_nodes_) {
      if (axis_partner_[node] >= 0) next[node] = next[axis_partner_[node]];
    }
  }
  for (const int node : contact_nodes_) {
    changed = changed || next[node] != state.touching[node];
    if (next[node]) open_m = std::max(open_m, std::abs(gaps_[node].value_m));
  }
  state.touching = std::move(next);
  return open_m;
}

template <int dim>
std::array<double, 2> ContactProblem<dim>::residual(const State<dim>& state, const Nodal& forces_n) const {
  double sum2_n2 = 0.0, acting_n = 0.0;
  for (int node = 0; node < mesh_.node_count(); ++node) {
    if (hanging_[node] >= 0) continue;
    Point free = forces_n.col(node), normal = Point::Zero();
    for (int i = 0; i < dim; ++i) {
      if (prescribed_[node * dim + i]) {
        acting_n += 0.5 * std::abs(free[i]);
        free[i] = 0.0;
      } else if (state.touching[node]) {
        normal[i] = gaps_[node].gradient[i];
      }
    }
    if (state.touching[node]) {
      acting_n += 0.5 * std::abs(lambda_n_[node]);
      normal.normalize();
      free -= free.dot(normal) * normal;
    }
    sum2_n2 += free.squaredNorm();
  }
  return {std::sqrt(sum2_n2), acting_n};
}

template <int dim>
NewtonReport ContactProblem<dim>::solve(State<dim>& state, const Watch& watch) {
  NewtonReport report;
  const double length_m = tool_ ? tool_->radius_m : largest_extent_m_;
  const double smallest_scale_n = 1e-10 * material_.shear_modulus_pa() * length_m * length_m;
  constexpr double volume_tolerance = 1e-9, gap_tolerance = 1e-10, place_tolerance = 1e-12;
  constexpr int most_indefinite = 3;
  bool last_definite = true;

  Forces current = forces(state);
  if (!current.admissible) {
    report.trouble = "the starting state turns an element inside out";
    return report;
  }
  for (int iteration = 0;; ++iteration) {
    report.iterations = iteration;
    if (tool_) {
      for (const int node : contact_nodes_) {
        gaps_[node] = gap(state, node);
        double normal2 = 0.0;
        lambda_n_[node] = 0.0;
        for (int i = 0; i < dim && state.touching[node]; ++i) {
          if (prescribed_[node * dim + i]) continue;
          lambda_n_[node] += gaps_[node].gradient[i] * current.nodal_n(i, node);
          normal2 += gaps_[node].gradient[i] * gaps_[node].gradient[i];
        }
        if (normal2 > 0.0) lambda_n_[node] /= normal2;
      }
    }
    bool changed = false;
    const double open_m = update_touching(state, iteration, changed);
    double still_to_move_m = 0.0;
    for (int node = 0; node < mesh_.node_count(); ++node) {
      for (int i = 0; i < dim; ++i) {
        if (!prescribed_[node * dim + i] || hanging_[node] >= 0) continue;
        step_offset_m_(i, node) = prescribed_m_(i, node) - state.u_m(i, node);
        still_to_move_m = std::max(still_to_move_m, std::abs(step_offset_m_(i, node)));
      }
    }
    const auto [out_of_balance_n, acting_n] = residual(state, current.nodal_n);
    report.residual_rel = out_of_balance_n / std::max(acting_n, smallest_scale_n);
    if (watch) watch(iteration, report.residual_rel);
    if (!changed && report.residual_rel < force_tolerance && open_m < gap_tolerance * length_m &&
        current.volume_error_rel < volume_tolerance && still_to_move_m <= place_tolerance * largest_extent_m_) {
      // A balance whose tangent is indefinite is one the body would leave: a large step can end there, small ones do
      // not.
      report.converged = last_definite;
      if (!last_definite) report.trouble = "the balance found is not stable";
      return report;
    }
    if (report.indefinite > most_indefinite) {
      report.trouble = "the tangent stays indefinite";
      return report;
    }
    if (iteration == largest_iterations) {
      report.trouble = changed ? "the contact area keeps changing" : "the residual stays up";
      return report;
    }

    for (const int node : contact_nodes_) {
      eliminated_[node] = -1;
      if (!state.touching[node]) continue;
      double largest = 0.0;
      for (int i = 0; i < dim; ++i) {
        if (prescribed_[node * dim + i] || std::abs(gaps_[node].gradient[i]) <= largest) continue;
        largest = std::abs(gaps_[node].gradient[i]);
        eliminated_[node] = i;
      }
    }
    std::vector<double> solution;
    const auto combine = [&](bool with_curvature) {
      assemble(state);
      if (with_curvature) add_curvature();
      matrix_.value = lanes_[0].value;
      solution = lanes_[0].right;
      for (std::size_t lane = 1; lane < lanes_.size(); ++lane) {
        for (std::size_t k = 0; k < matrix_.value.size(); ++k) matrix_.value[k] += lanes_[lane].value[k];
        for (int k = 0; k < unknowns_; ++k) solution[k] += lanes_[lane].right[k];
      }
    };
    // The curvature of the tool lowers the tangent. Where that makes it indefinite, Newton does without for one
    // iteration; a body that is itself unstable is left to an indifferent but slow solver.
    combine(true);
    bool definite = last_definite = solver_.factorise(matrix_);
    if (!definite) {
      ++report.indefinite;
      combine(false);
      definite = solver_.factorise(matrix_);
    }
    if (definite) {
      solver_.solve(solution);
    } else if (!CholmodSolver::solve_indefinite(matrix_, solution)) {
      report.trouble = "the tangent is singular";
      return report;
    }

    Nodal du_m(dim, mesh_.node_count());
    Expansion expansion;
    for (int node = 0; node < mesh_.node_count(); ++node) {
      for (int i = 0; i < dim; ++i) {
        expansion.clear();
        expand(node, i, 1.0, expansion);
        du_m(i, node) = expansion.offset_m;
        for (const auto& [unknown, weight] : expansion.terms) du_m(i, node) += weight * solution[unknown];
      }
    }
    Eigen::Matrix<double, dim + 1, Eigen::Dynamic> dp_pa(dim + 1, mesh_.cell_count());
    typename CellResult<dim>::Vector du_cell_m;
    for (int c = 0; c < mesh_.cell_count(); ++c) {
      for (int i = 0; i < dim; ++i) {
        for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
          du_cell_m[i * Mesh<dim>::nodes_per_cell + a] = du_m(i, mesh_.cells[c][a]);
        }
      }
      dp_pa.col(c) = pressure_offset_pa_.col(c) + pressure_gain_[c] * du_cell_m;
    }
    if (!du_m.allFinite()) {
      report.trouble = "the displacement is not finite";
      return report;
    }
    // Shorten the step only as far as every element stays admissible.
    const State<dim> before = state;
    double share = 1.0;
    for (int halvings = 0;; ++halvings, share *= 0.5) {
      state.u_m = before.u_m + share * du_m;
      state.p_pa = before.p_pa + share * dp_pa;
      current = forces(state);
      if (current.admissible) break;
      if (halvings == 6) {
        report.trouble = "an element turns inside out";
        return report;
      }
    }
  }
}

template <int dim>
Observation ContactProblem<dim>::observe(const State<dim>& state) const {
  Observation seen;
  const Nodal F = forces(state).nodal_n;
  const double images = (mirror_x_ ? 2.0 : 1.0) * (mirror_y_ ? 2.0 : 1.0);
  // A mirror image doubles what lies in the mirror's plane and cancels what does not.
  const auto with_images = [&](Point part) {
    scene::Vec3 whole = scene::Vec3::Zero();
    if constexpr (dim == 2) {
      whole.z() = part[1];
    } else {
      whole = images * part;
      if (mirror_x_) whole.x() = 0.0;
      if (mirror_y_) whole.y() = 0.0;
    }
    return whole;
  };

  Point support = Point::Zero();
  std::vector<char> held(mesh_.node_count(), 0);
  for (const auto& face : mesh_.faces) {
    if (face.boundary != Boundary::held) continue;
    for (const int node : face.nodes) held[node] = 1;
  }
  for (int node = 0; node < mesh_.node_count(); ++node) {
    if (held[node]) support += F.col(node);
  }
  seen.support_force_n = with_images(support);

  double change_m3 = 0.0, rest_m3 = 0.0;
  {
    CellResult<dim> result;
    typename Element<dim>::Nodal X, u;
    for (int c = 0; c < mesh_.cell_count(); ++c) {
      for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
        X.col(a) = mesh_.points_m.col(mesh_.cells[c][a]);
        u.col(a) = state.u_m.col(mesh_.cells[c][a]);
      }
      element_.evaluate(X, u, state.p_pa.col(c), false, result, mesh_.materials_of(c));
      change_m3 += result.volume_change_m3;
      rest_m3 += result.rest_volume_m3;
    }
  }
  seen.volume_change_rel = change_m3 / rest_m3;
  if (!tool_) return seen;

  // Contact forces lambda grad g act on the body; the tool gets their opposite.
  Point force = Point::Zero();
  scene::Vec3 torque = scene::Vec3::Zero();
  double touching_area_m2 = 0.0;
  std::vector<double> pressure_pa(mesh_.node_count(), 0.0);
  std::vector<double> opening_m(mesh_.node_count(), std::numeric_limits<double>::infinity());
  for (const int node : contact_nodes_) {
    const Gap<dim> g = gap(state, node);
    opening_m[node] = g.value_m;
    seen.node_penetration_m = std::max(seen.node_penetration_m, -g.value_m);
    if (!state.touching[node]) continue;
    Point normal = g.gradient;
    for (int i = 0; i < dim; ++i) {
      if (prescribed_[node * dim + i]) normal[i] = 0.0;
    }
    const double lambda_n = F.col(node).dot(normal) / normal.squaredNorm();
    const Point on_tool_n = -lambda_n * g.gradient;
    force += on_tool_n;
    if constexpr (dim == 3) {
      torque += scene::Vec3(mesh_.points_m.col(node) + state.u_m.col(node) - tool_->center_m).cross(on_tool_n);
    }
    touching_area_m2 += area_m2_[node];
    if (area_m2_[node] > 0.0) pressure_pa[node] = lambda_n / area_m2_[node];
  }
  seen.force_n = with_images(force);
  if constexpr (dim == 3) {
    // Torque is a pseudo-vector: mirrored in x = 0 only its x component survives.
    seen.torque_nm = images * torque;
    if (mirror_x_) seen.torque_nm.y() = seen.torque_nm.z() = 0.0;
    if (mirror_y_) seen.torque_nm.x() = seen.torque_nm.z() = 0.0;
  }
  const double force_n = seen.force_n.norm();
  seen.equilibrium_rel = force_n > 0.0 ? (seen.support_force_n - seen.force_n).norm() / force_n : 0.0;

  // Contact area. The edge is placed between nodes with the field that any frictionless contact has at its edge:
  // pressure A sqrt(s) inside and opening (4 A / 3 E*) s^(3/2) outside, s the distance from the edge (the half-plane
  // solution; K. L. Johnson, Contact Mechanics (1985), 5.1). A is Hertz's, (2 E* / pi R) sqrt(2 a); only the ratio of
  // the two sides matters. The nodal field s, positive inside, is then cut linearly on the deformed surface.
  const double E_star_pa = material_.contact_modulus_pa();
  const double a_m = std::sqrt(images * touching_area_m2 / std::numbers::pi);
  const double A = 2.0 * E_star_pa / (std::numbers::pi * tool_->radius_m) * std::sqrt(2.0 * a_m);
  std::vector<double> s(mesh_.node_count(), -std::numeric_limits<double>::max());
  for (const int node : contact_nodes_) {
    if (state.touching[node]) {
      s[node] = pressure_pa[node] > 0.0 ? (pressure_pa[node] / A) * (pressure_pa[node] / A) : 0.0;
    } else if (A > 0.0 && std::isfinite(opening_m[node])) {
      s[node] = -std::pow(0.75 * E_star_pa * std::max(opening_m[node], 0.0) / A, 2.0 / 3.0);
    }
  }
  for (const auto& hanging : mesh_.hanging) {
    s[hanging.node] = 0.0;
    for (const auto& [master, weight] : hanging.masters) s[hanging.node] += weight * s[master];
  }
  if constexpr (dim == 2) {
    for (const int node : contact_nodes_) {
      if (axis_partner_[node] >= 0 && state.touching[node]) s[node] = s[axis_partner_[node]];
    }
  }
  const bool finite = kinematics_ == scene::Kinematics::finite;
  const auto place = [&](int node) -> Point {
    return finite ? Point(mesh_.points_m.col(node) + state.u_m.col(node)) : Point(mesh_.points_m.col(node));
  };
  const GaussRule<dim - 1> rule;
  for (const auto& face : mesh_.faces) {
    if (face.boundary != Boundary::free) continue;
    const bool touched = std::any_of(face.nodes.begin(), face.nodes.end(), [&](int n) { return s[n] > 0.0; });
    if (!touched) continue;
    if constexpr (dim == 2) {
      for (int k = 0; k < 2; ++k) {
        Point x0 = place(face.nodes[k]), x1 = place(face.nodes[k + 1]);
        const double s0 = s[face.nodes[k]], s1 = s[face.nodes[k + 1]];
        if (s0 <= 0.0 && s1 <= 0.0) continue;
        if (s0 * s1 < 0.0) (s0 < 0.0 ? x0 : x1) = x0 + s0 / (s0 - s1) * (x1 - x0);
        seen.area_m2 += std::numbers::pi * (x0[0] + x1[0]) * (x1 - x0).norm();
        seen.contact_radius_m = std::max({seen.contact_radius_m, x0[0], x1[0]});
      }
    } else {
      // Four quarters, each cut along either diagonal and averaged, which keeps mirror images equal; of each triangle
      // the part with s > 0.
      for (const int corner : {0, 1, 3, 4}) {
        const int c00 = corner, c10 = corner + 1, c01 = corner + 3, c11 = corner + 4;
        const int triangles[4][3] = {{c00, c10, c11}, {c00, c11, c01}, {c00, c10, c01}, {c10, c11, c01}};
        for (const auto& triangle : triangles) {
          std::vector<Point> polygon;
          for (int k = 0; k < 3; ++k) {
            const int from = face.nodes[triangle[k]], to = face.nodes[triangle[(k + 1) % 3]];
            if (s[from] > 0.0) polygon.push_back(place(from));
            if ((s[from] > 0.0) != (s[to] > 0.0)) {
              polygon.push_back(place(from) + s[from] / (s[from] - s[to]) * (place(to) - place(from)));
            }
          }
          for (std::size_t k = 2; k < polygon.size(); ++k) {
            const Eigen::Vector3d side1 = polygon[k - 1] - polygon[0], side2 = polygon[k] - polygon[0];
            seen.area_m2 += 0.5 * images * 0.5 * side1.cross(side2).norm();
          }
        }
      }
    }
    // Penetration where nothing enforces contact.
    for (int q = 0; q < GaussRule<dim - 1>::size; ++q) {
      const Q2<dim - 1> shape(rule.points[q]);
      Point X = Point::Zero(), u = Point::Zero(), N = Point::Zero();
      for (int a = 0; a < Mesh<dim>::nodes_per_face; ++a) {
        X += shape.value[a] * mesh_.points_m.col(face.nodes[a]);
        u += shape.value[a] * state.u_m.col(face.nodes[a]);
        N += shape.value[a] * surface_normal_.col(face.nodes[a]);
      }
      const Gap<dim> g = finite ? tool_->gap(X + u) : tool_->gap_along(X, N.normalized(), u);
      seen.between_nodes_penetration_m = std::max(seen.between_nodes_penetration_m, -g.value_m);
    }
  }
  for (const auto& hanging : mesh_.hanging) {
    if (surface_normal_.col(hanging.node).isZero(0.0)) continue;
    seen.between_nodes_penetration_m = std::max(seen.between_nodes_penetration_m, -gap(state, hanging.node).value_m);
  }
  return seen;
}

template class ContactProblem<2>;
template class ContactProblem<3>;

}  // namespace touchstone::reference
