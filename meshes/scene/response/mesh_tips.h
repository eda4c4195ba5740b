// The parts of a mesh tool that touch a body, where they are parts of balls.
#pragma once

#include "scene/response/tool_tip.h"

#include <vector>

namespace touchstone::scene {

/// How far a part's surface may be off its ball, over the depth to which the part is pressed in. A ball's facets leave
/// s^2 / (8 R) with edges of length s.
inline constexpr double ball_tolerance_rel = 0.02;

/// One ball for each connected part of the mesh that is below the rest surface at one of the times: of least squares
/// through the edges' middles, so that the facets are on average on it. Parts of one ball are one tip.
/// @param scene  with a mesh tool; @param times_s  of the track
/// @returns the tips, none where the mesh stays apart; or in words why there are none
[[nodiscard]] FoundTips mesh_tips(const Scene& scene, const std::vector<double>& times_s);

}  // namespace touchstone::scene
