// What a contact problem is: body, supports, loads, tool, friction, and the surface that may touch.
#pragma once

#include "reference/contact/friction.h"
#include "reference/contact/state.h"
#include "reference/discretisation/discretisation.h"
#include "reference/tool/tool_gap.h"
#include "scene/base/frames.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <optional>
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

/// Active nodes and their regions on the whole body: node i of mirror image k is point i + k * nodes.size().
struct Touching {
  std::vector<int> nodes;
  std::vector<scene::Vec3> mirrors;
  std::vector<int> region_of;  ///< per point
};

template <int dim>
struct ContactModel {
  using Nodal = typename Discretisation<dim>::Nodal;
  using Point = typename Discretisation<dim>::Point;

  /// The support and the symmetry planes are prescribed. @param mesh_in  must outlive it
  ContactModel(const Discretisation<dim>& mesh_in, const scene::Material& material_in, scene::Kinematics kinematics_in,
               bool mirror_x_in, bool mirror_y_in);

  const Discretisation<dim>& mesh;
  scene::Material material;
  scene::Kinematics kinematics;
  bool mirror_x, mirror_y;
  std::optional<RigidTool<dim>> tool;
  std::optional<FrictionLaw> friction;
  double region_gap_m = 0.0;  ///< of friction's regions
  double largest_extent_m = 0.0;

  // Per degree of freedom, or per node and direction.
  std::vector<char> prescribed;
  Nodal prescribed_m;

  // Per node.
  Nodal normal;                   ///< outward at rest, zero away from the free surface
  std::vector<double> area_m2;    ///< of the free surface; zero: never in contact
  std::vector<int> axis_partner;  ///< dim = 2: a node on the axis is active when this one is; else -1

  std::vector<int> nodes;  ///< that may touch

  [[nodiscard]] bool is_prescribed(int node, int direction) const { return prescribed[dim * node + direction] != 0; }
  /// Half the tool's width, or the body's extent: what lengths are compared with.
  [[nodiscard]] double length_m() const { return tool ? tool->half_width_m() : largest_extent_m; }
  /// A force that is next to nothing.
  [[nodiscard]] double smallest_force_n() const {
    return 1e-10 * material.shear_modulus_pa() * length_m() * length_m();
  }
  [[nodiscard]] double images() const { return (mirror_x ? 2.0 : 1.0) * (mirror_y ? 2.0 : 1.0); }
  [[nodiscard]] Gap<dim> gap(const State<dim>& state, int node) const;
  /// The node's position for contact: in small strain that at rest.
  [[nodiscard]] Point place_m(const State<dim>& state, int node) const;
  /// The component of a vector along the surface at a node, in directions free to move.
  [[nodiscard]] Point along_surface(int node, const Point& normal_in, Point vector) const;
  [[nodiscard]] bool can_slip(int node) const;
  /// @param gap_m  active nodes of one cell face, or nearer to each other than this, are in one region; in two
  ///               dimensions all are
  [[nodiscard]] Touching touching_points(const State<dim>& state, double gap_m) const;
  /// Of all active nodes, also those without freedom along the surface.
  [[nodiscard]] std::vector<NodeContact<dim>> contacts_of(const State<dim>& state, const Nodal& forces_n,
                                                          const Touching& touching) const;
  /// Stores for friction where the nodes are in a tool's frame.
  void note_places(const RigidTool<dim>& at, State<dim>& state) const;
};

}  // namespace touchstone::reference
