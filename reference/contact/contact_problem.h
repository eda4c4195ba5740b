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

#include "reference/contact/elastic_body.h"
#include "reference/contact/friction.h"
#include "reference/contact/regions.h"
#include "reference/contact/state.h"
#include "reference/tool/tool_gap.h"
#include "scene/base/frames.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace touchstone::reference {

/// The force of the tool on the body at one active node.
template <int dim>
struct NodeContact {
  using Point = Eigen::Matrix<double, dim, 1>;
  int node = 0;
  Point normal = Point::Zero();      ///< unit length, out of the tool
  double normal_n = 0.0;             ///< N
  Point friction_n = Point::Zero();  ///< t
  Point slip_m = Point::Zero();      ///< s; zero once the state is solved
  double coefficient = 0.0;          ///< m
  bool slips = false;
  int region = 0;
};

/// Tangents of Newton's method; each replaces the one before where that is not positive definite.
enum class Tangent {
  consistent,
  without_curvature,  ///< of the tool, whose curvature may make the tangent indefinite
  definite,           ///< also without the terms that make the body itself unstable, see Stiffness
};

/// Report of a Newton solve.
struct NewtonReport {
  bool converged = false;
  int iterations = 0;
  double residual_rel = 0.0;  ///< out-of-balance force over the sum of contact and support forces
  int indefinite = 0;         ///< iterations whose tangent was not positive definite and was made so
  std::string trouble;        ///< as text, when not converged
};

/// Results of a solved state, of the whole body: mirror images are included.
struct Observation {
  scene::Vec3 force_n = scene::Vec3::Zero();          ///< on the tool, sum over the regions
  scene::Vec3 torque_nm = scene::Vec3::Zero();        ///< on the tool, about its mass centre
  scene::Vec3 support_force_n = scene::Vec3::Zero();  ///< of the support on the body
  double area_m2 = 0.0;                               ///< of contact, on the deformed surface
  double contact_radius_m = 0.0;                      ///< bodies of revolution only: of the contact's edge
  double node_penetration_m = 0.0;                    ///< largest over the nodes where contact is enforced
  double between_nodes_penetration_m = 0.0;           ///< largest over face quadrature points and hanging nodes
  double equilibrium_rel = 0.0;                       ///< |contact + support| / |contact|
  double volume_change_rel = 0.0;
  double dissipated_j = 0.0;  ///< by friction since the body was at rest
  std::vector<ContactRegion> regions;
};

/// The discrete problem. Not thread-safe; uses `threads` threads inside. Of several ranks only the first one has it,
/// see ElasticBody.
template <int dim>
class ContactProblem {
 public:
  /// Called after every Newton iteration; may throw to stop.
  using Watch = std::function<void(int iteration, double residual_rel)>;

  /// @param mirror_x, mirror_y  dim = 3: the mesh is one half of the body on that side
  ContactProblem(Discretisation<dim> mesh, const scene::Material& material, scene::Kinematics kinematics, bool mirror_x,
                 bool mirror_y, int threads = ranks::threads(), const Numerics& numerics = {});
  ContactProblem(const ContactProblem&) = delete;
  ContactProblem& operator=(const ContactProblem&) = delete;

  /// Prescribes one displacement component from the next solve on; the support and symmetry planes are there already.
  /// New places are fixed only before the first solve.
  void prescribe(int node, int direction, double displacement_m);

  /// Dead forces on the nodes from the next solve on, one column per node [N]; hanging nodes pass theirs on.
  void load(Eigen::Matrix<double, dim, Eigen::Dynamic> force_n);

  /// The tool's pose for the next solve; without a tool there is no contact.
  void set_tool(const RigidTool<dim>& tool) { tool_ = tool; }

  /// Friction from the next solve on. Regions are separated as by observe().
  void set_friction(const scene::Friction& friction, double region_gap_m);
  [[nodiscard]] bool has_friction() const noexcept { return friction_.has_value(); }

