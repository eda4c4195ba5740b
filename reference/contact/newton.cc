#include "reference/contact/newton.h"

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

/// Which nodes touch, and which of them slip.
template <int dim>
std::string status_text(const State<dim>& state) {
  std::string text(state.touching.begin(), state.touching.end());
  return text.append(state.slipping.begin(), state.slipping.end());
}

}  // namespace

bool Balance::reached() const noexcept {
  return !status_changes && force.met() && gap.met() && volume.met() && places.met();
}

double Balance::step_tolerance_rel() const noexcept {
  const double away = std::max({force.value, gap.value, places.value, volume.value});
  const double last_step = std::min(force.limit / force.value, volume.limit / volume.value);
  return std::clamp(std::max(0.1 * away, 0.01 * last_step), 1e-10, 1e-2);
}

template <int dim>
Balance NewtonSolver<dim>::update(State<dim>& state, const Forces& forces, int iteration) {
  Balance balance;
  active_set_.measure(state, forces.nodal_n);
  const std::vector<char> before = model_.friction ? state.touching : std::vector<char>();
  const bool late = cycles_ > 0 || iteration > largest_iterations / 2;
  double open_m = active_set_.update(state, late, balance.status_changes);
  if (model_.friction) {
    open_m = std::max(open_m, slipping_.update(state, before, forces.nodal_n, active_set_, iteration,
                                               balance.force.limit, balance.status_changes));
    if (balance.status_changes && !passed_.insert(status_text(state)).second) ++cycles_;
  }
  step_m_.setZero(dim, model_.mesh.node_count());
  for (int node = 0; node < model_.mesh.node_count(); ++node) {
    for (int i = 0; i < dim; ++i) {
      if (!model_.is_prescribed(node, i) || model_.mesh.hangs(node)) continue;
      step_m_(i, node) = model_.prescribed_m(i, node) - state.u_m(i, node);
    }
  }
  const auto [out_of_balance_n, acting_n] = residual(state, forces.nodal_n);
  balance.force.value = out_of_balance_n / std::max(acting_n, model_.smallest_force_n());
  balance.gap.value = open_m / model_.length_m();
  balance.volume.value = forces.volume_error_rel;
  balance.places.value = step_m_.cwiseAbs().maxCoeff() / model_.largest_extent_m;
  return balance;
}

template <int dim>
std::array<double, 2> NewtonSolver<dim>::residual(const State<dim>& state, const Nodal& forces_n) const {
  double sum2_n2 = 0.0, acting_n = 0.0;
  for (int node = 0; node < model_.mesh.node_count(); ++node) {
    if (model_.mesh.hangs(node)) continue;
    Point free = forces_n.col(node), normal = Point::Zero();
    for (int i = 0; i < dim; ++i) {
      if (model_.prescribed[node * dim + i]) {
        acting_n += 0.5 * std::abs(free[i]);
        free[i] = 0.0;
      } else if (state.touching[node]) {
        normal[i] = active_set_.gap(node).gradient[i];
      }
    }
    if (state.touching[node]) {
      acting_n += 0.5 * std::abs(active_set_.force_n(node));
      normal.normalize();
      free -= free.dot(normal) * normal;
      free = slipping_.out_of_balance_n(node, free);
    }
    sum2_n2 += free.squaredNorm();
  }
  return {std::sqrt(sum2_n2), acting_n};
}

