// The linear response of a body to point loads, without the singular part.
//
// Split the displacement as u = u_k + w, u_k that of the same load on the half space of the tangent plane, which holds
// a convex body. w solves the body's own linear problem with smooth data,
//   int sigma(w) : grad v = -int_free (sigma_k N) . v + int_inclusions (sigma_k - sigma(u_k)) : grad v,
//   w = -u_k where the body is held,
// so that no mesh has to resolve the load. With nu < 0.5 on a curved surface sigma_k N grows as 1 / distance towards
// the load, and w at the load's own place as its logarithm; the size of the mesh's cells then takes the place of the
// size of the load.
#pragma once

#include "scene/response/response.h"

#include <functional>

namespace touchstone::reference {

struct SmoothResponseOptions {
  double cells = 10.0;  ///< to the body's size; as many again to the spread of the loads
  scene::LoadKinds loads = {};
};

/// A response of which the first columns are computed; the others are zero.
struct FirstColumns {
  scene::Response response;
  Eigen::Index done = 0;
};

/// What a computation does next.
struct SmoothProgress {
  enum class Next { mesh, matrix, column } next;
  const FirstColumns& first;  ///< so far; without a size before the first column
};

/// One factorisation and one solve per load.
/// @param rest_points_m  of the rest surface, 3 x m
/// @param progress       called before the mesh, before the factorisation, with which the first column is solved for,
///                       and after every column; may be empty and may throw to stop
/// @param first          of an earlier computation with the same arguments, which goes on with the next column to the
///                       same bits
/// @throws scene::InputError for an incompressible inclusion in a compressible body and for a body that cannot be
///         meshed; std::runtime_error when a load cannot be solved for
[[nodiscard]] scene::Response smooth_response(const scene::Body& body, const scene::LoadGrid& grid,
                                              const Eigen::Matrix3Xd& rest_points_m,
                                              const SmoothResponseOptions& options = {},
                                              const std::function<void(const SmoothProgress&)>& progress = {},
                                              FirstColumns first = {});

}  // namespace touchstone::reference
