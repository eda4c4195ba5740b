// Contact with the already deformed body (section VI): a later region sees Shape_{i-1}, the body under the regions
// before it. Instead of a distance to that shape, which changes every tick, its points are taken back to the body at
// rest.
#pragma once

#include "fast/contact_detection.h"
#include "scene/shape.h"

#include <cmath>

namespace touchstone::fast {

/// A point taken back: as far from the body at rest as the given one is from the deformed body.
struct PulledBack {
  scene::Vec3 x_m;           ///< beside the rest point whose displaced place is the closest of the deformed surface
  double signed_distance_m;  ///< to both, negative inside
};

/// Two steps to the rest point c whose displaced place y(c) = c + u(c) is closest to p. First x' = p - u(c(x')),
/// started from p, with c(x) the closest rest point: p then stands over y(c) along the rest normal. On a slope of the
/// deformed surface that is not the shortest way, so the second step is a Newton step along the slope, from u around c.
/// @param displacement_at Vec3 (const scene::SurfaceQuery&) noexcept: u of a rest point [m], world; also asked up to
/// 1e-4
///   of the body's size beyond a patch's border
template <class DisplacementAt>
[[nodiscard]] PulledBack pulled_back(const scene::Shape& shape, double size_m, const DisplacementAt& displacement_at,
                                     const scene::Vec3& p_W_m) noexcept {
  using scene::Vec3;
  const scene::SurfaceQuery start = shape.query(p_W_m);
  const scene::SurfaceQuery over = shape.query(p_W_m - displacement_at(start));

  const double step_m = 1e-4 * size_m;
  const Vec3 u_m = displacement_at(over);
  const auto u_beside_m = [&](const Vec3& t) {
    return displacement_at(scene::SurfaceQuery{0.0, over.point_m + step_m * t, over.normal, over.patch});
  };
  const Vec3 t1 = over.normal.unitOrthogonal(), t2 = over.normal.cross(t1);
  const Vec3 y1 = t1 + (u_beside_m(t1) - u_m) / step_m;
  const Vec3 y2 = t2 + (u_beside_m(t2) - u_m) / step_m;
  const Vec3 off_m = p_W_m - over.point_m - u_m;
  const double a11 = y1.squaredNorm(), a12 = y1.dot(y2), a22 = y2.squaredNorm(), b1 = y1.dot(off_m), b2 = y2.dot(off_m);
  const double determinant = a11 * a22 - a12 * a12;
  Vec3 normal = y1.cross(y2);
  const double area = normal.norm();
  // A surface folded flat has no slope to follow.
  if (!(determinant > 1e-6) || !(area > 0.0))
    return {over.point_m + over.normal.dot(off_m) * over.normal, over.normal.dot(off_m)};
  normal /= area;
  const Vec3 along_m = ((a22 * b1 - a12 * b2) * t1 + (a11 * b2 - a12 * b1) * t2) / determinant;
  const scene::SurfaceQuery closest = shape.query(over.point_m + along_m);
  const Vec3 rest_off_m = p_W_m - closest.point_m - displacement_at(closest);
  const double distance_m = rest_off_m.dot(normal);
  return {closest.point_m + distance_m * closest.normal, distance_m};
}

/// Takes every point back and drops those that are not inside, so that what is then found out about the points and the
/// rest shape (Summarise, MeasureDepths) is true of the given points and the deformed one. World coordinates and
/// depth_m change; tool coordinates stay, for forces act where the tool is.
template <class DisplacementAt>
void pull_back(const scene::Shape& shape, const DisplacementAt& displacement_at, RegionPoints& points) noexcept {
  const scene::Bounds bounds = shape.bounds();
  const double size_m = (bounds.upper_m - bounds.lower_m).maxCoeff();
  int kept = 0;
  for (int i = 0; i < points.count; ++i) {
    const PulledBack back = pulled_back(shape, size_m, displacement_at, points.p_W_m(static_cast<std::size_t>(i)));
    if (!(back.signed_distance_m < 0.0)) continue;
    if (kept != i) points.move(i, kept);
    const auto k = static_cast<std::size_t>(kept++);
    points.x_W_m[k] = back.x_m.x();
    points.y_W_m[k] = back.x_m.y();
    points.z_W_m[k] = back.x_m.z();
    points.depth_m[k] = -back.signed_distance_m;
  }
  points.count = kept;
}

}  // namespace touchstone::fast
