// Closed triangle meshes of rigid tools: areas, volumes, bounds.
#pragma once

#include "scene/base/frames.h"

#include <array>
#include <cstdint>
#include <vector>

namespace touchstone::scene {

/// A closed surface of triangles, counter-clockwise seen from outside, without duplicate or unused vertices. It may
/// have several closed pieces and need not be convex.
struct TriangleMesh {
  Eigen::Matrix3Xd points_m;  ///< one column per vertex
  std::vector<std::array<std::int32_t, 3>> triangles;
  /// One piece without a dent deeper than convex_tolerance_rel of the bounding box's diagonal. Found when read from a
  /// file; any other mesh counts as not convex unless this is set.
  bool convex = false;

  [[nodiscard]] double area_m2() const;
  [[nodiscard]] double volume_m3() const;
  [[nodiscard]] Vec3 centroid_m() const;  ///< of the enclosed volume
  [[nodiscard]] Bounds bounds() const;
};

/// How deep a dent may be in a mesh that counts as convex, over the diagonal of its bounding box. Facets on a curved
/// surface leave such dents where neighbouring rings differ in their number of vertices: 4e-4 on a capsule of 2000
/// triangles, 2e-5 on one of 20,000. Single precision leaves less than 1e-6, and 7e-6 at a hundred diagonals from the
/// origin. A contact that is deeper than the dent spans it, and is one region.
inline constexpr double convex_tolerance_rel = 1e-3;

}  // namespace touchstone::scene
