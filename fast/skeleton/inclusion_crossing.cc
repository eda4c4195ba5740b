#include "fast/skeleton/inclusion_crossing.h"

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// A straight line by its length; of no length: nothing crosses it.
struct Line {
  Line(const Vec3& from, const Vec3& to) noexcept : from_m(from), length_m((to - from).norm()) {
    if (length_m > 0.0) direction = (to - from) / length_m;
  }
  [[nodiscard]] Vec3 at(double t_m) const noexcept { return from_m + t_m * direction; }
  [[nodiscard]] Crossing within(double enter_m, double leave_m) const noexcept {
    const double enter = std::max(enter_m, 0.0), leave = std::min(leave_m, length_m);
    return leave > enter ? Crossing{enter, leave} : Crossing{};
  }
  Vec3 from_m, direction = Vec3::Zero();
  double length_m;
};

Crossing cross_box(const scene::Shape& shape, const Vec3& from_m, const Vec3& to_m) noexcept {
  const auto& box = static_cast<const scene::Box&>(shape);
  const Line line(from_m, to_m);
  double enter_m = 0.0, leave_m = line.length_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double place = from_m[axis] - box.center_m()[axis], half = box.half_m()[axis], step = line.direction[axis];
    if (step == 0.0) {
      if (std::abs(place) >= half) return {};
      continue;
    }
    const double low = (-half - place) / step, high = (half - place) / step;
    enter_m = std::max(enter_m, std::min(low, high));
    leave_m = std::min(leave_m, std::max(low, high));
  }
  return line.within(enter_m, leave_m);
}

/// The ball |m + t d| < 1.
Crossing cross_unit_ball(const Line& line, const Vec3& m, const Vec3& d) noexcept {
  const double dd = d.squaredNorm();
  if (!(dd > 0.0)) return {};
  const double closest = -m.dot(d) / dd;
  // From the point of closest approach: the difference of squares loses nothing there.
  const double nearest = (m + closest * d).norm();
  if (!(nearest < 1.0)) return {};
  const double half = std::sqrt((1.0 - nearest) * (1.0 + nearest) / dd);
  return line.within(closest - half, closest + half);
}

Crossing cross_sphere(const scene::Shape& shape, const Vec3& from_m, const Vec3& to_m) noexcept {
  const auto& sphere = static_cast<const scene::Sphere&>(shape);
  const Line line(from_m, to_m);
  return cross_unit_ball(line, (from_m - sphere.center_m()) / sphere.radius_m(), line.direction / sphere.radius_m());
}

Crossing cross_ellipsoid(const scene::Shape& shape, const Vec3& from_m, const Vec3& to_m) noexcept {
  const auto& ellipsoid = static_cast<const scene::Ellipsoid&>(shape);
  const Line line(from_m, to_m);
  return cross_unit_ball(line, (from_m - ellipsoid.center_m()).cwiseQuotient(ellipsoid.semi_axes_m()),
                         line.direction.cwiseQuotient(ellipsoid.semi_axes_m()));
}

/// The signed distance and its slope at a place on the line.
struct Height {
  double t_m, phi_m, slope;
};

Height height_at(const scene::Shape& shape, const Line& line, double t_m) noexcept {
  const scene::SurfaceQuery query = shape.query(line.at(t_m));
  return {t_m, query.signed_distance_m, query.normal.dot(line.direction)};
}

