// The pieces of a profile with their circles and angles, for the checks and for the shape.
#pragma once

#include "scene/shape/revolution.h"

namespace touchstone::scene {

/// Turn below which two pieces of a profile meet smoothly [rad].
constexpr double smooth_turn = 1e-7;

/// Without its patches. @param index of the corner where it starts
[[nodiscard]] RevolutionPiece profile_piece(const Profile& profile, std::size_t index) noexcept;

}  // namespace touchstone::scene