template <int dim>
NewtonReport NewtonSolver<dim>::solve(State<dim>& state, const Watch& watch) {
  constexpr int most_indefinite = 12, most_cycles = 4;
  NewtonReport report;
  const auto failed = [&report](const char* trouble) {
    report.trouble = trouble;
    return report;
  };
  Forces forces = body_.forces(state);
  if (!forces.admissible) return failed("the starting state turns an element inside out");
  last_stable_ = true;
  passed_.clear();
  cycles_ = 0;
  if (model_.friction) slipping_.begin_increment(state);
  for (int iteration = 0;; ++iteration) {
    report.iterations = iteration;
    Balance balance = update(state, forces, iteration);
    report.residual_rel = balance.force.value;
    if (watch) watch(iteration, report.residual_rel);
    if (balance.reached()) {
      // A balance whose tangent is indefinite is one the body would leave: a large step can end there, small ones do
      // not.
      if (!model_.friction || !slipping_.begin_sliding(state)) {
        report.converged = last_stable_ && (iteration == 0 || body_.solver().positive_definite(body_.matrix()));
        if (!report.converged) report.trouble = "the balance found is not stable";
        if (model_.friction) slipping_.keep_history(state);
        return report;
      }
      slipping_.update(state, state.touching, forces.nodal_n, active_set_, 0, balance.force.limit,
                       balance.status_changes);
    }
    if (report.indefinite > most_indefinite) return failed("the tangent stays indefinite");
    if (iteration == (model_.friction ? largest_iterations_with_friction : largest_iterations) ||
        cycles_ > most_cycles) {
      if (!balance.status_changes) return failed("the residual stays up");
      return failed(model_.friction ? "the contact area or its sticking part keeps changing"
                                    : "the contact area keeps changing");
    }
    active_set_.eliminate(state, [this](int node) { return slipping_.sticks(node); });
    body_.constrain(step_m_, active_set_.lines(slipping_.stick_m()));
    // In a new load step, and once the contact area changes, an old factor takes longer to correct than a new one to
    // make. A linear body has one tangent.
    const bool linear = !model_.tool && model_.kinematics == scene::Kinematics::small;
    if (balance.status_changes || (iteration == 0 && !linear)) body_.solver().forget();
    Nodal du_m;
    if (!next_step(state, balance.step_tolerance_rel(), report, du_m)) return failed("the tangent is singular");
    if (!du_m.allFinite()) return failed("the displacement is not finite");
    if (!move(state, du_m, forces)) return failed("an element turns inside out");
  }
}

template <int dim>
void NewtonSolver<dim>::assemble(const State<dim>& state, Tangent tangent) {
  // An eliminated component stays in the pattern as an equation of its own, scaled like its neighbours.
  body_.assemble(state, tangent == Tangent::definite ? Stiffness::definite : Stiffness::consistent,
                 active_set_.eliminated(), model_.material.shear_modulus_pa() * model_.length_m(),
                 slipping_.normal_forces());
  if (tangent == Tangent::consistent) {
    // The tangent of -lambda grad g at the touching nodes: -lambda hessian g.
    for (const int node : active_set_.eliminated()) {
      body_.add(node, -active_set_.force_n(node) * active_set_.gap(node).hessian_per_m,
                ContactModel<dim>::Point::Zero());
    }
  }
  slipping_.add_turning(body_);
}

template <int dim>
bool NewtonSolver<dim>::next_step(const State<dim>& state, double tolerance_rel, NewtonReport& report, Nodal& du_m) {
  const bool slips = slipping_.anything_slips();
  for (const Tangent tangent : {Tangent::consistent, Tangent::without_curvature, Tangent::definite}) {
    assemble(state, tangent);
    Eigen::VectorXd solution = body_.right_n();
    // With slip one tangent is solved several times.
    if (slips ? !body_.solver().factorise(body_.matrix())
              : !body_.solver().solve(body_.matrix(), tolerance_rel, solution)) {
      continue;
    }
    // A node on the edge between two facets would leave it; which way is nothing to the body.
    last_stable_ = tangent == Tangent::consistent ||
                   (tangent == Tangent::without_curvature && model_.tool && model_.tool->faceted());
    if (tangent != Tangent::consistent) ++report.indefinite;
    if (slips) {
      solve_with_slip(
          slipping_.coupling(body_, active_set_), [this](Eigen::VectorXd& x) { body_.solver().solve(x); }, solution);
    }
    du_m = body_.displacement_m(solution);
    return true;
  }
  return false;
}

template <int dim>
bool NewtonSolver<dim>::move(State<dim>& state, const Nodal& du_m, Forces& forces) const {
  constexpr int most_halvings = 6;
  const auto dp_pa = body_.pressure_change_pa(du_m);
  const State<dim> before = state;
  double share = 1.0;
  for (int halvings = 0; halvings <= most_halvings; ++halvings, share *= 0.5) {
    state.u_m = before.u_m + share * du_m;
    state.p_pa = before.p_pa + share * dp_pa;
    forces = body_.forces(state);
    if (forces.admissible) return true;
  }
  return false;
}

template class NewtonSolver<2>;
template class NewtonSolver<3>;

}  // namespace touchstone::reference
