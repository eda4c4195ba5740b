// Newton's method on the balance of a body in contact.
#pragma once

#include "reference/contact/active_set.h"
#include "reference/contact/contact_model.h"
#include "reference/contact/elastic_body.h"
#include "reference/contact/slipping.h"

#include <array>
#include <functional>
#include <set>
#include <string>

namespace touchstone::reference {

/// Tangents of Newton's method; each replaces the one before where that is not positive definite.
enum class Tangent {
  consistent,
  without_curvature,  ///< of the tool, whose curvature may make the tangent indefinite
  definite,           ///< also without the terms that make the body itself unstable, see Stiffness
};

/// Something that has to be small for a state to be one of balance.
struct Criterion {
  double value = 0.0;  ///< without unit
  double limit = 0.0;
  [[nodiscard]] bool met() const noexcept { return value <= limit; }
};

/// How far a state is from balance.
struct Balance {
  Criterion force{0.0, 1e-8};    ///< out-of-balance force over the acting forces
  Criterion gap{0.0, 1e-10};     ///< of active nodes, or how far sticking ones are off, over the tool's half width
  Criterion volume{0.0, 1e-9};   ///< what the pressures ask of the volume, over a cell's
  Criterion places{0.0, 1e-12};  ///< what prescribed places still have to move, over the body's extent
  bool status_changes = false;   ///< of a node: active or not, slipping or not

  [[nodiscard]] bool reached() const noexcept;
  /// How exactly the next step is to be solved for, relative: no more exactly than it is worth, nor than the last one
  /// must be. Source: S. C. Eisenstat, H. F. Walker, SIAM J. Sci. Comput. 17 (1996) 16-32.
  [[nodiscard]] double step_tolerance_rel() const noexcept;
};

/// Report of a Newton solve.
struct NewtonReport {
  bool converged = false;
  int iterations = 0;
  double residual_rel = 0.0;  ///< out-of-balance force over the sum of contact and support forces
  int indefinite = 0;         ///< iterations whose tangent was not positive definite and was made so
  std::string trouble;        ///< as text, when not converged
};

template <int dim>
class NewtonSolver {
 public:
  /// Called after every iteration; may throw to stop.
  using Watch = std::function<void(int iteration, double residual_rel)>;

  /// Both must outlive it. @param contact_parameter  factor on c of the active set
  NewtonSolver(const ContactModel<dim>& model, ElasticBody<dim>& body, double contact_parameter)
      : model_(model), body_(body), active_set_(model, contact_parameter), slipping_(model) {}

  /// From the given state, which is left unfinished when it does not converge. Only stable equilibria count as
  /// converged: the last tangent was positive definite.
  NewtonReport solve(State<dim>& state, const Watch& watch);

  static constexpr int largest_iterations = 25;
  static constexpr int largest_iterations_with_friction = 40;

 private:
  using Nodal = typename Discretisation<dim>::Nodal;
  using Point = typename Discretisation<dim>::Point;
  using Forces = typename ElasticBody<dim>::Forces;

  /// Updates the status of the nodes and what prescribed places have to move.
  Balance update(State<dim>& state, const Forces& forces, int iteration);
  /// Out-of-balance force and sum of the acting forces [N].
  [[nodiscard]] std::array<double, 2> residual(const State<dim>& state, const Nodal& forces_n) const;
  void assemble(const State<dim>& state, Tangent tangent);
  /// The next displacement. @returns false when no tangent is positive definite
  bool next_step(const State<dim>& state, double tolerance_rel, NewtonReport& report, Nodal& du_m);
  /// Moves on, only as far as every element stays admissible. @returns false when it cannot
  bool move(State<dim>& state, const Nodal& du_m, Forces& forces) const;

  const ContactModel<dim>& model_;
  ElasticBody<dim>& body_;
  ActiveSet<dim> active_set_;
  Slipping<dim> slipping_;
  Nodal step_m_;                  // what prescribed components still have to move
  bool last_stable_ = true;       // the last tangent used was positive definite
  std::set<std::string> passed_;  // with friction the nodes' status may come round again and again
  int cycles_ = 0;
};

}  // namespace touchstone::reference