  /// Stores for friction where the nodes are in the tool frame; the state must be without contact.
  void note_places(const RigidTool<dim>& tool, State<dim>& state) const;

  [[nodiscard]] State<dim> rest() const;

  /// Newton from the given state, which is left unfinished when it does not converge. Only stable equilibria count as
  /// converged: the last tangent was positive definite.
  NewtonReport solve(State<dim>& state, const Watch& watch = {});

  /// @param region_gap_m  active nodes of one cell face, or nearer to each other than this, are in one region; in two
  ///                      dimensions all are
  [[nodiscard]] Observation observe(const State<dim>& state, double region_gap_m = 0.0) const;

  /// Forces at the active nodes that can move along the surface; normal forces only without friction. The
  /// coefficient is that of the node's region.
  [[nodiscard]] std::vector<NodeContact<dim>> node_contacts(const State<dim>& state, double region_gap_m = 0.0) const;

  /// Internal nodal forces of a state less the dead forces, hanging nodes' passed on to their masters [N]: the
  /// support's force where displacement is prescribed, zero elsewhere except for contact.
  [[nodiscard]] Eigen::Matrix<double, dim, Eigen::Dynamic> internal_forces(const State<dim>& state) const;

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

  /// The nodes that may come into contact, and the outward normal of the surface at rest at one of them.
  [[nodiscard]] const std::vector<int>& contact_nodes() const noexcept { return contact_nodes_; }
  [[nodiscard]] Eigen::Matrix<double, dim, 1> surface_normal(int node) const { return surface_normal_.col(node); }

  [[nodiscard]] const Discretisation<dim>& mesh() const noexcept { return mesh_; }
  [[nodiscard]] int unknowns() const noexcept { return body_.unknowns(); }
  [[nodiscard]] std::string linear_solver() const { return body_.solver().description(); }
  [[nodiscard]] LinearWork linear_work() const noexcept { return body_.solver().work(); }
  /// Processor time of tangents and forces, all threads.
  [[nodiscard]] double assembly_s() const noexcept { return body_.assembly_s(); }

  /// Newton stops when the out-of-balance force is below this fraction of the acting forces.
  static constexpr double force_tolerance = 1e-8;
  static constexpr int largest_iterations = 25;
  static constexpr int largest_iterations_with_friction = 40;

 private:
  using Nodal = Eigen::Matrix<double, dim, Eigen::Dynamic>;
  using Point = Eigen::Matrix<double, dim, 1>;
  /// Active nodes and their regions on the whole body: node i of mirror image k is point i + k * nodes.size().
  struct Touching {
    std::vector<int> nodes;
    std::vector<scene::Vec3> mirrors;
    std::vector<int> region_of;  // per point
  };

