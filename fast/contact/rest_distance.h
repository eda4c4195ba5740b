// What contact detection asks the rest shape about every sample in every tick (section III): its own quick answers,
// where the shape's class has them, else those of the interface.
#pragma once

#include "scene/shape/convex_exit.h"
#include "scene/shape/shape.h"

namespace touchstone::fast {

/// Signed distance [m] of a point of the world, negative inside, and its gradient for an inside point: the outward
/// normal of the rest surface at the closest point.
struct RestDistance {
  double signed_distance_m;
  scene::Vec3 normal;
};

/// @param p_m inside the body; outside, only the sign of the distance is right for a box
template <class Body>
[[nodiscard]] RestDistance rest_distance(const Body& body, const scene::Vec3& p_m) noexcept {
  if constexpr (requires { body.distance_at(0.0, 0.0, 0.0); }) {
    const scene::Distance d = body.distance_at(p_m.x(), p_m.y(), p_m.z());
    return {d.signed_distance_m, {d.nx, d.ny, d.nz}};
  } else {
    const scene::SurfaceQuery closest = body.query(p_m);
    return {closest.signed_distance_m, closest.normal};
  }
}

/// Closest point of the rest surface.
template <class Body>
[[nodiscard]] scene::SurfaceQuery closest(const Body& body, const scene::Vec3& p_m) noexcept {
  if constexpr (requires { body.closest(p_m); }) {
    return body.closest(p_m);
  } else {
    return body.query(p_m);
  }
}

/// A quick beyond() answers first whether a point is surely outside.
template <class Body>
inline constexpr bool knows_beyond = requires(const Body& body) {
  body.beyond(0.0, 0.0, 0.0, 0.0);
};

/// True only if the point is outside by more than margin_m: a cheap first question.
template <class Body>
[[nodiscard]] bool surely_beyond(const Body& body, const scene::Vec3& p_m, double margin_m) noexcept {
  if constexpr (knows_beyond<Body>) return body.beyond(p_m.x(), p_m.y(), p_m.z(), margin_m) > 0.0;
  return false;
}

/// False only if the whole ball about p_m is outside; of an ellipsoid, true for some of those, too.
template <class Body>
[[nodiscard]] bool may_touch(const Body& body, const scene::Vec3& p_m, double radius_m) noexcept {
  // Not "!(>)": a centre at NaN distance is outside.
  if constexpr (knows_beyond<Body>) {
    return body.beyond(p_m.x(), p_m.y(), p_m.z(), radius_m) <= 0.0;
  } else if constexpr (requires { body.may_touch(p_m, radius_m); }) {
    return body.may_touch(p_m, radius_m);
  } else {
    return body.signed_distance_m(p_m) <= radius_m;
  }
}

/// Way from inside points along one direction to the rest surface [m]; zero for a point on it or outside.
/// @param direction unit length
template <class Body>
[[nodiscard]] auto exit_along(const Body& body, const scene::Vec3& direction) noexcept {
  if constexpr (requires { body.exit_along(direction); }) {
    return body.exit_along(direction);
  } else {
    return scene::ConvexExit<Body>(body, direction);
  }
}

}  // namespace touchstone::fast
