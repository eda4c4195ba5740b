#include "scene/shape/revolution.h"

#include "scene/shape/surface_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

using Vec2 = Eigen::Vector2d;

constexpr double pi = std::numbers::pi;

/// Collinear straight pieces are joined.
Profile joined(const Profile& profile) {
  Profile out;
  double angle_before = 0.0;
  for (std::size_t i = 0; i + 1 < profile.rz_m.size(); ++i) {
    const RevolutionPiece piece = profile_piece(profile, i);
    const bool in_line = i > 0 && piece.straight() && out.arc_radius_m.back() == 0.0 &&
                         std::abs(piece.start_angle - angle_before) <= smooth_turn;
    if (!in_line) {
      out.rz_m.push_back(piece.start_m);
      out.arc_radius_m.push_back(piece.radius_m);
      angle_before = piece.start_angle;
    }
  }
  out.rz_m.push_back(profile.rz_m.back());
  return out;
}

/// Azimuthal unit vector in the plane; the quadrants use the same numbers exactly, so that their borders coincide.
Eigen::Vector2d around(int quadrant, double u) noexcept {
  const double c = u == 1.0 ? 0.0 : std::cos(quarter * u), s = u == 1.0 ? 1.0 : std::sin(quarter * u);
  switch (quadrant) {
    case 1:
      return {-s, c};
    case 2:
      return {-c, -s};
    case 3:
      return {s, -c};
    default:
      return {c, s};
  }
}

int quadrant_of_point(double x, double y) noexcept {
  if (x > 0.0 && y >= 0.0) return 0;
  if (x <= 0.0 && y > 0.0) return 1;
  if (x < 0.0) return 2;
  return y < 0.0 ? 3 : 0;
}

/// Width and height of the triangles. A disc of n rings with 1, 2, ... n segments per quadrant has triangles pi / 2
/// times as wide as high; bands use the same ratio, so that all areas are similar.
struct Pattern {
  double width_m, height_m;

  [[nodiscard]] int segments(double r_m) const {
    return r_m == 0.0 ? 0 : std::max(1, static_cast<int>(std::lround(0.5 * std::numbers::pi * r_m / width_m)));
  }
  [[nodiscard]] int rows(double length_m) const {
    return std::max(1, static_cast<int>(std::lround(length_m / height_m)));
  }
};

/// A ring of the piece; place s along it, segments per quadrant.
struct Ring {
  double s;
  int segments;
};

/// The piece's rings from its start up.
std::vector<Ring> rings_of(const Revolution& shape, int index, const Pattern& pattern) {
  const RevolutionPiece& piece = shape.piece(index);
  const bool disc = piece.whole && piece.straight() && piece.start_m.y() == piece.end_m.y();
  const double rim_m = std::max(piece.start_m.x(), piece.end_m.x());
  const int rows = disc ? pattern.segments(rim_m) : pattern.rows(piece.length_m);
  std::vector<Ring> rings;
  for (int k = 0; k <= rows; ++k) {
    const double s = static_cast<double>(k) / rows;
    const int segments = disc ? (index == 0 ? k : rows - k) : pattern.segments(shape.meridian(index, s).rz_m.x());
    rings.push_back({s, segments});
  }
  return rings;
}

void add_quadrant(const Revolution& shape, int index, int quadrant, const std::vector<Ring>& rings,
                  SurfaceBuilder& builder) {
  builder.begin_patch();
  const int patch = shape.piece(index).first_patch + quadrant;
  std::vector<int> begin;
  for (const Ring& ring : rings) {
    for (int i = 0; i <= ring.segments; ++i) {
      const double u = ring.segments > 0 ? static_cast<double>(i) / ring.segments : 0.5;
      const SurfacePoint p = shape.at(patch, u, ring.s);
      const int vertex = builder.add_vertex(p.point_m, p.normal);
      if (i == 0) begin.push_back(vertex);
    }
  }
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
    join_rows(
        rings[k].segments, rings[k + 1].segments, static_cast<int>(k), [&](int i) { return begin[k] + i; },
        [&](int j) { return begin[k + 1] + j; }, [&](int a, int b, int c) { builder.add_triangle(a, b, c); });
  }
}

