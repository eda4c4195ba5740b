#include "fast/skeleton/anchor_points.h"

#include "fast/realtime/wide_loops.h"
#include "scene/base/index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// The found anchor point at a patch's corner.
const FoundAnchor& nearest(const std::vector<FoundAnchor>& found, const Vec3& corner_m) {
  return *std::min_element(found.begin(), found.end(), [&](const FoundAnchor& a, const FoundAnchor& b) {
    return (a.point_m - corner_m).squaredNorm() < (b.point_m - corner_m).squaredNorm();
  });
}

/// Position along the chord of a quarter circle, seen from its centre in direction (c, s).
double chord_part(double c, double s) noexcept { return c + s > 0.0 ? s / (c + s) : 0.0; }

/// Cosine and sine of the parameter at which a quarter of the ellipse with these semi-axes is divided into equal
/// lengths.
Eigen::Vector2d middle_of_quarter(double a, double b) {
  if (a == b) return Eigen::Vector2d::Constant(std::numbers::sqrt2 / 2.0);
  constexpr int steps = 20000;
  constexpr double step = 0.5 * std::numbers::pi / steps;
  const auto speed = [&](int i) {
    const double t = (i + 0.5) * step;
    return std::hypot(a * std::sin(t), b * std::cos(t));
  };
  double whole = 0.0;
  for (int i = 0; i < steps; ++i) whole += speed(i);
  double way = 0.0;
  int i = 0;
  while (way + speed(i) < 0.5 * whole) way += speed(i++);
  const double t = (i + (0.5 * whole - way) / speed(i)) * step;
  return {std::cos(t), std::sin(t)};
}

/// The two axes spanning a face of a box.
struct FaceAxes {
  int u, v;
};
FaceAxes face_axes(int patch) noexcept {
  const int axis = patch / 2;
  return {(axis + 1) % 3, (axis + 2) % 3};
}

/// Bilinear coordinates on a face. @param free 1 for every corner that can move, else 0
TOUCHSTONE_WIDE_LOOPS
void face_places(std::span<const double> u_m, std::span<const double> v_m, const Eigen::Vector2d& center_m,
                 const Eigen::Vector2d& half_m, const std::array<float, patch_corners_max>& free,
                 const PlaceColumns& out) noexcept {
  const double per_u = 0.5 / half_m.x(), per_v = 0.5 / half_m.y(), u0 = center_m.x(), v0 = center_m.y();
  const auto [w0, w1, w2, w3] = out.weight;
  const auto [f0, f1, f2, f3] = free;
  float* f = out.free;
  const std::size_t count = u_m.size();
  // Columns never overlap.
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const auto from_u = static_cast<float>((u_m[i] - u0) * per_u + 0.5);
    const auto from_v = static_cast<float>((v_m[i] - v0) * per_v + 0.5);
    const float above_u = from_u > 0.0f ? from_u : 0.0f, above_v = from_v > 0.0f ? from_v : 0.0f;
    const float u = above_u < 1.0f ? above_u : 1.0f, v = above_v < 1.0f ? above_v : 1.0f;
    const float past_u = 1.0f - u, past_v = 1.0f - v;
    const float a = past_u * past_v, b = u * past_v, c = past_u * v, d = u * v;
    w0[i] = a, w1[i] = b, w2[i] = c, w3[i] = d;
    f[i] = f0 * a + f1 * b + f2 * c + f3 * d;
  }
}

}  // namespace

bool AnchorPoints::first_between_its_anchors(int) const { return true; }

PatchPlace AnchorPoints::place(int patch, const std::array<double, patch_corners_max>& weight) const noexcept {
  PatchPlace place{weight};
  const auto& corner = nth(patches_, patch);
  for (std::size_t k = 0; k < corner.size(); ++k) {
    if (!nth(held_, corner[k])) place.free += weight[k];
  }
  return place;
}

void AnchorPoints::at(int patch, const std::array<std::span<const double>, 3>& p_m,
                      const PlaceColumns& out) const noexcept {
  for (std::size_t i = 0; i < p_m[0].size(); ++i) {
    const PatchPlace place = at(patch, Vec3(p_m[0][i], p_m[1][i], p_m[2][i]));
    for (std::size_t k = 0; k < patch_corners_max; ++k) {
      out.weight[k][i] = static_cast<float>(place.weight[k]);
    }
    out.free[i] = static_cast<float>(place.free);
  }
}

void AnchorPoints::add(const Vec3& point_m, bool held, AnchorReason reason) {
  points_m_.push_back(point_m);
  held_.push_back(held);
  reasons_.push_back(reason);
}

