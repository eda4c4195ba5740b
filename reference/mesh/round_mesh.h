// Meshes of bodies with a convex profile turned about z: spheres, ellipsoids, cylinders, cones, capsules, barrels.
#pragma once

#include "reference/mesh/mesh.h"
#include "scene/shape/revolution.h"

#include <string>

namespace touchstone::reference {

/// The body stands on z = 0. Its surface up to support_height_m is held: that height is a ring of vertices of every
/// mesh, so that the held surface is the same on all levels. A flat bottom is held as a whole.
struct RoundSpec {
  scene::Profile profile;
  Eigen::Vector2d stretch = Eigen::Vector2d::Ones();  ///< of x and y after turning; dim = 2: equal
  double support_height_m = 0.0;
  bool symmetric_x = false, symmetric_y = false;  ///< dim = 3: the half x >= 0, the half y >= 0
};

/// Of a body with a scene::TurnedForm.
[[nodiscard]] RoundSpec round_spec(const scene::Body& body);

/// Edge of the held surface, (r, z) before stretching.
[[nodiscard]] Eigen::Vector2d support_edge_m(const RoundSpec& spec);

/// Why the profile cannot be meshed, in words; empty when it can.
[[nodiscard]] std::string round_fault(const RoundSpec& spec);

/// A core of frustums about the axis and a shell around it. Every corner of the profile, every joint of its pieces and
/// the support's edge are rings of vertices. Instantiated for 2 (the meridian half-plane) and 3.
template <int dim>
[[nodiscard]] MappedSpec<dim> round_cells(const RoundSpec& spec);
template <int dim>
[[nodiscard]] Discretisation<dim> round_mesh(const RoundSpec& spec, const Grading<dim>& grading);

}  // namespace touchstone::reference
