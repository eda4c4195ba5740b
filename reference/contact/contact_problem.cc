#include "reference/contact/contact_problem.h"

#include "reference/contact/contact_shares.h"
#include "scene/base/stopwatch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>

namespace touchstone::reference {
namespace {

std::vector<MixedMaterial> mixed(const std::vector<scene::Material>& materials, scene::Kinematics kinematics) {
  std::vector<MixedMaterial> result;
  for (const scene::Material& material : materials) result.emplace_back(material, kinematics);
  return result;
}

/// Which nodes touch, and which of them slip.
template <int dim>
std::string status_text(const State<dim>& state) {
  std::string text(state.touching.begin(), state.touching.end());
  return text.append(state.slipping.begin(), state.slipping.end());
}

/// Weights of the three Gauss-Lobatto points on [0,1], which are the nodes of a quadratic side.
constexpr double simpson[3] = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};

}  // namespace

template <int dim>
ContactProblem<dim>::ContactProblem(Mesh<dim> mesh, const scene::Material& material, scene::Kinematics kinematics,
                                    bool mirror_x, bool mirror_y, int threads, const Numerics& numerics)
    : mesh_(std::move(mesh)),
      material_(material),
      kinematics_(kinematics),
      mirror_x_(mirror_x),
      mirror_y_(mirror_y),
      threads_(threads),
      numerics_(numerics),
      element_(MixedMaterial(material, kinematics), mixed(mesh_.inclusion_materials, kinematics),
               numerics.numerical_bulk),
      lead_(make_parts()),
      solver_(make_solver()) {
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
  // Areas and normals of the surface that may touch. Lumping at the nodes keeps every weight positive. Outward is away
  // from the nodes' mean, which is inside a convex body; neighbouring faces may run opposite ways.
  const Point middle_m = mesh_.points_m.rowwise().mean();
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
      surface_normal_.col(node) += normal.dot(X.col(a) - middle_m) < 0.0 ? -normal.normalized() : normal.normalized();
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
  for (auto normal : surface_normal_.colwise()) {
    if (!normal.isZero(0.0)) normal.normalize();
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
  rank_of_cell_ = ranks_of_cells(mesh_, ranks::count());
  for (int c = 0; c < mesh_.cell_count(); ++c) {
    if (rank_of_cell_[c] == ranks::own()) cells_.push_back(c);
  }
  number_unknowns();
}

template <int dim>
ContactProblem<dim>::~ContactProblem() {
  lead_.reset();  // the solvers of all ranks end together
}

template <int dim>
void ContactProblem<dim>::prescribe(int node, int direction, double displacement_m) {
  prescribed_m_(direction, node) = displacement_m;
  if (prescribed_[node * dim + direction]) return;
  prescribed_[node * dim + direction] = 1;
  number_unknowns();
}

template <int dim>
void ContactProblem<dim>::load(Nodal force_n) {
  dead_force_n_ = std::move(force_n);
  for (const auto& hanging : mesh_.hanging) {
    for (const auto& [master, weight] : hanging.masters) {
      dead_force_n_.col(master) += weight * dead_force_n_.col(hanging.node);
    }
    dead_force_n_.col(hanging.node).setZero();
  }
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
State<dim> ContactProblem<dim>::rest() const {
  return {Nodal::Zero(dim, mesh_.node_count()),
          Eigen::Matrix<double, dim + 1, Eigen::Dynamic>::Zero(dim + 1, mesh_.cell_count()),
          std::vector<char>(mesh_.node_count(), 0)};
}

template <int dim>
Gap<dim> ContactProblem<dim>::gap(const State<dim>& state, int node) const {
  const Point X = mesh_.points_m.col(node), u = state.u_m.col(node);
  return kinematics_ == scene::Kinematics::finite ? tool_->gap(X + u)
                                                  : tool_->gap_along(X, surface_normal_.col(node), u);
}

template <int dim>
double ContactProblem<dim>::update_touching(State<dim>& state, bool late, bool& changed) const {
  changed = false;
  double open_m = 0.0;
  if (!tool_) return open_m;
  const double c_pa_per_m = numerics_.contact_parameter * material_.youngs_modulus_pa / tool_->half_width_m();
  double largest_pa = 0.0;
  for (const int node : contact_nodes_) {
    if (area_m2_[node] > 0.0) largest_pa = std::max(largest_pa, lambda_n_[node] / area_m2_[node]);
  }
  // A node exactly on the contact's edge may flip between two equal answers. Late in the solve it is let go only when
  // it pulls noticeably.
  const double tolerated_pull_pa = late ? 1e-5 * largest_pa : 0.0;
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
      if (friction_ && contact_of_[node] >= 0) {
        const NodeContact<dim>& contact = contacts_[contact_of_[node]];
        if (contact.slips) {
          free -= contact.coefficient * std::max(contact.normal_n, 0.0) * slips_[contact_of_[node]].direction;
        } else {
          free.setZero();
        }
      }
    }
    sum2_n2 += free.squaredNorm();
  }
  return {std::sqrt(sum2_n2), acting_n};
}

