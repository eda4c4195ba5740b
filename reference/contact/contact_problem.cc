#include "reference/contact/contact_problem.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <set>
#include <stdexcept>

namespace touchstone::reference {
namespace {

/// Which nodes touch, and which of them slip.
template <int dim>
std::string status_text(const State<dim>& state) {
  std::string text(state.touching.begin(), state.touching.end());
  return text.append(state.slipping.begin(), state.slipping.end());
}

}  // namespace

template <int dim>
ContactProblem<dim>::ContactProblem(Discretisation<dim> mesh, const scene::Material& material,
                                    scene::Kinematics kinematics, bool mirror_x, bool mirror_y, int threads,
                                    const Numerics& numerics)
    : body_(std::move(mesh), material, kinematics, threads, numerics),
      mesh_(body_.mesh()),
      material_(material),
      kinematics_(kinematics),
      mirror_x_(mirror_x),
      mirror_y_(mirror_y),
      numerics_(numerics) {
  const int n = mesh_.node_count();
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
  Nodal area_m2 = Nodal::Zero(dim, n);
  const auto face_geometry = mesh_.face_geometry();
  for (std::size_t f = 0; f < mesh_.faces.size(); ++f) {
    const auto& face = mesh_.faces[f];
    if (face.boundary != Boundary::free) continue;
    for (int a = 0; a < Discretisation<dim>::nodes_per_face; ++a) {
      const int node = face.nodes[a];
      const double r_m = mesh_.points_m(0, node);
      area_m2(0, node) += face_geometry[f].weight[a] * (dim == 2 ? 2.0 * std::numbers::pi * r_m : 1.0);
      surface_normal_.col(node) += face_geometry[f].normal.col(a);
      // The node on the axis carries no force: alone it would flip freely, so it follows its neighbour.
      if (dim == 2 && r_m < 1e-9 * largest_extent_m_) axis_partner_[node] = face.nodes[1];
    }
  }
  mesh_.condense(area_m2);
  for (int node = 0; node < n; ++node) area_m2_[node] = area_m2(0, node);
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
    return mesh_.hangs(node) || all_fixed;
  });
  body_.number_unknowns(prescribed_, contact_nodes_);
}

template <int dim>
void ContactProblem<dim>::prescribe(int node, int direction, double displacement_m) {
  prescribed_m_(direction, node) = displacement_m;
  if (prescribed_[node * dim + direction]) return;
  prescribed_[node * dim + direction] = 1;
  body_.number_unknowns(prescribed_, contact_nodes_);
}

template <int dim>
void ContactProblem<dim>::load(Nodal force_n) {
  dead_force_n_ = std::move(force_n);
  mesh_.condense(dead_force_n_);
}

template <int dim>
typename ElasticBody<dim>::Forces ContactProblem<dim>::forces(const State<dim>& state) const {
  auto forces = body_.forces(state);
  if (dead_force_n_.size() > 0) forces.nodal_n -= dead_force_n_;
  return forces;
}

template <int dim>
typename ContactProblem<dim>::Nodal ContactProblem<dim>::internal_forces(const State<dim>& state) const {
  return forces(state).nodal_n;
}

template <int dim>
std::vector<typename ElasticBody<dim>::Line> ContactProblem<dim>::contact_lines() const {
  std::vector<typename ElasticBody<dim>::Line> lines;
  for (const int node : contact_nodes_) {
    const int direction = eliminated_[node];
    for (int i = 0; i < dim; ++i) {
      if (prescribed_[node * dim + i] || (direction != i && direction != all_directions)) continue;
      auto& line = lines.emplace_back();
      line.dof = node * dim + i;
      line.offset_m = direction == all_directions ? stick_m_(i, node) : -gaps_[node].value_m / gaps_[node].gradient[i];
      // n . du = -g, solved for the largest component of n.
      for (int j = 0; j < dim && direction != all_directions; ++j) {
        const double weight = -gaps_[node].gradient[j] / gaps_[node].gradient[i];
        if (j != i && weight != 0.0) line.terms.emplace_back(node * dim + j, weight);
      }
    }
  }
  return lines;
}

template <int dim>
const Eigen::VectorXd& ContactProblem<dim>::assemble_tangent(const State<dim>& state, Tangent tangent) {
  std::vector<int> active;
  std::copy_if(contact_nodes_.begin(), contact_nodes_.end(), std::back_inserter(active),
               [&](int node) { return eliminated_[node] >= 0; });
  // An eliminated component stays in the pattern as an equation of its own, scaled like its neighbours.
  body_.assemble(state, tangent == Tangent::definite ? Stiffness::definite : Stiffness::consistent, active,
                 tool_ ? material_.shear_modulus_pa() * tool_->half_width_m() : 0.0, in_slip_rows());
  if (dead_force_n_.size() > 0) body_.add_load(dead_force_n_);
  if (tangent == Tangent::consistent) {
    // The tangent of -lambda grad g at the touching nodes: -lambda hessian g.
    for (const int node : active) body_.add(node, -lambda_n_[node] * gaps_[node].hessian_per_m, Point::Zero());
  }
  if (friction_) add_turning();
  return body_.right_n();
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
    if (mesh_.hangs(node)) continue;
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

  typename ElasticBody<dim>::Forces current = forces(state);
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
        if (!prescribed_[node * dim + i] || mesh_.hangs(node)) continue;
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
        report.converged = last_stable && (iteration == 0 || body_.solver().positive_definite(body_.matrix()));
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
    body_.constrain(step_offset_m_, contact_lines());
    if (changed || iteration == 0) body_.solver().forget();
    // With slip one tangent is solved several times.
    bool definite = false;
    Eigen::VectorXd solution;
    for (const Tangent tangent : {Tangent::consistent, Tangent::without_curvature, Tangent::definite}) {
      solution = assemble_tangent(state, tangent);
      // With slip one tangent is solved several times.
      definite = slip_rows_ > 0 ? body_.solver().factorise(body_.matrix())
                                : body_.solver().solve(body_.matrix(), tolerance_rel, solution);
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
          slip_coupling(), [this](Eigen::VectorXd& x) { body_.solver().solve(x); }, solution);
    }

    const Nodal du_m = body_.displacement_m(solution);
    const auto dp_pa = body_.pressure_change_pa(du_m);
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
std::vector<Eigen::Matrix<double, dim, Eigen::Dynamic>> ContactProblem<dim>::linear_displacements_m(
    const std::vector<NodeForce>& forces) {
  if (!holds_rest_factor_) {
    body_.constrain(step_offset_m_, {});
    (void)assemble_tangent(rest(), Tangent::consistent);
    if (!body_.solver().factorise(body_.matrix())) throw std::runtime_error("the stiffness at rest is singular");
    holds_rest_factor_ = true;
  }
  const auto count = static_cast<Eigen::Index>(forces.size());
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(unknowns(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const NodeForce& one = forces[static_cast<std::size_t>(k)];
    for (int i = 0; i < dim; ++i) {
      if (const int unknown = body_.unknown(one.node * dim + i); unknown >= 0) x(unknown, k) = one.force_n[i];
    }
  }
  body_.solver().solve_columns(x);
  std::vector<Nodal> displacements_m;
  for (const auto& column : x.colwise()) displacements_m.push_back(body_.displacement_m(column));
  return displacements_m;
}

template class ContactProblem<2>;
template class ContactProblem<3>;

}  // namespace touchstone::reference
