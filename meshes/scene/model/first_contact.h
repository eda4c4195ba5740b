// Where a tool first meets the rest body along a line, and whether a track ever does.
#pragma once

#include "scene/model/scene.h"

#include <optional>
#include <string>

namespace touchstone::scene {

/// The least signed distance of the rest body over the tool [m], to 1e-8 of the body's size: the gap while they are
/// apart, minus rest_depth_m when not. Of a mesh tool the surface counts, not the space within.
[[nodiscard]] double gap_m(const Shape& body, const Tool& tool, const Pose& pose);

/// How far the tool, at the pose's orientation, must move from the pose along a direction to where it first
/// touches the body, coming from far away [m]; negative beyond that place. Nothing if it never touches.
/// By the bodies' exact shapes rather than by FCL on their triangles: this layer is below FCL, and triangles of a round
/// shape meet some micrometres late. Exact to rounding for a ball or capsule, else to about
/// 1e-10 of the body's size.
/// @param direction  of any length above zero
[[nodiscard]] std::optional<double> first_contact_m(const Shape& body, const Tool& tool, const Pose& pose,
                                                    const Vec3& direction);

/// One sentence when the tool never gets into the body on the scene's track, with the least gap and when, or when it
/// does so only between the instants that both sides record; else empty. Judged by the shapes at rest, at the track's
/// poses, at the recorded instants and at 200 even times. Empty, too, for a scene without a track.
[[nodiscard]] std::string no_contact_warning(const Scene& scene);

}  // namespace touchstone::scene