/// Vertices from the axis outwards, ring by ring.
void add_cap(const Revolution& shape, int index, std::vector<Ring> rings, SurfaceBuilder& builder) {
  builder.begin_patch();
  const bool top = index > 0;
  const int patch = shape.piece(index).first_patch;
  if (top) std::reverse(rings.begin(), rings.end());
  std::vector<int> begin;
  for (const Ring& ring : rings) {
    const int around = std::max(1, 4 * ring.segments);
    for (int i = 0; i < around; ++i) {
      // Each quadrant has its own segments, as the neighbouring patches do.
      const int quadrant = ring.segments > 0 ? i / ring.segments : 0;
      const double u = ring.segments > 0 ? static_cast<double>(i % ring.segments) / ring.segments : 0.0;
      const SurfacePoint p = shape.at_quadrant(patch, quadrant, u, ring.s);
      const int vertex = builder.add_vertex(p.point_m, p.normal);
      if (i == 0) begin.push_back(vertex);
    }
  }
  for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      const auto vertex = [&](std::size_t ring, int i) {
        const int n = rings[ring].segments;
        return begin[ring] + (n > 0 ? (quadrant * n + i) % (4 * n) : 0);
      };
      const auto inner = [&](int i) { return vertex(k, i); };
      const auto outer = [&](int i) { return vertex(k + 1, i); };
      join_rows(rings[k].segments, rings[k + 1].segments, static_cast<int>(k), inner, outer, [&](int a, int b, int c) {
        // Seen from above, outwards from the axis is downwards.
        top ? builder.add_triangle(a, c, b) : builder.add_triangle(a, b, c);
      });
    }
  }
}

}  // namespace

Revolution::Revolution(Profile profile, const Vec3& offset_m) : offset_m_(offset_m) {
  profile = joined(profile);
  const std::size_t last = profile.rz_m.size() - 2;
  for (std::size_t i = 0; i <= last; ++i) {
    RevolutionPiece piece = profile_piece(profile, i);
    const bool level_start = i == 0 && piece.start_angle <= smooth_turn - quarter;
    const bool level_end = i == last && piece.end_angle >= quarter - smooth_turn;
    piece.whole = level_end || (level_start && piece.straight());
    // A dome is centred on the axis; this removes the rounding of its centre.
    if ((level_start || level_end) && !piece.straight()) piece.center_m.x() = 0.0;
    piece.first_patch = patch_count_;
    patch_count_ += piece.patch_count();
    radius_m_ = std::max({radius_m_, piece.start_m.x(), piece.end_m.x()});
    if (piece.start_angle < 0.0 && piece.end_angle > 0.0 && !piece.straight()) {
      radius_m_ = std::max(radius_m_, piece.center_m.x() + piece.radius_m);
    }
    pieces_.push_back(piece);
  }
  size_m_ = std::max(radius_m_, pieces_.back().end_m.y() - pieces_.front().start_m.y());
}

int Revolution::piece_of(int patch) const noexcept {
  int index = 0;
  while (index + 1 < piece_count() && piece(index + 1).first_patch <= patch) ++index;
  return index;
}

int Revolution::face_of(int patch) const noexcept {
  constexpr double edge_rad = 1e-6;
  int face = 0;
  for (int index = piece_of(patch); index > 0; --index) {
    if (std::abs(piece(index).start_angle - piece(index - 1).end_angle) > edge_rad) ++face;
  }
  return face;
}

int Revolution::quadrant_of(int patch) const noexcept {
  const RevolutionPiece& p = piece(piece_of(patch));
  return p.whole ? -1 : patch - p.first_patch;
}

