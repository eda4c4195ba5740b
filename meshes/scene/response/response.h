// What a body's surface does under a point load, beyond what a half space does: small strain, computed offline.
#pragma once

#include "scene/response/load_grid.h"

#include <Eigen/Core>

#include <string>

namespace touchstone::scene {

/// Loads of a response besides those against the normals.
struct LoadKinds {
  bool friction = false;  ///< along the surface, two at every grid point; else two at the middle one alone
  bool ball = false;      ///< radial double forces, one at every grid point
  [[nodiscard]] int columns(int points) const noexcept {
    return points + (friction ? 2 * points : 2) + (ball ? points : 0);
  }
};

/// Displacement per newton of loads on a grid's points, on the elastic body with its support and inclusions, minus
/// half_space_displacement_m() of the same load. It is smooth, also at the load's own place. n grid points, m rest
/// points, c columns: n for loads against the normals; for loads along the surface both directions of LoadGrid::along()
/// of a point after each other; and n for radial double forces [per N m], which are smooth but for 1 / distance on
/// curved bodies.
struct Response {
  LoadGrid grid;
  LoadKinds loads;
  Eigen::MatrixXf smooth_m_per_n;  ///< 3 m x c, world: x of all rest points, then y, then z
  Eigen::Matrix3Xd own_m_per_n;    ///< the same at the load's place, 3 x c
  Eigen::Matrix2Xd tilt_per_n;     ///< slope of the normal component there by a load against the normal, along the
                                   ///< grid's directions, 2 x n
  int unknowns = 0;                ///< of the linear systems
  /// Error of interpolating between grid points (grid_weights.h), root mean square over the rest points relative to the
  /// columns, of a load against the normal in the middle of four grid points.
  double interpolation_rel = 0.0;

  [[nodiscard]] Eigen::Index rest_points() const noexcept { return smooth_m_per_n.rows() / 3; }
  // Columns of loads at a point:
  [[nodiscard]] Eigen::Index along(int point, int axis) const noexcept {
    return grid.count() + (loads.friction ? 2 * point : 0) + axis;
  }
  [[nodiscard]] Eigen::Index apart(int point) const noexcept {
    return grid.count() + (loads.friction ? 2 * grid.count() : 2) + point;
  }
};

[[nodiscard]] LoadKinds load_kinds(const Scene& scene);

/// Why the response model cannot answer a scene, completing "the response model needs that ..."; empty when it can.
[[nodiscard]] std::string response_needs(const Scene& scene);

/// The same of the scene's own formulation, which may need nothing.
[[nodiscard]] std::string formulation_needs(const Scene& scene);

/// Everything that a response depends on, as text that a reader can compare; its hash names the file.
/// @param surface  whose points are the rest points
[[nodiscard]] std::string response_identity(const Body& body, const LoadGrid& grid, const Surface& surface,
                                            const LoadKinds& loads = {});

}  // namespace touchstone::scene
