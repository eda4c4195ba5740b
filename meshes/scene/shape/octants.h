// The octants of the unit sphere: patches of spheres and ellipsoids.
#pragma once

#include "scene/shape/surface.h"

#include <functional>

namespace touchstone::scene {

/// Patch of a point from the middle or of a normal there; bit 0: x < 0, bit 1: y < 0, bit 2: z < 0.
[[nodiscard]] inline int octant_of(const Vec3& n) noexcept {
  return (n.x() < 0.0 ? 1 : 0) | (n.y() < 0.0 ? 2 : 0) | (n.z() < 0.0 ? 4 : 0);
}

/// Point of the unit sphere. @param u, v in [0,1]
[[nodiscard]] Vec3 octant_point(int patch, double u, double v) noexcept;

/// n^2 triangles in each octant, as a sphere over the flat octahedron gives them.
/// @param place takes a point of the unit sphere to a vertex
[[nodiscard]] Surface octant_surface(int triangles, const std::function<SurfacePoint(const Vec3&)>& place);

}  // namespace touchstone::scene