Revolution::MeridianPoint Revolution::meridian(int index, double s) const noexcept {
  const RevolutionPiece& p = piece(index);
  if (p.straight()) {
    const Vec2 rz = s == 1.0 ? p.end_m : Vec2(p.start_m + s * (p.end_m - p.start_m));
    const Vec2 normal = Vec2(p.end_m.y() - p.start_m.y(), p.start_m.x() - p.end_m.x()) / p.length_m;
    // The curvature at the tip of a cone is unbounded; keep it finite.
    return {rz, normal, 0.0, normal.x() / std::max(rz.x(), 1e-9 * size_m_)};
  }
  const double angle = p.start_angle + s * (p.end_angle - p.start_angle);
  Vec2 normal(std::cos(angle), std::sin(angle));
  if (s == 0.0) normal = (p.start_m - p.center_m).normalized();
  if (s == 1.0) normal = (p.end_m - p.center_m).normalized();
  const Vec2 rz = s == 0.0 ? p.start_m : s == 1.0 ? p.end_m : Vec2(p.center_m + p.radius_m * normal);
  const double along = 1.0 / p.radius_m;
  return {rz, normal, along, p.center_m.x() == 0.0 ? along : normal.x() / std::max(rz.x(), 1e-9 * size_m_)};
}

SurfacePoint Revolution::at_quadrant(int patch, int quadrant, double u, double s) const noexcept {
  const MeridianPoint m = meridian(piece_of(patch), s);
  const Vec2 out = around(quadrant, u);
  return {offset_m_ + Vec3(m.rz_m.x() * out.x(), m.rz_m.x() * out.y(), m.rz_m.y()),
          Vec3(m.normal.x() * out.x(), m.normal.x() * out.y(), m.normal.y()),
          std::max(m.curvature_along_per_m, m.curvature_around_per_m),
          std::min(m.curvature_along_per_m, m.curvature_around_per_m)};
}

SurfacePoint Revolution::at(int patch, double u, double v) const noexcept {
  const int index = piece_of(patch);
  const RevolutionPiece& p = piece(index);
  if (!p.whole) return at_quadrant(patch, patch - p.first_patch, u, v);
  const int quadrant = std::clamp(static_cast<int>(4.0 * u), 0, 3);
  return at_quadrant(patch, quadrant, 4.0 * u - quadrant, index == 0 ? v : 1.0 - v);
}

Revolution::Foot Revolution::foot(const Eigen::Vector2d& p_m) const noexcept {
  Foot best;
  double nearest_m = INFINITY;
  bool inside = true, at_corner = false;
  for (int index = 0; index < piece_count(); ++index) {
    const RevolutionPiece& p = piece(index);
    const Vec2 chord = p.end_m - p.start_m, local = p_m - p.start_m;
    bool left = cross(chord, local) >= 0.0, within;
    double distance_m;
    Vec2 rz, normal;
    if (p.straight()) {
      const Vec2 along = chord / p.length_m;
      const double way_m = local.dot(along);
      within = way_m >= 0.0 && way_m <= p.length_m;
      rz = way_m <= 0.0 ? p.start_m : way_m >= p.length_m ? p.end_m : Vec2(p.start_m + way_m * along);
      distance_m = within ? std::abs(cross(along, local)) : (p_m - rz).norm();
      normal = Vec2(along.y(), -along.x());
    } else {
      const Vec2 radial = p_m - p.center_m, first = p.start_m - p.center_m, last = p.end_m - p.center_m;
      const double length_m = radial.norm();
      within = cross(first, radial) >= 0.0 && cross(radial, last) >= 0.0;
      if (within) {
        normal = length_m > 0.0 ? Vec2(radial / length_m) : Vec2(first / p.radius_m);
        rz = p.center_m + p.radius_m * normal;
        distance_m = std::abs(length_m - p.radius_m);
      } else {
        const bool to_start = (p_m - p.start_m).squaredNorm() <= (p_m - p.end_m).squaredNorm();
        rz = to_start ? p.start_m : p.end_m;
        normal = (to_start ? first : last) / p.radius_m;
        distance_m = (p_m - rz).norm();
      }
      left = left || length_m <= p.radius_m;
    }
    inside = inside && left;
    if (distance_m < nearest_m) {
      nearest_m = distance_m;
      at_corner = !within;
      best = {rz, normal, distance_m, index};
    }
  }
  if (inside) best.signed_distance_m = -nearest_m;
  // Outside a corner the normal points from the corner to p; otherwise it is the piece's own.
  if (!inside && at_corner && nearest_m > 1e-12 * size_m_) best.normal = (p_m - best.rz_m) / nearest_m;
  return best;
}

