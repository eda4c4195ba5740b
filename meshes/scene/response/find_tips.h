// Finds the ends of a scene's tool that touch the body.
#pragma once

#include "scene/response/tool_tip.h"

#include <vector>

namespace touchstone::scene {

/// Times of a track at which its contacts are looked at: the recorded instants and the waypoints.
[[nodiscard]] std::vector<double> looked_at_s(const Scene& scene);

[[nodiscard]] FoundTips tool_tips(const Scene& scene);

}  // namespace touchstone::scene
