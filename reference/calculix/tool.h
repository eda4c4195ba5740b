// The rigid tool as elements of a second code: a thin coat under its surface, every node of which is to be moved by
// the pose.
#pragma once

#include "reference/run/model_choice.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

namespace touchstone::reference {

/// Second-order elements. dim = 3: wedges of fifteen nodes in the tool frame, their second triangle the tool's surface.
/// dim = 2: quadrilaterals of eight nodes in the meridian plane, r from the axis and z from the mass centre, upright as
/// the tool is, their first side the surface. Nodes of an element are in CalculiX's order.
template <int dim>
struct ToolCoat {
  static constexpr int nodes_per_element = dim == 3 ? 15 : 8;
  static constexpr int surface_face = dim == 3 ? 2 : 1;  ///< CalculiX's number of that face

  Eigen::Matrix<double, dim, Eigen::Dynamic> points_m;
  std::vector<std::array<int, nodes_per_element>> elements;
};

/// Curved sides lie on the surface that the reference solves, at corners and middles; a mesh tool keeps its own flat
/// triangles. Elements are a quarter of the contact's half width long at most, and half of the radius of a tight bend.
[[nodiscard]] ToolCoat<2> meridian_coat(const scene::Tool& tool, const Eigen::Quaterniond& orientation,
                                        const ModelChoice& choice);
/// @param meets  whether a corner of a triangle ever comes near the body; triangles without are left out
[[nodiscard]] ToolCoat<3> surface_coat(const scene::Tool& tool, const ModelChoice& choice,
                                       const std::function<bool(const scene::Vec3& p_T_m)>& meets);

}  // namespace touchstone::reference