SurfaceQuery Revolution::query(const Vec3& p_m) const noexcept {
  const Vec3 local = p_m - offset_m_;
  const double r = std::sqrt(local.x() * local.x() + local.y() * local.y());
  const Vec2 out = r > 0.0 ? Vec2(local.x() / r, local.y() / r) : Vec2(1.0, 0.0);
  const Foot f = foot({r, local.z()});
  const RevolutionPiece& p = piece(f.piece);
  const int patch = p.first_patch + (p.whole ? 0 : quadrant_of_point(local.x(), local.y()));
  return {f.signed_distance_m, offset_m_ + Vec3(f.rz_m.x() * out.x(), f.rz_m.x() * out.y(), f.rz_m.y()),
          Vec3(f.normal.x() * out.x(), f.normal.x() * out.y(), f.normal.y()), patch};
}

double Revolution::signed_distance_m(const Vec3& p_m) const noexcept {
  const Vec3 local = p_m - offset_m_;
  return foot({std::sqrt(local.x() * local.x() + local.y() * local.y()), local.z()}).signed_distance_m;
}

double Revolution::area_m2() const noexcept {
  // Pappus: the path of the piece's centroid, 2 pi r, times its length.
  double area_m2 = 0.0;
  for (const RevolutionPiece& p : pieces_) {
    const double moment_m2 = p.straight() ? 0.5 * (p.start_m.x() + p.end_m.x()) * p.length_m
                                          : p.center_m.x() * p.length_m + p.radius_m * (p.end_m.y() - p.start_m.y());
    area_m2 += 2.0 * pi * moment_m2;
  }
  return area_m2;
}

double Revolution::volume_m3() const noexcept {
  // pi times the integral of r^2 dz along the profile.
  double volume_m3 = 0.0;
  for (const RevolutionPiece& p : pieces_) {
    const double r0 = p.start_m.x(), r1 = p.end_m.x();
    if (p.straight()) {
      volume_m3 += pi / 3.0 * (r0 * r0 + r0 * r1 + r1 * r1) * (p.end_m.y() - p.start_m.y());
      continue;
    }
    // r = c + R cos(t), dz = R cos(t) dt.
    const auto integral = [&](double t) {
      const double sine = std::sin(t), c = p.center_m.x(), R = p.radius_m;
      return R * (c * c * sine + c * R * (t + sine * std::cos(t)) + R * R * (sine - sine * sine * sine / 3.0));
    };
    volume_m3 += pi * (integral(p.end_angle) - integral(p.start_angle));
  }
  return volume_m3;
}

Bounds Revolution::bounds() const noexcept {
  return {offset_m_ + Vec3(-radius_m_, -radius_m_, pieces_.front().start_m.y()),
          offset_m_ + Vec3(radius_m_, radius_m_, pieces_.back().end_m.y())};
}

Surface Revolution::tessellated(int triangles) const {
  const double triangle_m2 = area_m2() / triangles;
  const double width_m = std::sqrt(std::numbers::pi * triangle_m2);
  const Pattern pattern{width_m, 2.0 * triangle_m2 / width_m};
  SurfaceBuilder builder;
  for (int index = 0; index < piece_count(); ++index) {
    const std::vector<Ring> rings = rings_of(*this, index, pattern);
    if (piece(index).whole) {
      add_cap(*this, index, rings, builder);
    } else {
      for (int quadrant = 0; quadrant < 4; ++quadrant) add_quadrant(*this, index, quadrant, rings, builder);
    }
  }
  return builder.finish();
}

}  // namespace touchstone::scene
