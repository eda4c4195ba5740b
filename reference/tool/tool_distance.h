// Signed distances of the tools that a scene can have.
#pragma once

#include "reference/tool/tool_gap.h"
#include "scene/model/scene.h"

namespace touchstone::reference {

/// Sphere, capsule, cylinder and box: exact, with continuous gradients outside and on the surface; inside, the gradient
/// turns where two sides are equally near. The Hessian jumps where flat, fillet and side meet. A box's edges are
/// rounded by box_edge_share of its smallest half edge. A mesh becomes a DistanceGrid, which takes a second or two.
[[nodiscard]] std::shared_ptr<const ToolDistance> tool_distance(const scene::Tool& tool);

inline constexpr double box_edge_share = 0.125;

/// A ball about its mass centre.
template <int dim>
[[nodiscard]] RigidTool<dim> ball_tool(double radius_m, const Eigen::Matrix<double, dim, 1>& center_m);

}  // namespace touchstone::reference
