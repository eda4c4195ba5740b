#include "scene/shape/crossing.h"

#include <cmath>

namespace touchstone::scene {
namespace {

/// Signed distance and its slope at a place on the line.
struct Height {
  double t_m, phi_m, slope;
};

Height height_at(const Shape& shape, const Line& line, double t_m) noexcept {
  const SurfaceQuery query = shape.query(line.at(t_m));
  return {t_m, query.signed_distance_m, query.normal.dot(line.direction)};
}

/// Zero of the signed distance between a place outside and one inside.
double surface_between(const Shape& shape, const Line& line, const Height& outside, double inside_m) noexcept {
  Height here = outside;
  double beyond_m = inside_m;
  for (int i = 0; i < 60 && std::abs(here.phi_m) > 1e-14 * line.length_m; ++i) {
    double next_m = here.slope != 0.0 ? here.t_m - here.phi_m / here.slope : beyond_m;
    // Rounding can lead out of the bracket.
    if (!((next_m - here.t_m) * (next_m - beyond_m) < 0.0)) next_m = 0.5 * (here.t_m + beyond_m);
    const Height next = height_at(shape, line, next_m);
    if (next.phi_m < 0.0) {
      beyond_m = next_m;
      if (std::abs(beyond_m - here.t_m) <= 1e-13 * line.length_m) return next_m;
      if (next.phi_m > -1e-14 * line.length_m) return next_m;
      continue;
    }
    here = next;
  }
  return here.t_m;
}

}  // namespace

Crossing cross_unit_ball(const Line& line, const Vec3& m, const Vec3& d) noexcept {
  const double dd = d.squaredNorm();
  if (!(dd > 0.0)) return {};
  const double closest = -m.dot(d) / dd;
  // From the point of closest approach, without cancellation.
  const double nearest = (m + closest * d).norm();
  if (!(nearest < 1.0)) return {};
  const double half = std::sqrt((1.0 - nearest) * (1.0 + nearest) / dd);
  return line.within(closest - half, closest + half);
}

Crossing cross_convex(const Shape& shape, const Vec3& from_m, const Vec3& to_m) noexcept {
  const Line line(from_m, to_m);
  if (!(line.length_m > 0.0)) return {};
  const Height begin = height_at(shape, line, 0.0), end = height_at(shape, line, line.length_m);
  // A place inside, unless the tangents show that there is none.
  Height low = begin, high = end;
  double inside_m = begin.phi_m < 0.0 ? 0.0 : end.phi_m < 0.0 ? line.length_m : -1.0;
  for (int i = 0; i < 80 && inside_m < 0.0; ++i) {
    // The line leaves the shape at its beginning, or still approaches it at its end.
    if (low.slope >= 0.0 || high.slope <= 0.0) return {};
    // The tangents at both ends bound the distance from below.
    const double meet_m =
        (high.phi_m - low.phi_m + low.slope * low.t_m - high.slope * high.t_m) / (low.slope - high.slope);
    if (low.phi_m + low.slope * (meet_m - low.t_m) >= 0.0) return {};
    const double middle_m = 0.5 * (low.t_m + high.t_m);
    // Bisection in every other step, so that the bracket always shrinks.
    const bool use_meet = i % 2 == 0 && meet_m > low.t_m && meet_m < high.t_m;
    const Height here = height_at(shape, line, use_meet ? meet_m : middle_m);
    if (here.phi_m < 0.0) {
      inside_m = here.t_m;
    } else if (here.slope < 0.0) {
      low = here;
    } else {
      high = here;
    }
    if (high.t_m - low.t_m <= 1e-13 * line.length_m) return {};
  }
  if (inside_m < 0.0) return {};
  return line.within(begin.phi_m < 0.0 ? 0.0 : surface_between(shape, line, low, inside_m),
                     end.phi_m < 0.0 ? line.length_m : surface_between(shape, line, high, inside_m));
}

Crossing Shape::crossing(const Vec3& from_m, const Vec3& to_m) const noexcept {
  return cross_convex(*this, from_m, to_m);
}

}  // namespace touchstone::scene