/// Where the signed distance vanishes between a place outside and one inside.
double surface_between(const scene::Shape& shape, const Line& line, const Height& outside, double inside_m) noexcept {
  Height here = outside;
  double beyond_m = inside_m;
  for (int i = 0; i < 60 && std::abs(here.phi_m) > 1e-14 * line.length_m; ++i) {
    double next_m = here.slope != 0.0 ? here.t_m - here.phi_m / here.slope : beyond_m;
    // Rounding alone can lead out of the bracket.
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

Crossing cross_convex(const scene::Shape& shape, const Vec3& from_m, const Vec3& to_m) noexcept {
  const Line line(from_m, to_m);
  if (!(line.length_m > 0.0)) return {};
  const Height begin = height_at(shape, line, 0.0), end = height_at(shape, line, line.length_m);
  // Somewhere inside, or the tangents say that there is no such place.
  Height low = begin, high = end;
  double inside_m = begin.phi_m < 0.0 ? 0.0 : end.phi_m < 0.0 ? line.length_m : -1.0;
  for (int i = 0; i < 80 && inside_m < 0.0; ++i) {
    // A line that leaves the shape at its beginning, or comes closer up to its end.
    if (low.slope >= 0.0 || high.slope <= 0.0) return {};
    // The lines through both ends with their slopes bound the distance from below.
    const double meet_m =
        (high.phi_m - low.phi_m + low.slope * low.t_m - high.slope * high.t_m) / (low.slope - high.slope);
    if (low.phi_m + low.slope * (meet_m - low.t_m) >= 0.0) return {};
    const double middle_m = 0.5 * (low.t_m + high.t_m);
    // Every other time the middle, so that the bracket always shrinks.
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

Cross crossing_of(const scene::Shape& shape) noexcept {
  if (dynamic_cast<const scene::Box*>(&shape) != nullptr) return cross_box;
  if (dynamic_cast<const scene::Sphere*>(&shape) != nullptr) return cross_sphere;
  if (dynamic_cast<const scene::Ellipsoid*>(&shape) != nullptr) return cross_ellipsoid;
  return cross_convex;
}

std::vector<Inclusion> inclusions_of(const scene::Body& body) {
  std::vector<Inclusion> inclusions;
  for (const scene::Inclusion& part : body.inclusions) {
    if (inclusions.size() == inclusions_max) break;
    std::shared_ptr<const scene::Shape> shape = scene::solid_shape(part, part.center_m);
    const Cross cross = crossing_of(*shape);
    inclusions.push_back({std::move(shape), part.material.youngs_modulus_pa, cross});
  }
  return inclusions;
}

BeamSegments cut_beam(std::span<const Inclusion> inclusions, const Vec3& anchor_m, const Vec3& contact_m,
                      const BeamMaterial& beam) noexcept {
  std::array<Crossing, inclusions_max> crossing;
  std::array<double, segments_max + 1> cut_m{};
  const std::size_t count = std::min(inclusions.size(), inclusions_max);
  const double line_m = (contact_m - anchor_m).norm();
  const double stretch = line_m > 0.0 ? beam.length_m / line_m : 1.0;
  std::size_t cuts = 1;  // the first stays at 0
  for (std::size_t i = 0; i < count; ++i) {
    crossing[i] = inclusions[i].cross(*inclusions[i].shape, anchor_m, contact_m);
    if (crossing[i].empty()) continue;
    cut_m[cuts++] = crossing[i].enter_m;
    cut_m[cuts++] = crossing[i].leave_m;
  }
  std::sort(cut_m.begin() + 1, cut_m.begin() + static_cast<std::ptrdiff_t>(cuts));
  cut_m[cuts++] = line_m;

  const double second_moment = second_moment_m4(beam.area_m2);
  BeamSegments segments;
  if (cuts == 2) {
    segments.segment[segments.count++] = {beam.length_m, beam.youngs_modulus_pa, beam.area_m2, second_moment};
    return segments;
  }
  for (std::size_t c = 1; c < cuts; ++c) {
    const double length_m = cut_m[c] - cut_m[c - 1];
    if (!(length_m > 0.0)) continue;
    const double middle_m = 0.5 * (cut_m[c] + cut_m[c - 1]);
    double youngs_modulus_pa = beam.youngs_modulus_pa;
    for (std::size_t i = 0; i < count; ++i) {
      const bool within = crossing[i].enter_m < middle_m && middle_m < crossing[i].leave_m;
      if (within) youngs_modulus_pa = inclusions[i].youngs_modulus_pa;
    }
    segments.segment[segments.count++] = {stretch * length_m, youngs_modulus_pa, beam.area_m2, second_moment};
  }
  return segments;
}

}  // namespace touchstone::fast
