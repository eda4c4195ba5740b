// How finely a scene's contact has to be looked at: chosen once, from its track.
#pragma once

#include "fast/step/model.h"
#include "scene/model/scene.h"

#include <vector>

namespace touchstone::fast {

/// The largest error_rel that is fine enough: a little less than 1 %, since the track is looked at at some poses only.
inline constexpr double cell_tolerance_rel = 0.008;

/// The fewest points whose load is as near to its limit as that, or the most there are. The load is that of a unit law,
/// linear and cubic, without friction, so that the answer does not depend on constants that are fitted.
/// @param model  rules are tried in it, and it is left as it was
[[nodiscard]] ContactCells choose_cells(const std::vector<scene::Waypoint>& track, FastModel& model);

/// A scene's model with the cells that its track needs.
[[nodiscard]] FastModel model_of(const scene::Scene& scene);

}  // namespace touchstone::fast
