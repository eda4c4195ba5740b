// One elastic body on one mesh against a rigid tool, with or without friction: assembly, active sets, Newton.
//
// Unknowns are nodal displacements u and per-cell pressures p. Equilibrium with contact forces lambda_n >= 0 on the
// surface nodes n,
//   F_int(u, p) = sum_n lambda_n grad g_n,   g_n >= 0,   lambda_n g_n = 0,
// is solved by the primal-dual active set method: in every iteration the displacement of an active node
// (`touching` in the code) along grad g_n is eliminated exactly (n . du = -g), and lambda_n is read from the internal
// force. A node stays active while lambda_n / w_n - c g_n > 0 (w_n its area, c = E over the tool's half width), and
// becomes active when g_n < 0. At the end the gap of every active node is zero to round-off and no other node
// penetrates. Source: M. Hintermueller, K. Ito, K. Kunisch, SIAM J. Optim. 13 (2003) 865-888; for contact S. Hueeber,
// B. I. Wohlmuth, Comput. Methods Appl. Mech. Eng. 194 (2005) 3147-3166.
//
// With friction an active node has a force t along the surface besides N n, |t| <= m N, and a slip s: its displacement
// relative to the tool, along the surface, since the last solved state. It sticks (s = 0; its displacement is
// eliminated) or slips,
//   t = m N tau / |tau|,  tau = t - k_n s,
// and is taken to slip when |tau| > m N. k_n = E sqrt(w_n) is about the body's stiffness against a shift of the node's
// patch. With a much smaller k_n a slipping node sticks again far from its place; where k_n is too large the direction
// of slip oscillates, and k_n is reduced. Newton's method on this is that of S. Hueeber, G. Stadler, B. I. Wohlmuth,
// SIAM J. Sci. Comput. 30 (2008) 572-596; the part of its tangent that is not symmetric is in friction.h. One solve is
// one increment of the backward Euler rule: t opposes the whole slip, so that friction returns no energy in any
// increment.
#pragma once

#include "reference/contact/contact_model.h"
#include "reference/contact/elastic_body.h"
#include "reference/contact/newton.h"
#include "reference/contact/observation.h"
#include "reference/contact/traction.h"
#include "scene/base/frames.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::reference {

/// The discrete problem. Not thread-safe; uses `threads` threads inside. Of several ranks only the first one has it,
/// see ElasticBody.
template <int dim>
class ContactProblem {
 public:
  using Watch = typename NewtonSolver<dim>::Watch;

  /// @param mirror_x, mirror_y  dim = 3: the mesh is one half of the body on that side
  ContactProblem(Discretisation<dim> mesh, const scene::Material& material, scene::Kinematics kinematics, bool mirror_x,
                 bool mirror_y, int threads = ranks::threads(), const Numerics& numerics = {});
  ContactProblem(const ContactProblem&) = delete;
  ContactProblem& operator=(const ContactProblem&) = delete;

  /// Prescribes one displacement component from the next solve on; the support and symmetry planes are there already.
  /// New places are fixed only before the first solve.
  void prescribe(int node, int direction, double displacement_m);

  /// Dead forces on the nodes from the next solve on, one column per node [N]; hanging nodes pass theirs on.
  void load(Eigen::Matrix<double, dim, Eigen::Dynamic> force_n) { body_.load(std::move(force_n)); }

  /// The tool's pose for the next solve; without a tool there is no contact.
  void set_tool(const RigidTool<dim>& tool) { model_.tool = tool; }

  /// Friction from the next solve on. Regions are separated as by observe().
  void set_friction(const scene::Friction& friction, double region_gap_m);
  [[nodiscard]] bool has_friction() const noexcept { return model_.friction.has_value(); }

  /// Stores for friction where the nodes are in the tool frame; the state must be without contact.
  void note_places(const RigidTool<dim>& tool, State<dim>& state) const { model_.note_places(tool, state); }

  [[nodiscard]] State<dim> rest() const;

  /// Newton from the given state, which is left unfinished when it does not converge. Only stable equilibria count as
  /// converged: the last tangent was positive definite.
  NewtonReport solve(State<dim>& state, const Watch& watch = {}) { return newton_.solve(state, watch); }

  /// @param region_gap_m  active nodes of one cell face, or nearer to each other than this, are in one region; in two
  ///                      dimensions all are
  [[nodiscard]] Observation observe(const State<dim>& state, double region_gap_m = 0.0) const {
    return reference::observe(model_, body_, state, region_gap_m);
  }

  /// Forces at the active nodes that can move along the surface; normal forces only without friction. The
  /// coefficient is that of the node's region.
  [[nodiscard]] std::vector<NodeContact<dim>> node_contacts(const State<dim>& state, double region_gap_m = 0.0) const;

  [[nodiscard]] ContactTraction<dim> contact_traction(const State<dim>& state) const {
    return reference::contact_traction(model_, body_, state);
  }

  /// Internal nodal forces of a state less the dead forces, hanging nodes' passed on to their masters [N]: the
  /// support's force where displacement is prescribed, zero elsewhere except for contact.
  [[nodiscard]] Eigen::Matrix<double, dim, Eigen::Dynamic> internal_forces(const State<dim>& state) const {
    return body_.forces(state).nodal_n;
  }

  /// A force on one node, which must not hang.
  struct NodeForce {
    int node = 0;
    Eigen::Matrix<double, dim, 1> force_n = Eigen::Matrix<double, dim, 1>::Zero();
  };
  /// The nodal displacements under each force alone, with the stiffness at rest, the matrix factorised at the
  /// first call, after which no new place may be prescribed and nothing else be solved. Prescribed places stay. The
  /// bulk modulus is the tangent's, see MixedMaterial.
  /// @throws std::runtime_error when the stiffness is singular
  [[nodiscard]] std::vector<Eigen::Matrix<double, dim, Eigen::Dynamic>> linear_displacements_m(
      const std::vector<NodeForce>& forces);
  /// The same under the dead forces and with the prescribed displacements of now.
  [[nodiscard]] Eigen::Matrix<double, dim, Eigen::Dynamic> linear_displacement_m();

  /// The nodes that may come into contact, and the outward normal of the surface at rest at one of them.
  [[nodiscard]] const std::vector<int>& contact_nodes() const noexcept { return model_.nodes; }
  [[nodiscard]] Eigen::Matrix<double, dim, 1> surface_normal(int node) const { return model_.normal.col(node); }

  [[nodiscard]] const Discretisation<dim>& mesh() const noexcept { return body_.mesh(); }
  [[nodiscard]] int unknowns() const noexcept { return body_.unknowns(); }
  [[nodiscard]] std::string linear_solver() const { return body_.solver().description(); }
  [[nodiscard]] LinearWork linear_work() const noexcept { return body_.solver().work(); }
  /// Processor time of tangents and forces, all threads.
  [[nodiscard]] double assembly_s() const noexcept { return body_.assembly_s(); }

  /// Newton stops when the out-of-balance force is below this fraction of the acting forces.
  static constexpr double force_tolerance = Balance{}.force.limit;

 private:
  void factorise_at_rest();

  ElasticBody<dim> body_;
  ContactModel<dim> model_;
  NewtonSolver<dim> newton_;
  bool holds_rest_factor_ = false;
};

}  // namespace touchstone::reference