BoxAnchors::BoxAnchors(const scene::Box& box) : box_(box) {
  const std::vector<FoundAnchor> found = find_anchor_points(box);
  for (int i = 0; i < 8; ++i) {
    const Vec3 sign(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    const Vec3 corner_m = box.center_m() + sign.cwiseProduct(box.half_m());
    add(corner_m, (i & 4) == 0, nearest(found, corner_m).reason);
  }
  for (int patch = 0; patch < box.patch_count(); ++patch) {
    const int origin = patch % 2 == 1 ? 1 << patch / 2 : 0;
    const auto [u, v] = face_axes(patch);
    patches_.push_back({origin, origin | 1 << u, origin | 1 << v, origin | 1 << u | 1 << v});
  }
}

std::vector<int> BoxAnchors::around(int patch) const {
  const auto& corner = nth(patches_, patch);
  return {corner[0], corner[1], corner[3], corner[2]};
}

Vec3 BoxAnchors::halfway_m(int, int i, int j) const {
  // Two corners of one face: the straight line between them lies on it.
  return 0.5 * (nth(points_m_, i) + nth(points_m_, j));
}

PatchPlace BoxAnchors::at(int patch, const Vec3& p_m) const noexcept {
  const auto axes = face_axes(patch);
  const Vec3 local = (p_m - box_.center_m()).cwiseQuotient(box_.half_m());
  const double u = std::clamp(0.5 * (local[axes.u] + 1.0), 0.0, 1.0);
  const double v = std::clamp(0.5 * (local[axes.v] + 1.0), 0.0, 1.0);
  return place(patch, {(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v});
}

void BoxAnchors::at(int patch, const std::array<std::span<const double>, 3>& p_m,
                    const PlaceColumns& out) const noexcept {
  const auto axes = face_axes(patch);
  const std::span<const double> u_m = nth(p_m, axes.u), v_m = nth(p_m, axes.v);
  const Eigen::Vector2d center_m(box_.center_m()[axes.u], box_.center_m()[axes.v]);
  const Eigen::Vector2d half_m(box_.half_m()[axes.u], box_.half_m()[axes.v]);
  std::array<float, patch_corners_max> free;
  for (std::size_t k = 0; k < free.size(); ++k) {
    free[k] = nth(held_, nth(patches_, patch)[k]) ? 0.0f : 1.0f;
  }
  face_places(u_m, v_m, center_m, half_m, free, out);
}

EllipsoidAnchors::EllipsoidAnchors(const scene::Sphere& sphere, double support_height_m)
    : EllipsoidAnchors(sphere, sphere.center_m(), Vec3::Constant(sphere.radius_m()), support_height_m) {}

EllipsoidAnchors::EllipsoidAnchors(const scene::Ellipsoid& ellipsoid, double support_height_m)
    : EllipsoidAnchors(ellipsoid, ellipsoid.center_m(), ellipsoid.semi_axes_m(), support_height_m) {}

EllipsoidAnchors::EllipsoidAnchors(const scene::Shape& shape, const Vec3& center_m, const Vec3& semi_axes_m,
                                   double support_height_m)
    : center_m_(center_m), semi_axes_m_(semi_axes_m), support_height_m_(support_height_m) {
  const std::vector<FoundAnchor> found = find_anchor_points(shape);
  for (int i = 0; i < 6; ++i) {
    Vec3 out = Vec3::Zero();
    out[i / 2] = i % 2 == 0 ? semi_axes_m[i / 2] : -semi_axes_m[i / 2];
    // The lowest point is fixed even if the support has no height.
    add(center_m + out, i == 5, nearest(found, center_m + out).reason);
  }
  for (int patch = 0; patch < shape.patch_count(); ++patch) {
    const int x = patch & 1 ? 1 : 0, y = patch & 2 ? 3 : 2, z = patch & 4 ? 5 : 4;
    patches_.push_back({x, y, z, x});
  }
}

std::vector<int> EllipsoidAnchors::around(int patch) const {
  const auto& corner = nth(patches_, patch);
  return {corner[0], corner[1], corner[2]};
}

Vec3 EllipsoidAnchors::halfway_m(int, int i, int j) const {
  // The section through both points is a plane of symmetry, so its ellipse is the shortest curve.
  const int a = i / 2, b = j / 2;
  const Eigen::Vector2d middle = middle_of_quarter(semi_axes_m_[a], semi_axes_m_[b]);
  Vec3 out = Vec3::Zero();
  out[a] = (i % 2 == 0 ? 1.0 : -1.0) * semi_axes_m_[a] * middle.x();
  out[b] = (j % 2 == 0 ? 1.0 : -1.0) * semi_axes_m_[b] * middle.y();
  return center_m_ + out;
}

PatchPlace EllipsoidAnchors::at(int patch, const Vec3& p_m) const noexcept {
  const Vec3 out = (p_m - center_m_).cwiseAbs().cwiseQuotient(semi_axes_m_);
  const Vec3 barycentric = out / out.sum();
  if ((patch & 4) == 0) return place(patch, {barycentric.x(), barycentric.y(), barycentric.z(), 0.0});
  const double height_m = p_m.z() - support_height_m_;
  const double equator_m = center_m_.z() - support_height_m_;
  const double ramp = std::clamp(height_m / equator_m, 0.0, 1.0);
  const double equator = barycentric.x() + barycentric.y();
  if (!(ramp > 0.0 && equator > 0.0)) return place(patch, {0.0, 0.0, 1.0, 0.0});
  return place(patch, {ramp * barycentric.x() / equator, ramp * barycentric.y() / equator, 1.0 - ramp, 0.0});
}

RevolutionAnchors::RevolutionAnchors(const scene::Revolution& revolution, double support_height_m)
    : revolution_(revolution),
      // A flat bottom is fixed as a face, at any height.
      support_height_m_(revolution.flat_bottom() ? -std::numeric_limits<double>::infinity() : support_height_m) {
  const int pieces = revolution.piece_count();
  parts_.resize(static_cast<std::size_t>(pieces));
  for (int k = 0; k < pieces; ++k) {
    nth(parts_, k).arc_begin_m = length_m_;
    length_m_ += revolution.piece(k).length_m;
  }
  // Corner k of the profile is the lower end of piece k; the last corner is the upper pole.
  std::vector<bool> circle(static_cast<std::size_t>(pieces) + 1, false);
  std::vector<AnchorReason> reason(circle.size(), AnchorReason::sphere_axis);
  find_circles(circle, reason);

  std::vector<int> anchor_of_corner(circle.size(), -1);
  const bool bottom_cap = revolution.piece(0).whole, top_cap = revolution.piece(pieces - 1).whole;
  for (int corner = 0; corner <= pieces; ++corner) {
    const auto c = static_cast<std::size_t>(corner);
    const bool pole = (corner == 0 && !bottom_cap) || (corner == pieces && !top_cap);
    if (!pole && !circle[c]) continue;
    anchor_of_corner[c] = static_cast<int>(points_m_.size());
    const bool held = at_or_below_support(height_m(corner)) || corner == 0 || (corner == 1 && bottom_cap);
    const double arc_m = corner == pieces ? length_m_ : parts_[c].arc_begin_m;
    for (int quarter = 0; quarter < (pole ? 1 : 4); ++quarter) {
      add(on_surface_m(arc_m, pole ? 0.0 : quarter), held, reason[c]);
      anchor_arc_m_.push_back(arc_m);
      anchor_quarter_.push_back(pole ? -1 : quarter);
    }
  }
  place_bands(anchor_of_corner);

  for (int patch = 0; patch < revolution.patch_count(); ++patch) {
    const Part& part = nth(parts_, revolution.piece_of(patch));
    const int q = revolution.quadrant_of(patch), next = (q + 1) % 4;
    switch (part.kind) {
      case Kind::band:
        patches_.push_back({part.low + q, part.low + next, part.high + q, part.high + next});
        break;
      case Kind::sector_down:
        patches_.push_back({part.high + q, part.high + next, part.low, part.high + q});
        break;
      case Kind::sector_up:
        patches_.push_back({part.low + q, part.low + next, part.high, part.low + q});
        break;
      case Kind::cap: {
        const int rim = std::max(part.low, part.high);
        patches_.push_back({rim, rim + 1, rim + 2, rim + 3});
        break;
      }
    }
  }
}

void RevolutionAnchors::find_circles(std::vector<bool>& circle, std::vector<AnchorReason>& reason) const {
  const auto poles = circle.size() - 1;
  bool any = false;
  reason.front() = AnchorReason::support;
  for (const CurveAnchor& found : profile_anchors(revolution_)) {
    // Pieces are lines and arcs, so the rule's points lie at their ends.
    const auto corner = static_cast<std::size_t>(found.piece) + (found.s > 0.5 ? 1 : 0);
    reason[corner] = found.reason;
    if (corner > 0 && corner < poles) any = circle[corner] = true;
  }
  if (any) return;
  for (std::size_t corner = 1; corner < poles; ++corner) circle[corner] = true;
}

double RevolutionAnchors::height_m(int corner) const noexcept {
  const int pieces = revolution_.piece_count();
  const double z_m = corner < pieces ? revolution_.piece(corner).start_m.y() : revolution_.piece(corner - 1).end_m.y();
  return revolution_.offset_m().z() + z_m;
}

bool RevolutionAnchors::at_or_below_support(double height_m) const noexcept {
  // Up to rounding, a circle at the support's height belongs to the support.
  return height_m <= support_height_m_ + 1e-9 * length_m_;
}

void RevolutionAnchors::place_bands(const std::vector<int>& anchor_of_corner) {
  const int pieces = revolution_.piece_count();
  const auto ends_a_band = [&](int corner) {
    return corner == 0 || corner == pieces || nth(anchor_of_corner, corner) >= 0;
  };
  const auto corner_arc_m = [&](int corner) { return corner == pieces ? length_m_ : nth(parts_, corner).arc_begin_m; };
  for (int k = 0; k < pieces; ++k) {
    Part& part = nth(parts_, k);
    int low = k, high = k + 1;
    while (!ends_a_band(low)) --low;
    while (!ends_a_band(high)) ++high;
    part.first_piece = low;
    part.low = nth(anchor_of_corner, low);
    part.high = nth(anchor_of_corner, high);
    part.kind = part.low < 0 || part.high < 0 ? Kind::cap
                : low == 0                    ? Kind::sector_down
                : high == pieces              ? Kind::sector_up
                                              : Kind::band;
    part.low_m = corner_arc_m(low);
    part.high_m = corner_arc_m(high);
    part.band_top_m = height_m(high);
    part.crosses = !at_or_below_support(part.band_top_m) && at_or_below_support(height_m(low));
    part.rim_m = part.high_m - part.low_m;
    if (part.kind == Kind::cap && part.high < 0 && nth(held_, part.low)) {
      int last = low;
      while (part.crosses && at_or_below_support(height_m(last + 1))) ++last;
      part.held_rim_m = part.crosses ? length_m_ - arc_at_height_m(last, support_height_m_) : part.rim_m;
    }
  }
}

double RevolutionAnchors::arc_m(int piece, const Eigen::Vector2d& rz_m) const noexcept {
  const scene::RevolutionPiece& p = revolution_.piece(piece);
  double s;
  if (p.straight()) {
    s = (rz_m - p.start_m).dot(p.end_m - p.start_m) / (p.length_m * p.length_m);
  } else {
    const Eigen::Vector2d out = rz_m - p.center_m;
    s = (std::atan2(out.y(), out.x()) - p.start_angle) / (p.end_angle - p.start_angle);
  }
  return nth(parts_, piece).arc_begin_m + std::clamp(s, 0.0, 1.0) * p.length_m;
}

double RevolutionAnchors::arc_at_height_m(int piece, double height_m) const {
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double s = 0.5 * (low + high);
    (revolution_.offset_m().z() + revolution_.meridian(piece, s).rz_m.y() < height_m ? low : high) = s;
  }
  return nth(parts_, piece).arc_begin_m + high * revolution_.piece(piece).length_m;
}

Vec3 RevolutionAnchors::on_surface_m(double arc_m, double quarters) const {
  int piece = 0;
  while (piece + 1 < revolution_.piece_count() && nth(parts_, piece + 1).arc_begin_m <= arc_m) {
    ++piece;
  }
  const double s = (arc_m - nth(parts_, piece).arc_begin_m) / revolution_.piece(piece).length_m;
  const Eigen::Vector2d rz = revolution_.meridian(piece, arc_m == length_m_ ? 1.0 : s).rz_m;
  const auto whole = static_cast<int>(quarters);
  const double angle = 0.5 * std::numbers::pi * (quarters - whole);
  Vec3 out(rz.x() * std::cos(angle), rz.x() * std::sin(angle), rz.y());
  for (int turn = 0; turn < whole; ++turn) out = Vec3(-out.y(), out.x(), out.z());
  return revolution_.offset_m() + out;
}

std::vector<int> RevolutionAnchors::around(int patch) const {
  const auto& corner = nth(patches_, patch);
  switch (nth(parts_, revolution_.piece_of(patch)).kind) {
    case Kind::band:
      return {corner[0], corner[1], corner[3], corner[2]};
    case Kind::cap:
      return {corner[0], corner[1], corner[2], corner[3]};
    default:
      return {corner[0], corner[1], corner[2]};
  }
}

bool RevolutionAnchors::first_between_its_anchors(int patch) const {
  const int piece = revolution_.piece_of(patch);
  const Part& part = nth(parts_, piece);
  // A cap counts once, whether its first piece has one patch or four.
  return piece == part.first_piece && (part.kind != Kind::cap || revolution_.quadrant_of(patch) <= 0);
}

Vec3 RevolutionAnchors::halfway_m(int patch, int i, int j) const {
  const Part& part = nth(parts_, revolution_.piece_of(patch));
  const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
  const int qi = anchor_quarter_[a], qj = anchor_quarter_[b];
  if (part.kind == Kind::cap) {
    // Opposite points are joined across the axis, neighbours by the surface above their chord.
    if ((qi - qj) % 2 == 0) return on_surface_m(part.low < 0 ? 0.0 : length_m_, 0.0);
    return revolution_.query(0.5 * (points_m_[a] + points_m_[b])).point_m;
  }
  double quarters = 0.5 * (qi + qj);
  if (qi < 0 || qj < 0) quarters = std::max(qi, qj);
  if (std::abs(qi - qj) == 3 && qi >= 0 && qj >= 0) quarters = 3.5;
  return on_surface_m(0.5 * (anchor_arc_m_[a] + anchor_arc_m_[b]), quarters);
}

PatchPlace RevolutionAnchors::at(int patch, const Vec3& p_m) const noexcept {
  const int piece = revolution_.piece_of(patch), quadrant = revolution_.quadrant_of(patch);
  const Part& part = nth(parts_, piece);
  const Vec3 local_m = p_m - revolution_.offset_m();
  const double r_m = std::hypot(local_m.x(), local_m.y());
  const double along_m = arc_m(piece, {r_m, local_m.z()});
  const double over_support_m = p_m.z() - support_height_m_;
  const double x = r_m > 0.0 ? local_m.x() / r_m : 1.0, y = r_m > 0.0 ? local_m.y() / r_m : 0.0;

  // phi' within the quadrant; a full cap has no quadrant.
  const double c = quadrant == 0 ? x : quadrant == 1 ? y : quadrant == 2 ? -x : -y;
  const double s = quadrant == 0 ? y : quadrant == 1 ? -x : quadrant == 2 ? -y : x;
  const double phi = chord_part(std::max(c, 0.0), std::max(s, 0.0));
  // Bilinear coordinates in the square of a cap's four points.
  const auto square = [&](double t) {
    const double a = t * x / (std::abs(x) + std::abs(y)), b = t * y / (std::abs(x) + std::abs(y));
    return Eigen::Vector2d(std::clamp(0.5 * (1.0 + a + b), 0.0, 1.0), std::clamp(0.5 * (1.0 - a + b), 0.0, 1.0));
  };
  // Distance from the cap's pole, at the bottom or at the top.
  const double from_pole_m = part.low < 0 ? along_m : length_m_ - along_m;

  double band = std::clamp((along_m - part.low_m) / (part.high_m - part.low_m), 0.0, 1.0);
  if (part.crosses) band = std::clamp(over_support_m / (part.band_top_m - support_height_m_), 0.0, 1.0);
  switch (part.kind) {
    case Kind::band:
      return place(patch, {(1.0 - band) * (1.0 - phi), (1.0 - band) * phi, band * (1.0 - phi), band * phi});
    case Kind::sector_down:
      return place(patch, {band * (1.0 - phi), band * phi, 1.0 - band, 0.0});
    case Kind::sector_up:
      return place(patch, {(1.0 - band) * (1.0 - phi), (1.0 - band) * phi, band, 0.0});
    case Kind::cap:
      break;
  }
  const Eigen::Vector2d uv = square(std::min(1.0, from_pole_m / part.rim_m));
  const double u = uv.x(), v = uv.y();
  PatchPlace at = place(patch, {u * (1.0 - v), u * v, (1.0 - u) * v, (1.0 - u) * (1.0 - v)});
  // All anchor points of the cap are fixed, but its middle can move.
  if (part.held_rim_m > 0.0) at.free = std::max(0.0, 1.0 - from_pole_m / part.held_rim_m);
  return at;
}

std::unique_ptr<const AnchorPoints> anchor_points(const scene::Body& body, const scene::Shape& shape) {
  switch (body.shape) {
    case scene::BodyShape::box:
      return std::make_unique<BoxAnchors>(static_cast<const scene::Box&>(shape));
    case scene::BodyShape::sphere:
      return std::make_unique<EllipsoidAnchors>(static_cast<const scene::Sphere&>(shape), body.support_height_m);
    case scene::BodyShape::ellipsoid:
      return std::make_unique<EllipsoidAnchors>(static_cast<const scene::Ellipsoid&>(shape), body.support_height_m);
    case scene::BodyShape::revolution:
      return std::make_unique<RevolutionAnchors>(static_cast<const scene::Revolution&>(shape), body.support_height_m);
  }
  return nullptr;
}

}  // namespace touchstone::fast
