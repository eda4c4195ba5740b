// What a body's surface does under a point load, beyond what a half space does: small strain, computed offline.
#pragma once

#include "scene/response/load_grid.h"

#include <Eigen/Core>

#include <string>

namespace touchstone::scene {

/// Displacement per newton of loads on a grid's points, on the elastic body with its support and inclusions, minus
/// half_space_displacement_m() of the same load. It is smooth, also at the load's own place. n grid points, m rest
/// points, c columns: n for loads against the normals, and for scenes with friction 2 n more for loads along the
/// surface, both directions of LoadGrid::along() of a point after each other.
struct Response {
  LoadGrid grid;
  Eigen::MatrixXf smooth_m_per_n;  ///< 3 m x c, world: x of all rest points, then y, then z
  Eigen::Matrix3Xd own_m_per_n;    ///< the same at the load's place, 3 x c
  Eigen::Matrix2Xd tilt_per_n;     ///< slope of the normal component there by a load against the normal, along the
                                   ///< grid's directions, 2 x n
  int unknowns = 0;                ///< of the linear systems

  [[nodiscard]] Eigen::Index rest_points() const noexcept { return smooth_m_per_n.rows() / 3; }
};

/// Why the response model cannot answer a scene, completing "the response model needs that ..."; empty when it can.
[[nodiscard]] std::string response_needs(const Scene& scene);

/// The same of the scene's own formulation, which may need nothing.
[[nodiscard]] std::string formulation_needs(const Scene& scene);

/// Everything that a response depends on, as text that a reader can compare; its hash names the file.
/// @param surface   whose points are the rest points
/// @param friction  with loads along the surface
[[nodiscard]] std::string response_identity(const Body& body, const LoadGrid& grid, const Surface& surface,
                                            bool friction = false);

}  // namespace touchstone::scene