template <int dim>
NewtonReport ContactProblem<dim>::solve(State<dim>& state, const Watch& watch) {
  NewtonReport report;
  const double length_m = tool_ ? tool_->half_width_m() : largest_extent_m_;
  const double smallest_scale_n = 1e-10 * material_.shear_modulus_pa() * length_m * length_m;
  constexpr double volume_tolerance = 1e-9, gap_tolerance = 1e-10, place_tolerance = 1e-12;
  constexpr int most_indefinite = 12;
  const int most_iterations = friction_ ? largest_iterations_with_friction : largest_iterations;
  bool last_stable = true;

  Forces current = forces(state);
  if (!current.admissible) {
    report.trouble = "the starting state turns an element inside out";
    return report;
  }
  // With friction the nodes' status may come round again and again.
  constexpr int most_cycles = 4;
  int cycles = 0;
  std::set<std::string> passed;
  if (friction_) begin_increment(state);
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
    const std::vector<char> before_touching = friction_ ? state.touching : std::vector<char>();
    double open_m = update_touching(state, cycles > 0 || iteration > largest_iterations / 2, changed);
    if (friction_) {
      open_m = std::max(open_m, update_slipping(state, before_touching, current.nodal_n, iteration, changed));
      if (changed && !passed.insert(status_text(state)).second) ++cycles;
    }
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
      if (!friction_ || !begin_sliding(state)) {
        report.converged = last_stable && (iteration == 0 || solver_->positive_definite(matrix_));
        if (!report.converged) report.trouble = "the balance found is not stable";
        if (friction_) keep_history(state);
        return report;
      }
      update_slipping(state, state.touching, current.nodal_n, 0, changed);
    }
    if (report.indefinite > most_indefinite) {
      report.trouble = "the tangent stays indefinite";
      return report;
    }
    if (iteration == most_iterations || cycles > most_cycles) {
      report.trouble = changed ? (friction_ ? "the contact area or its sticking part keeps changing"
                                            : "the contact area keeps changing")
                               : "the residual stays up";
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
      if (friction_ && contact_of_[node] >= 0 && !contacts_[contact_of_[node]].slips) {
        eliminated_[node] = all_directions;
      }
    }
    // The step is solved for no more exactly than it is worth, nor than the last one must be: S. C. Eisenstat, H. F.
    // Walker, SIAM J. Sci. Comput. 17 (1996) 16-32. In a new load step, and once the contact area changes, an old
    // factor takes longer to correct than a new one to make.
    const double away_rel = std::max(
        {report.residual_rel, open_m / length_m, still_to_move_m / largest_extent_m_, current.volume_error_rel});
    const double last_step_rel =
        std::min(force_tolerance / report.residual_rel, volume_tolerance / current.volume_error_rel);
    const double tolerance_rel = std::clamp(std::max(0.1 * away_rel, 0.01 * last_step_rel), 1e-10, 1e-2);
    if (changed || iteration == 0) solver_->forget();
    // With slip one tangent is solved several times.
    bool definite = false;
    Eigen::VectorXd solution;
    for (const Tangent tangent : {Tangent::consistent, Tangent::without_curvature, Tangent::definite}) {
      solution = assemble_tangent(state, tangent);
      // With slip one tangent is solved several times.
      definite = slip_rows_ > 0 ? solver_->factorise(matrix_) : solver_->solve(matrix_, tolerance_rel, solution);
      if (!definite) continue;
      // A node on the edge between two facets would leave it; which way is nothing to the body.
      last_stable =
          tangent == Tangent::consistent || (tangent == Tangent::without_curvature && tool_ && tool_->faceted());
      if (tangent != Tangent::consistent) ++report.indefinite;
      break;
    }
    if (!definite) {
      report.trouble = "the tangent is singular";
      return report;
    }
    if (slip_rows_ > 0) {
      solve_with_slip(
          slip_coupling(), [this](Eigen::VectorXd& x) { solver_->solve(x); }, solution);
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
    const Pressures dp_pa = pressure_change(du_m);
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
      {
        const scene::CpuTimeAdder watch_forces(assembly_s_);
        current = forces(state);
      }
      if (current.admissible) break;
      if (halvings == 6) {
        report.trouble = "an element turns inside out";
        return report;
      }
    }
  }
}

template <int dim>
std::vector<Eigen::Matrix<double, dim, Eigen::Dynamic>> ContactProblem<dim>::linear_displacements_m(
    const std::vector<NodeForce>& forces) {
  if (!holds_rest_factor_) {
    (void)assemble_tangent(rest(), Tangent::consistent);
    if (!solver_->factorise(matrix_)) throw std::runtime_error("the stiffness at rest is singular");
    holds_rest_factor_ = true;
  }
  const auto count = static_cast<Eigen::Index>(forces.size());
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(unknowns_, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const NodeForce& one = forces[static_cast<std::size_t>(k)];
    for (int i = 0; i < dim; ++i) {
      if (const int unknown = unknown_[one.node * dim + i]; unknown >= 0) x(unknown, k) = one.force_n[i];
    }
  }
  solver_->solve_columns(x);
  std::vector<Nodal> displacements_m(forces.size(), Nodal::Zero(dim, mesh_.node_count()));
  for (Eigen::Index k = 0; k < count; ++k) {
    Nodal& u_m = displacements_m[static_cast<std::size_t>(k)];
    for (int node = 0; node < mesh_.node_count(); ++node) {
      for (int i = 0; i < dim; ++i) {
        if (const int unknown = unknown_[node * dim + i]; unknown >= 0) u_m(i, node) = x(unknown, k);
      }
    }
    for (const auto& hanging : mesh_.hanging) {
      for (const auto& [master, weight] : hanging.masters) u_m.col(hanging.node) += weight * u_m.col(master);
    }
  }
  return displacements_m;
}

template class ContactProblem<2>;
template class ContactProblem<3>;

}  // namespace touchstone::reference
