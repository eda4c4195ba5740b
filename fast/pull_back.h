// Points against a deformed body without a deformed mesh (sections III and VI): what lies at x on the deformed body
// lay at x - u(c) on the body at rest, c the rest surface's point nearest to that.
#pragma once

#include "fast/contact_detection.h"

namespace touchstone::fast {

/// Keeps the points inside the rest surface, in their order.
inline void keep_inside(const scene::Shape& body, RegionPoints& points) noexcept {
  int kept = 0;
  for (int i = 0; i < points.count; ++i) {
    if (!(body.signed_distance_m(points.p_W_m(static_cast<std::size_t>(i))) < 0.0)) continue;
    if (kept != i) points.move(i, kept);
    ++kept;
  }
  points.count = kept;
}

/// Puts every point where the body's rest shape has what the point meets on the deformed body, and keeps the inside
/// ones. A fixed-point iteration: a dimple of 4 mm leaves 41 um after one turn and 7 to 11 um after two.
/// @param displacement scene::SurfaceQuery -> scene::Vec3 [m], world, noexcept
template <class Displacement>
void pull_back(const scene::Shape& body, const Displacement& displacement, RegionPoints& points) noexcept {
  constexpr int turns = 2;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const scene::Vec3 p_W_m = points.p_W_m(i);
    scene::Vec3 at_rest_m = p_W_m;
    for (int turn = 0; turn < turns; ++turn) at_rest_m = p_W_m - displacement(body.query(at_rest_m));
    points.x_W_m[i] = at_rest_m.x();
    points.y_W_m[i] = at_rest_m.y();
    points.z_W_m[i] = at_rest_m.z();
  }
  keep_inside(body, points);
}

}  // namespace touchstone::fast
