// Parametric surfaces of bodies and tools: what the paper asks of an undeformed surface (section II-A)
// and what contact detection asks of it: an exact signed distance.
#pragma once

#include "scene/base/frames.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

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

struct Surface;

/// A closed convex surface made of smooth patches, each parametrised over (u, v) in [0,1]^2.
/// Immutable; every query is noexcept and free of heap use, so a real-time step may call it.
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
  [[nodiscard]] virtual double area_m2() const noexcept = 0;
  [[nodiscard]] virtual double volume_m3() const noexcept = 0;
  [[nodiscard]] virtual Bounds bounds() const noexcept = 0;
  /// The shape's own pattern of triangles, see surface.h.
  [[nodiscard]] virtual Surface tessellated(int triangles) const = 0;
};

/// Box with edges along the axes; patches 0..5 are the faces -x, +x, -y, +y, -z, +z.
class Box final : public Shape {
 public:
  /// @param size_m edge lengths, each > 0
  Box(const Vec3& center_m, const Vec3& size_m);
  [[nodiscard]] int patch_count() const noexcept override { return 6; }
  [[nodiscard]] SurfacePoint at(int patch, double u, double v) const noexcept override;
  [[nodiscard]] SurfaceQuery query(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double area_m2() const noexcept override;
  [[nodiscard]] double volume_m3() const noexcept override;
  [[nodiscard]] Bounds bounds() const noexcept override;
  [[nodiscard]] Surface tessellated(int triangles) const override;
  [[nodiscard]] const Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] const Vec3& half_m() const noexcept { return half_m_; }

 private:
  Vec3 center_m_, half_m_;
};

/// Sphere; patches 0..7 are the octants (bit 0: x < 0, bit 1: y < 0, bit 2: z < 0), whose corners
/// are the six anchor points the paper names for a sphere.
class Sphere final : public Shape {
 public:
  /// @param radius_m > 0
  Sphere(const Vec3& center_m, double radius_m);
  [[nodiscard]] int patch_count() const noexcept override { return 8; }
  [[nodiscard]] SurfacePoint at(int patch, double u, double v) const noexcept override;
  [[nodiscard]] SurfaceQuery query(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double area_m2() const noexcept override;
  [[nodiscard]] double volume_m3() const noexcept override;
  [[nodiscard]] Bounds bounds() const noexcept override;
  [[nodiscard]] Surface tessellated(int triangles) const override;
  [[nodiscard]] const Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] double radius_m() const noexcept { return radius_m_; }

 private:
  Vec3 center_m_;
  double radius_m_;
};

/// Ellipsoid with its axes along x, y, z; patches as on a sphere, each octant the sphere's stretched by the semi-axes.
/// From a point on the middle plane that is equally near to two sides, the closest point is the one at larger
/// coordinates; from the centre it is the end of the shortest axis (of equal ones the last).
class Ellipsoid final : public Shape {
 public:
  /// @param semi_axes_m each > 0; equal ones are allowed
  Ellipsoid(const Vec3& center_m, const Vec3& semi_axes_m);
  [[nodiscard]] int patch_count() const noexcept override { return 8; }
  [[nodiscard]] SurfacePoint at(int patch, double u, double v) const noexcept override;
  [[nodiscard]] SurfaceQuery query(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double area_m2() const noexcept override;
  [[nodiscard]] double volume_m3() const noexcept override;
  [[nodiscard]] Bounds bounds() const noexcept override;
  [[nodiscard]] Surface tessellated(int triangles) const override;
  [[nodiscard]] const Vec3& center_m() const noexcept { return center_m_; }
  [[nodiscard]] const Vec3& semi_axes_m() const noexcept { return semi_axes_m_; }

 private:
  /// Closest surface point, each coordinate divided by its semi-axis. @param local_m from the centre
  [[nodiscard]] Vec3 closest_on_unit_sphere(const Vec3& local_m) const noexcept;

  Vec3 center_m_, semi_axes_m_;
  std::array<int, 3> longest_first_{0, 1, 2};
  Vec3 excess_;  ///< (a_i / a_min)^2 - 1, longest axis first
  double area_m2_;
};

}  // namespace touchstone::scene
