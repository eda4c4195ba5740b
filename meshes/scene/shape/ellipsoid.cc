#include "scene/shape/ellipsoid.h"

#include "scene/base/index.h"
#include "scene/shape/crossing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

/// Legendre's form of the ellipsoid's area.
double ellipsoid_area_m2(Vec3 semi_m) {
  std::sort(semi_m.data(), semi_m.data() + 3, std::greater<>());
  const double a = semi_m[0], b = semi_m[1], c = semi_m[2];
  if (a == c) return 4.0 * std::numbers::pi * a * a;
  const double cos_phi = c / a, sin_phi = std::sqrt((a - c) * (a + c)) / a, phi = std::acos(cos_phi);
  const double k = std::min(1.0, a / b * std::sqrt((b - c) * (b + c) / ((a - c) * (a + c))));
  const double sum = std::ellint_2(k, phi) * sin_phi * sin_phi + std::ellint_1(k, phi) * cos_phi * cos_phi;
  return 2.0 * std::numbers::pi * (c * c + a * b * sum / sin_phi);
}

}  // namespace

Ellipsoid::Ellipsoid(const Vec3& center_m, const Vec3& semi_axes_m)
    : center_m_(center_m),
      semi_axes_m_(semi_axes_m),
      per_axis_per_m_(semi_axes_m.cwiseInverse()),
      area_m2_(ellipsoid_area_m2(semi_axes_m)) {
  std::stable_sort(longest_first_.begin(), longest_first_.end(),
                   [&](int a, int b) { return semi_axes_m[a] > semi_axes_m[b]; });
  const double least_m = semi_axes_m.minCoeff();
  for (int i = 0; i < 3; ++i) {
    const double axis_m = semi_axes_m[nth(longest_first_, i)];
    excess_[i] = (axis_m - least_m) * (axis_m + least_m) / (least_m * least_m);
  }
}

SurfacePoint Ellipsoid::at(int patch, double u, double v) const noexcept {
  const Vec3 place = octant_point(patch, u, v);
  const Vec3 gradient = place.cwiseQuotient(semi_axes_m_);
  const double steepness = gradient.norm();
  const Vec3 normal = gradient / steepness;
  // The shape operator is diag(1 / a^2) in the tangent plane, divided by the gradient's length.
  const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
  const Vec3 along = first.cwiseQuotient(semi_axes_m_), across = second.cwiseQuotient(semi_axes_m_);
  const double mean = 0.5 * (along.squaredNorm() + across.squaredNorm()) / steepness;
  const double half_gap = std::hypot(0.5 * (along.squaredNorm() - across.squaredNorm()), along.dot(across)) / steepness;
  // From the Gaussian curvature, without cancellation if the two differ much.
  const double root = 1.0 / (semi_axes_m_.prod() * steepness * steepness);
  const double largest = mean + half_gap;
  return {center_m_ + semi_axes_m_.cwiseProduct(place), normal, largest, std::min(largest, root * root / largest)};
}

Vec3 Ellipsoid::closest_on_unit_sphere(const Vec3& local_m) const noexcept {
  // With axes sorted and scaled by the shortest, the closest point is x_i = a_i p_i / (t + d_i), where t > 0 solves
  // |p_i / (t + d_i)| = 1, p_i = (d_i + 1) |y_i| / a_i and d_i = (a_i / a_min)^2 - 1 (Eberly).
  Vec3 p, q;
  double t = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int axis = nth(longest_first_, i);
    p[i] = (excess_[i] + 1.0) * std::abs(local_m[axis]) / semi_axes_m_[axis];
    // Its square would underflow.
    if (p[i] < 1e-150) p[i] = 0.0;
    t = std::max(t, p[i] - excess_[i]);
  }
  const auto ratio = [&](int i) { return p[i] > 0.0 ? p[i] / (t + excess_[i]) : 0.0; };
  for (int i = 0; i < 3; ++i) q[i] = ratio(i);
  if (t == 0.0 && q.squaredNorm() <= 1.0) {
    // On the middle plane inside the focal ellipse two points are equally close.
    q[2] = std::sqrt(1.0 - q.squaredNorm());
  } else {
    // 1 / |q(t)| is concave and increasing: starting from the left, Newton's method never overshoots.
    for (int iteration = 0; iteration < 100; ++iteration) {
      const double length = q.norm();
      double slope = 0.0;
      for (int i = 0; i < 3; ++i) slope += p[i] > 0.0 ? q[i] * q[i] / (t + excess_[i]) : 0.0;
      const double next = t + length * length * (length - 1.0) / slope;
      if (!(next > t) || length <= 1.0 + 4e-16) break;
      t = next;
      for (int i = 0; i < 3; ++i) q[i] = ratio(i);
    }
    q.normalize();
  }
  Vec3 place;
  for (int i = 0; i < 3; ++i) {
    const int axis = nth(longest_first_, i);
    place[axis] = local_m[axis] < 0.0 ? -q[i] : q[i];
  }
  return place;
}

SurfaceQuery Ellipsoid::query(const Vec3& p_m) const noexcept {
  const Vec3 local = p_m - center_m_;
  const Vec3 place = closest_on_unit_sphere(local);
  const Vec3 normal = place.cwiseQuotient(semi_axes_m_).normalized();
  const Vec3 surface = semi_axes_m_.cwiseProduct(place);
  return {(local - surface).dot(normal), center_m_ + surface, normal, octant_of(place)};
}

double Ellipsoid::signed_distance_m(const Vec3& p_m) const noexcept {
  const Vec3 local = p_m - center_m_;
  const Vec3 place = closest_on_unit_sphere(local);
  return (local - semi_axes_m_.cwiseProduct(place)).dot(place.cwiseQuotient(semi_axes_m_).normalized());
}

double Ellipsoid::area_m2() const noexcept { return area_m2_; }

double Ellipsoid::volume_m3() const noexcept { return 4.0 / 3.0 * std::numbers::pi * semi_axes_m_.prod(); }

Bounds Ellipsoid::bounds() const noexcept { return {center_m_ - semi_axes_m_, center_m_ + semi_axes_m_}; }

Crossing Ellipsoid::crossing(const Vec3& from_m, const Vec3& to_m) const noexcept {
  const Line line(from_m, to_m);
  return cross_unit_ball(line, (from_m - center_m_).cwiseQuotient(semi_axes_m_),
                         line.direction.cwiseQuotient(semi_axes_m_));
}

Surface Ellipsoid::tessellated(int triangles) const {
  return octant_surface(triangles, [&](const Vec3& unit) {
    return SurfacePoint{center_m_ + semi_axes_m_.cwiseProduct(unit), unit.cwiseQuotient(semi_axes_m_).normalized()};
  });
}

}  // namespace touchstone::scene
