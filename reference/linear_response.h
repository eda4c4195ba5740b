// The body's answer to small forces, condensed onto the surface nodes that the tool may touch: what a precomputed
// linear model needs of it. Small strain, from the stiffness of the reference's own elements at rest. Free of
// deal.II, as solver.h.
#pragma once

#include "scene/model/scene.h"

#include <Eigen/Core>

#include <functional>
#include <string>

namespace touchstone::reference {

/// n contact nodes, m rest points. A force is on the body, against the outward normal at a node; in an axisymmetric
/// model it is the whole ring's.
struct LinearResponse {
  std::string model;                     ///< "full 3D u-p small strain"
  Eigen::Matrix3Xd nodes_m;              ///< rest places, 3 x n, world; (r, 0, z) where axisymmetric
  Eigen::Matrix3Xd normals;              ///< outward at rest, 3 x n
  Eigen::Matrix3Xd force_on_tool;        ///< of the whole body's surface, by a unit force at each node, 3 x n
  Eigen::MatrixXd compliance_m_per_n;    ///< n x n, symmetric: displacement of node i against its normal
  Eigen::MatrixXd displacement_m_per_n;  ///< 3 m x n: rows 3 p to 3 p + 2 are the displacement of rest point p
  int unknowns = 0;                      ///< of the factorised stiffness
};

/// Which model is condensed.
struct LinearResponseOptions {
  int level = 0;            ///< of the reference's meshes, 0 the coarsest
  bool whole_body = true;   ///< without the mirror planes that the scene's track has but a hand need not keep to. A
                            ///< body of revolution stays one where the scene is axisymmetric
  double margin_rel = 0.1;  ///< a node may come into contact if the tool comes nearer to it at rest, at any instant,
                            ///< than this fraction of the track's largest depth
};

/// Factorises once and solves once per node that may come into contact.
/// @param rest_points_m  of the rest surface at which displacement is wanted, 3 x m, world frame
/// @param progress       called now and then with the fraction done; may be empty and may throw to stop
/// @throws scene::InputError when solve() does not support the scene, it has friction, or the tool touches
///         nothing; std::runtime_error when the stiffness is singular or the memory does not suffice
[[nodiscard]] LinearResponse linear_response(const scene::Scene& scene, const Eigen::Matrix3Xd& rest_points_m,
                                             const LinearResponseOptions& options = {},
                                             const std::function<void(double)>& progress = {});

}  // namespace touchstone::reference
