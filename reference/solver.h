// The offline reference: finite-strain contact of a rigid tool with an elastic body, with an
// uncertainty on every number. This header is free of deal.II; see the .cc files for the method.
#pragma once

#include "reference/run/options.h"
#include "reference/run/result.h"
#include "scene/base/error.h"
#include "scene/model/plan.h"
#include "scene/model/scene.h"

#include <string>
#include <vector>

namespace touchstone::reference {

/// What this solver will model for the scene. Cheap: nothing is solved.
[[nodiscard]] scene::Plan plan(const scene::Scene& scene);

/// What of the scene this solver cannot do; empty when it can. solve() throws InputError with these.
[[nodiscard]] std::vector<scene::Fault> unsupported(const scene::Scene& scene);

/// Content address of the scene's reference result: everything that changes the answer, nothing else.
[[nodiscard]] std::string content_key(const scene::Scene& scene);

/// Solves, resumes or reads back.
/// @param rest_points_m  points of the rest surface at which displacement is wanted, 3 x n, world frame
/// @throws InputError, NotConverged, LimitReached, Interrupted, std::filesystem::filesystem_error
[[nodiscard]] Result solve(const scene::Scene& scene, const Eigen::Matrix3Xd& rest_points_m, const Options& options);

}  // namespace touchstone::reference
