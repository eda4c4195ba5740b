// The parts of a mesh tool that touch a body, where they are parts of balls or flat discs.
#pragma once

#include "scene/response/tool_tip.h"

#include <vector>

namespace touchstone::scene {

/// How far a part's surface may be off its ball or disc, over the depth to which the part is pressed in. A ball's
/// facets leave s^2 / (8 R) with edges of length s.
inline constexpr double tip_tolerance_rel = 0.02;

/// The same of a disc's rounded rim, which carries less than its face.
inline constexpr double rim_tolerance_rel = 0.03;

/// One ball for each connected part of the mesh that touches at one of the times: of least squares through the edges'
/// middles, so that the facets are on average on it. Parts of one ball are one tip. A part that is no ball may be a
/// flat disc with a rounded rim. Where what is below the rest surface is neither, vertices less deep than a third of
/// their part's deepest are left out: the body yields there.
/// @param scene  with a mesh tool; @param times_s  of the track
/// @returns the tips, none where the mesh stays apart; or in words why there are none
[[nodiscard]] FoundTips mesh_tips(const Scene& scene, const std::vector<double>& times_s);

}  // namespace touchstone::scene
