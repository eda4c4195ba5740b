// Solves a scene on finer and finer meshes until its uncertainty is small enough or a limit is met.
#pragma once

#include "reference/run/model_choice.h"
#include "reference/solver.h"

namespace touchstone::reference {

/// The work behind solve(), for a scene without faults. Level after level, instant after instant; everything finished
/// is in the store before the next begins.
///
/// A level starts at every instant from the coarser level's solution there, carried to its nodes, which is nearer than
/// anything a load path on the level itself can offer; where Newton fails from it, and with friction, which remembers
/// its path, the body follows the track from the instant before.
[[nodiscard]] Result run(const scene::Scene& scene, const ModelChoice& choice, const Eigen::Matrix3Xd& rest_points_m,
                         const Options& options);

/// Memory that the solve of a mesh takes, of the whole process [bytes]: measured with CHOLMOD on graded blocks, a
/// factor of 98 MB at 17 thousand and 1.06 GB at 93 thousand unknowns, and half as much again around it.
[[nodiscard]] double expected_memory_bytes(int dim, double unknowns);

}  // namespace touchstone::reference
