// Parametric surfaces of bodies and tools: what the paper asks of an undeformed surface (section II-A)
// and what contact detection asks of it: an exact signed distance.
#pragma once

#include "scene/base/frames.h"
#include "scene/base/inline.h"

namespace touchstone::scene {

/// A point of the surface with its differential geometry.
struct SurfacePoint {
  Vec3 point_m;
  Vec3 normal;  ///< outward, unit length
  /// Principal curvatures [1/m], larger first; positive where the surface bends away from the
  /// outward normal (a sphere of radius R has +1/R twice), zero on a flat face.
  double curvature_max_per_m = 0.0;
  double curvature_min_per_m = 0.0;
};

/// Answer to a closest-point query.
struct SurfaceQuery {
  double signed_distance_m;  ///< negative inside
  Vec3 point_m;              ///< closest surface point
  Vec3 normal;               ///< gradient of the signed distance; unit length, outward
  int patch;                 ///< patch that holds the closest point
};

/// Signed distance, negative inside, and its gradient, as plain numbers for loops over columns of points.
struct Distance {
  double signed_distance_m;
  double nx, ny, nz;
};

/// The part of a straight line inside a shape, as distances from the line's beginning [m]; none where leave <= enter.
struct Crossing {
  double enter_m = 0.0, leave_m = 0.0;

  [[nodiscard]] bool empty() const noexcept { return !(leave_m > enter_m); }
};

struct Surface;

/// A closed convex surface made of smooth patches, each parametrised over (u, v) in [0,1]^2.
/// Immutable; every query is noexcept and free of heap use, so a real-time step may call it.
///
/// Loops over many points use the class itself and members that are not virtual, if the class has them: distance_at()
/// of a point inside, beyond() or may_touch() as a cheap first test, closest(), and exit_along(), the distance to the
/// surface. Whatever they have not is made of the virtual ones.
class Shape {
 public:
  virtual ~Shape() = default;
  [[nodiscard]] virtual int patch_count() const noexcept = 0;
  /// Surface point of a patch. @param u, v in [0,1]; a patch may collapse one side to a point.
  [[nodiscard]] virtual SurfacePoint at(int patch, double u, double v) const noexcept = 0;
  /// Exact signed distance with closest point and normal, for any finite p_m.
  /// At a point equally near to several surface points one of them is chosen, always the same.
  [[nodiscard]] virtual SurfaceQuery query(const Vec3& p_m) const noexcept = 0;
  /// Exact signed distance alone [m], negative inside.
  [[nodiscard]] virtual double signed_distance_m(const Vec3& p_m) const noexcept = 0;
  /// The part of the line between two points that lies inside. A shape without a closed form has cross_convex().
  [[nodiscard]] virtual Crossing crossing(const Vec3& from_m, const Vec3& to_m) const noexcept;
  /// Number of the smooth face that holds the patch, from 0 up; faces meet at edges.
  [[nodiscard]] virtual int face_of(int) const noexcept { return 0; }
  [[nodiscard]] virtual double area_m2() const noexcept = 0;
  [[nodiscard]] virtual double volume_m3() const noexcept = 0;
  [[nodiscard]] virtual Bounds bounds() const noexcept = 0;
  /// The shape's own pattern of triangles, see surface.h.
  [[nodiscard]] virtual Surface tessellated(int triangles) const = 0;
};

}  // namespace touchstone::scene
