// Solves a scene on finer and finer meshes until its uncertainty is small enough or a limit is met.
#pragma once

#include "reference/run/model_choice.h"
#include "reference/run/options.h"
#include "reference/run/result.h"
#include "scene/base/stopwatch.h"

namespace touchstone::reference {

/// The work behind solve(), for a scene without faults. Level after level, instant after instant; everything finished
/// is in the store before the next begins.
///
/// A level starts at every instant from the coarser level's solution there, carried to its nodes, which is nearer than
/// anything a load path on the level itself can offer; where Newton fails from it, and with friction, which remembers
/// its path, the body follows the track from the instant before.
/// @param begin  from when Options::seconds_limit counts
[[nodiscard]] Result run(const scene::Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m,
                         const Options& options, const scene::Stopwatch& begin);

}  // namespace touchstone::reference
