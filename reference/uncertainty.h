// How far the finest level may be from the exact answer of the model, from what refinement changed.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace touchstone::reference {

/// Half width of the band per instant, for a quantity on successively refined levels F0, F1, F2 (the last three count):
///   b = 1.25 max(|F2 - F1|, |F1 - F0| / 2), then the largest over the instant and its two neighbours.
/// Why so: a contact force does not approach its limit from one side, because the contact's edge moves by whole nodes;
/// Richardson's extrapolation would be luck. Each level halves the cells under the tool, so even at first order the
/// error after F2 is no more than |F2 - F1|, and no more than half of the change before: the second term guards against
/// F2 and F1 agreeing by chance, the neighbours against both doing so at one instant, and 1.25 is Roache's factor for
/// three or more grids (P. J. Roache, J. Fluids Eng. 116 (1994) 405-413).
/// It covers the mesh and nothing else: not the material law, not friction left out.
/// @param levels  [level][instant], coarsest first
/// @returns infinity throughout with fewer than three levels
[[nodiscard]] std::vector<double> force_band(const std::vector<std::vector<double>>& levels);

/// The same per rest point, with the length of the difference of two displacement vectors.
/// @param levels  [level][instant], each 3 x points
/// @returns per instant, per point
[[nodiscard]] std::vector<Eigen::VectorXd> displacement_band(const std::vector<std::vector<Eigen::Matrix3Xd>>& levels);

}  // namespace touchstone::reference