  [[nodiscard]] typename ElasticBody<dim>::Forces forces(const State<dim>& state) const;
  [[nodiscard]] Gap<dim> gap(const State<dim>& state, int node) const;
  /// What the active set asks of the displacement.
  [[nodiscard]] std::vector<typename ElasticBody<dim>::Line> contact_lines() const;
  [[nodiscard]] std::vector<typename ElasticBody<dim>::InReaction> in_slip_rows() const;
  void add_turning();
  [[nodiscard]] SlipCoupling slip_coupling() const;
  /// Makes the body's tangent. @returns what it is to be solved for
  const Eigen::VectorXd& assemble_tangent(const State<dim>& state, Tangent tangent);
  /// Next active set; late in a solve it changes less easily. Returns the largest |gap| over active nodes [m].
  double update_touching(State<dim>& state, bool late, bool& changed) const;
  [[nodiscard]] Touching touching_points(const State<dim>& state, double region_gap_m) const;
  /// The node's position for contact: in small strain that at rest.
  [[nodiscard]] Point contact_place_m(const State<dim>& state, int node) const;
  /// Of all active nodes, also those without freedom along the surface.
  [[nodiscard]] std::vector<NodeContact<dim>> contacts_of(const State<dim>& state, const Nodal& forces_n,
                                                          const Touching& touching) const;
  /// The component of a vector along the surface at a node, in directions free to move.
  [[nodiscard]] Point along_surface(int node, const Point& normal, Point vector) const;
  [[nodiscard]] bool can_slip(int node) const;
  void begin_increment(State<dim>& state);
  /// Which active nodes slip next, and their direction; returns the largest distance of a sticking node from its place
  /// [m].
  /// @param before  active in the last iteration
  double update_slipping(State<dim>& state, const std::vector<char>& before, const Nodal& forces_n, int iteration,
                         bool& changed);
  /// Friction of a region, of the whole body.
  struct RegionFriction {
    double normal_n = 0.0, slipping_normal_n = 0.0, limit_n = 0.0;
    scene::Vec3 friction_n = scene::Vec3::Zero();
    bool sticks_somewhere = false, slides = false;
  };
  [[nodiscard]] std::vector<RegionFriction> region_frictions(const State<dim>& state) const;
  /// Regions whose nodes all slip, in one direction, begin to slip as a whole (sliding). @returns whether that changes
  /// the coefficient of a region
  bool begin_sliding(State<dim>& state) const;
  /// Makes the solved state the start of the next increment. A region keeps sliding until nodes with half of its normal
  /// force stick.
  void keep_history(State<dim>& state) const;
  /// Out-of-balance force and sum of the acting forces [N].
  [[nodiscard]] std::array<double, 2> residual(const State<dim>& state, const Nodal& forces_n) const;

  ElasticBody<dim> body_;
  const Discretisation<dim>& mesh_;
  scene::Material material_;
  scene::Kinematics kinematics_;
  bool mirror_x_, mirror_y_;
  Numerics numerics_;
  std::optional<RigidTool<dim>> tool_;
  std::optional<FrictionLaw> friction_;
  double region_gap_m_ = 0.0;

  // Per node.
  Nodal surface_normal_;           // outward at rest, zero away from the free surface
  std::vector<double> area_m2_;    // of the free surface; zero: never in contact
  std::vector<int> axis_partner_;  // dim = 2: a node on the axis is active when this one is; else -1
  std::vector<int> contact_nodes_;
  double largest_extent_m_ = 0.0;

  // Per node and direction.
  std::vector<char> prescribed_;
  Nodal prescribed_m_;
  Nodal dead_force_n_;  // no columns without any
  bool holds_rest_factor_ = false;

  // Of the current Newton iteration.
  Nodal step_offset_m_;           // what prescribed components still have to move
  std::vector<int> eliminated_;   // per node: direction expressed by the others, `all_directions`, or -1
  std::vector<Gap<dim>> gaps_;    // per node
  std::vector<double> lambda_n_;  // per node

  // Of the current increment and Newton iteration, with friction.
  static constexpr int all_directions = dim;
  /// Terms of an active node's friction in the tangent.
  struct Slip {
    Point direction = Point::Zero();  // tau / |tau|
    double turning_n_per_m = 0.0;     // resists slip across it
  };
  Eigen::Matrix3Xd anchors_m_;  // per node: point of the tool from which its slip is measured; NaN: none yet
  std::vector<NodeContact<dim>> contacts_;
  std::vector<Slip> slips_;      // per contact
  std::vector<int> contact_of_;  // per node: index into contacts_, or -1
  std::vector<int> slip_row_;    // per node: row of SlipCoupling, or -1
  int slip_rows_ = 0;
  std::vector<double> slip_stiffness_n_per_m_;  // per node: k_n of tau
  Nodal slip_direction_;                        // tau / |tau| of the last iteration; zero where nothing slipped
  Nodal stick_m_;                               // what sticking nodes still have to move
};

}  // namespace touchstone::reference
