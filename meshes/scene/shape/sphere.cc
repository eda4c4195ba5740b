#include "scene/shape/sphere.h"

#include "scene/shape/crossing.h"
#include "scene/shape/octants.h"

#include <numbers>

namespace touchstone::scene {

SurfacePoint Sphere::at(int patch, double u, double v) const noexcept {
  const Vec3 normal = octant_point(patch, u, v);
  return {center_m_ + radius_m_ * normal, normal, 1.0 / radius_m_, 1.0 / radius_m_};
}

SurfaceQuery Sphere::query(const Vec3& p_m) const noexcept {
  const Distance d = distance_at(p_m.x(), p_m.y(), p_m.z());
  const Vec3 normal(d.nx, d.ny, d.nz);
  return {d.signed_distance_m, center_m_ + radius_m_ * normal, normal, octant_of(normal)};
}

double Sphere::signed_distance_m(const Vec3& p_m) const noexcept { return (p_m - center_m_).norm() - radius_m_; }

double Sphere::area_m2() const noexcept { return 4.0 * std::numbers::pi * radius_m_ * radius_m_; }

double Sphere::volume_m3() const noexcept { return 4.0 / 3.0 * std::numbers::pi * radius_m_ * radius_m_ * radius_m_; }

Bounds Sphere::bounds() const noexcept {
  return {center_m_ - Vec3::Constant(radius_m_), center_m_ + Vec3::Constant(radius_m_)};
}

Crossing Sphere::crossing(const Vec3& from_m, const Vec3& to_m) const noexcept {
  const Line line(from_m, to_m);
  return cross_unit_ball(line, (from_m - center_m_) / radius_m_, line.direction / radius_m_);
}

Surface Sphere::tessellated(int triangles) const {
  return octant_surface(triangles, [&](const Vec3& unit) { return SurfacePoint{center_m_ + radius_m_ * unit, unit}; });
}

}  // namespace touchstone::scene
