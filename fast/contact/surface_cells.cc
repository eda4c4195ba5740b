#include "fast/contact/surface_cells.h"

#include "scene/base/index.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using Eigen::Vector2d;
using scene::Vec3;

Vec3 turned(const Band& band, const Vector2d& rz_m, const Vector2d& azimuth) noexcept {
  return band.axis_T_m + Vec3(rz_m.x() * azimuth.x(), rz_m.x() * azimuth.y(), rz_m.y());
}

double sinc(double x) noexcept { return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x; }

/// Integrals of r, r^2, r z and r n_r along the meridian's part, by its length.
struct MeridianMoments {
  double r_m2, r2_m3, rz_m3, r_out_m2;
};

MeridianMoments meridian_moments(const Band& band) noexcept {
  // Simpson's rule, exact for a straight part. Means from it lie within the surface they are means of.
  const double r0 = band.start_m.x(), z0 = band.start_m.y(), r1 = band.end_m.x(), z1 = band.end_m.y();
  Vector2d middle = 0.5 * (band.start_m + band.end_m);
  double length_m = (band.end_m - band.start_m).norm();
  const Vector2d normal = (band.start_normal + band.end_normal).normalized();
  if (band.arc_radius_m > 0.0) {
    middle = band.arc_center_m + band.arc_radius_m * normal;
    length_m = band.arc_radius_m * band.arc_angle;
  }
  const double r = middle.x(), z = middle.y(), part_m = length_m / 6.0;
  return {part_m * (r0 + 4.0 * r + r1), part_m * (r0 * r0 + 4.0 * r * r + r1 * r1),
          part_m * (r0 * z0 + 4.0 * r * z + r1 * z1),
          part_m * (r0 * band.start_normal.x() + 4.0 * r * normal.x() + r1 * band.end_normal.x())};
}

/// Integral of r along the meridian's part: exact.
double area_per_turn_m2(const Band& band, const MeridianMoments& moments) noexcept {
  if (band.arc_radius_m == 0.0) return moments.r_m2;
  return band.arc_radius_m *
         (band.arc_center_m.x() * band.arc_angle + band.arc_radius_m * (band.end_normal.y() - band.start_normal.y()));
}

/// @param second_m2  mean of x x^T over a surface; what is not in a plane is left out
Spread spread_of(scene::Mat3 second_m2) noexcept {
  Spread spread_m;
  for (Vec3& axis_m : spread_m) {
    Eigen::Index largest = 0;
    const double most_m2 = second_m2.diagonal().maxCoeff(&largest);
    axis_m = most_m2 > 0.0 ? Vec3(second_m2.col(largest) / std::sqrt(most_m2)) : Vec3(Vec3::Zero());
    second_m2 -= axis_m * axis_m.transpose();
  }
  return spread_m;
}

/// Of a flat quadrilateral that may have two corners in one: of its two triangles together.
Spread quadrilateral_spread(const std::array<Vec3, 4>& corner_m) noexcept {
  Vec3 center_sum = Vec3::Zero();
  scene::Mat3 second_sum = scene::Mat3::Zero();
  double area_m2 = 0.0;
  for (std::size_t k = 1; k < 3; ++k) {
    const Vec3 a = corner_m[k] - corner_m[0], b = corner_m[k + 1] - corner_m[0], both = a + b;
    const double part_m2 = 0.5 * a.cross(b).norm();
    area_m2 += part_m2;
    center_sum += part_m2 / 3.0 * both;
    second_sum += part_m2 / 12.0 * (a * a.transpose() + b * b.transpose() + both * both.transpose());
  }
  if (!(area_m2 > 0.0)) return {Vec3::Zero(), Vec3::Zero()};
  const Vec3 center_m = center_sum / area_m2;
  return spread_of(second_sum / area_m2 - center_m * center_m.transpose());
}

double farthest_m(const SurfaceCell& cell) noexcept {
  double farthest2_m2 = 0.0;
  for (int k = 0; k < cell.corners; ++k) farthest2_m2 = std::max(farthest2_m2, nth(cell.corner_m, k).squaredNorm());
  return std::sqrt(farthest2_m2);
}

std::array<SurfaceCell, 2> band_halves(const SurfaceCell& cell) noexcept {
  std::array<Band, 2> half{cell.band, cell.band};
  const Band& whole = cell.band;
  const double along_m =
      whole.arc_radius_m > 0.0 ? whole.arc_radius_m * whole.arc_angle : (whole.end_m - whole.start_m).norm();
  const double around_m = std::max(whole.start_m.x(), whole.end_m.x()) * whole.turn;
  if (along_m >= around_m) {
    Vector2d middle_m = 0.5 * (whole.start_m + whole.end_m), normal = whole.start_normal;
    if (whole.arc_radius_m > 0.0) {
      normal = (whole.start_normal + whole.end_normal).normalized();
      middle_m = whole.arc_center_m + whole.arc_radius_m * normal;
    }
    half[0].end_m = half[1].start_m = middle_m;
    half[0].end_normal = half[1].start_normal = normal;
    half[0].arc_angle = half[1].arc_angle = 0.5 * whole.arc_angle;
  } else {
    half[0].end_azimuth = half[1].start_azimuth = (whole.start_azimuth + whole.end_azimuth).normalized();
    half[0].turn = half[1].turn = 0.5 * whole.turn;
  }
  return {band_cell(half[0]), band_cell(half[1])};
}

std::array<SurfaceCell, 2> flat_halves(const SurfaceCell& cell) noexcept {
  const auto corner = [&](int k) -> Vec3 { return cell.center_T_m + nth(cell.corner_m, k % cell.corners); };
  int longest = 0;
  double length2_m2 = -1.0;
  for (int side = 0; side < cell.corners; ++side) {
    const double here_m2 = (corner(side + 1) - corner(side)).squaredNorm();
    // Sides that differ by rounding are equally long.
    if (here_m2 <= length2_m2 * (1.0 + 1e-12)) continue;
    length2_m2 = here_m2;
    longest = side;
  }
  const Vec3 a = corner(longest), b = corner(longest + 1), c = corner(longest + 2);
  const Vec3 middle = 0.5 * (a + b);
  if (cell.corners == 3) return {flat_cell(std::array{a, middle, c}), flat_cell(std::array{middle, b, c})};
  const Vec3 d = corner(longest + 3);
  const Vec3 opposite = 0.5 * (c + d);
  return {flat_cell(std::array{a, middle, opposite, d}), flat_cell(std::array{middle, b, c, opposite})};
}

}  // namespace

SurfaceCell flat_cell(std::span<const Vec3> corners_T_m) noexcept {
  SurfaceCell cell;
  cell.corners = static_cast<int>(corners_T_m.size());
  // Parallelograms and triangles: the mean of the corners is that of the surface.
  cell.center_T_m.setZero();
  for (const Vec3& corner : corners_T_m) cell.center_T_m += corner / cell.corners;
  for (std::size_t k = 0; k < corners_T_m.size(); ++k) cell.corner_m[k] = corners_T_m[k] - cell.center_T_m;
  const Vec3 across = (corners_T_m[1] - corners_T_m[0]).cross(corners_T_m[2] - corners_T_m[0]);
  const double length_m2 = across.norm();
  cell.area_m2 = cell.corners == 3 ? 0.5 * length_m2 : length_m2;
  cell.normal_T = length_m2 > 0.0 ? Vec3(across / length_m2) : Vec3(Vec3::UnitZ());
  cell.radius_m = farthest_m(cell);
  cell.polygon_m2 = cell.area_m2;
  cell.polygon_center_m.setZero();
  if (cell.corners == 3) {
    cell.spread_m = {(cell.corner_m[1] - cell.corner_m[0]) / std::sqrt(24.0), cell.corner_m[2] / std::sqrt(8.0)};
  } else {
    cell.spread_m = {(cell.corner_m[1] - cell.corner_m[0]) / std::sqrt(12.0),
                     (cell.corner_m[2] - cell.corner_m[1]) / std::sqrt(12.0)};
  }
  return cell;
}

namespace {

/// How far an arc's middle stands off its chord, at most.
double cell_sagitta_m(const Band& band) noexcept { return 0.125 * band.arc_radius_m * band.arc_angle * band.arc_angle; }

/// Height of the parabola over an arc's chord that is tangent to the arc at both ends; the arc lies below it.
double parabola_m(double radius_m, double angle) noexcept {
  const double half = std::min(0.5 * angle, 1.5), sine = half * sinc(half);
  return 0.5 * radius_m * sine * sine / std::sqrt(1.0 - sine * sine);
}

}  // namespace

SurfaceCell band_cell(const Band& band) noexcept {
  SurfaceCell cell;
  cell.band = band;
  cell.curved = true;
  const MeridianMoments moments = meridian_moments(band);
  const Vector2d azimuth = (band.start_azimuth + band.end_azimuth).normalized();
  const double r_m = moments.r2_m3 / moments.r_m2 * sinc(0.5 * band.turn), z_m = moments.rz_m3 / moments.r_m2;
  cell.center_T_m = turned(band, {r_m, z_m}, azimuth);
  // The integral of the normal: r n_z ds is -r dr.
  const double out_m2 = moments.r_out_m2 * band.turn * sinc(0.5 * band.turn),
               up_m2 = 0.5 * band.turn * (band.start_m.x() * band.start_m.x() - band.end_m.x() * band.end_m.x());
  cell.area_m2 = std::sqrt(out_m2 * out_m2 + up_m2 * up_m2);
  const Vector2d normal = Vector2d(out_m2, up_m2) / cell.area_m2;
  cell.normal_T = Vec3(normal.x() * azimuth.x(), normal.x() * azimuth.y(), normal.y());
  cell.corner_m = {turned(band, band.start_m, band.start_azimuth), turned(band, band.start_m, band.end_azimuth),
                   turned(band, band.end_m, band.end_azimuth), turned(band, band.end_m, band.start_azimuth)};
  for (Vec3& corner_m : cell.corner_m) corner_m -= cell.center_T_m;
  // Sagittas around and along, each at most an eighth of the angle squared.
  const double r_m_most = std::max(band.start_m.x(), band.end_m.x());
  cell.bulge_m = 0.125 * ((r_m_most + cell_sagitta_m(band)) * band.turn * band.turn) + cell_sagitta_m(band);
  cell.radius_m = farthest_m(cell) + cell.bulge_m;
  cell.sagitta_m = {parabola_m(r_m_most + cell_sagitta_m(band), band.turn),
                    parabola_m(band.arc_radius_m, band.arc_angle)};
  const double around_m = 0.0625 * (band.start_m.x() + band.end_m.x()) * band.turn * band.turn;
  cell.sag_m = {Vec3(around_m * azimuth.x(), around_m * azimuth.y(), 0.0), cell_sagitta_m(band) * cell.normal_T};
  const CutPolygon::Moments polygon = CutPolygon(cell.corner_m).moments();
  cell.polygon_m2 = polygon.area_m2;
  cell.polygon_center_m = polygon.center_m;
  cell.spread_m = quadrilateral_spread(cell.corner_m);
  // Curvatures along the meridian and around the axis.
  const Vec3 along(-normal.y() * azimuth.x(), -normal.y() * azimuth.y(), normal.x()),
      around(-azimuth.y(), azimuth.x(), 0.0);
  const double along_per_m = band.arc_radius_m > 0.0 ? 1.0 / band.arc_radius_m : 0.0, around_per_m = normal.x() / r_m;
  for (std::size_t k = 0; k < 2; ++k)
    cell.turn[k] =
        along_per_m * along.dot(cell.spread_m[k]) * along + around_per_m * around.dot(cell.spread_m[k]) * around;
  return cell;
}

double band_area_m2(const Band& band) noexcept { return band.turn * area_per_turn_m2(band, meridian_moments(band)); }

Vec3 part_area_m2(const SurfaceCell& cell, double share, const Vec3& off_m) noexcept {
  Vec3 normal = cell.normal_T;
  if (cell.curved || cell.group >= 0) {
    // off_m in the two vectors of the spread.
    const Vec3 &a = cell.spread_m[0], &b = cell.spread_m[1];
    const double aa = a.squaredNorm(), ab = a.dot(b), bb = b.squaredNorm(), det = aa * bb - ab * ab;
    if (det > 1e-9 * aa * bb) {
      const double oa = off_m.dot(a), ob = off_m.dot(b);
      normal += ((oa * bb - ob * ab) * cell.turn[0] + (ob * aa - oa * ab) * cell.turn[1]) / det;
    }
  }
  return share * cell.area_m2 * normal;
}

Outline outline(const SurfaceCell& cell) noexcept {
  Outline border;
  const auto add = [&](const Vec3& corner_m) { border.corner_T_m[border.corners++] = corner_m; };
  constexpr double wide = 0.2;
  if (!cell.curved || cell.band.turn < wide) {
    for (int k = 0; k < cell.corners; ++k) add(cell.center_T_m + nth(cell.corner_m, k));
    return border;
  }
  const Band& band = cell.band;
  std::array<Vector2d, 5> azimuth{band.start_azimuth, {}, {}, {}, band.end_azimuth};
  azimuth[2] = (azimuth[0] + azimuth[4]).normalized();
  const std::size_t step = band.turn < 2.0 * wide ? 2 : 1;
  if (step == 1) {
    azimuth[1] = (azimuth[0] + azimuth[2]).normalized();
    azimuth[3] = (azimuth[2] + azimuth[4]).normalized();
  }
  const auto add_arc = [&](const Vector2d& at_m, auto azimuth_of) {
    if (at_m.x() == 0.0) return add(turned(band, at_m, azimuth[0]));
    for (std::size_t k = 0; k < azimuth.size(); k += step) add(turned(band, at_m, azimuth[azimuth_of(k)]));
  };
  add_arc(band.start_m, [](std::size_t k) { return k; });
  add_arc(band.end_m, [](std::size_t k) { return 4 - k; });
  return border;
}

SurfaceCell CellGroups::cell(std::int32_t child) const noexcept {
  return child >= 0 ? nth(nodes, child).cell : flat_cell(nth(triangles_T_m, ~child));
}

SurfaceCell CellGroups::around(std::span<const std::int32_t> triangles) const {
  SurfaceCell cell;
  Vec3 center_sum = Vec3::Zero(), normal_sum = Vec3::Zero();
  for (const std::int32_t i : triangles) {
    const SurfaceCell part = flat_cell(nth(triangles_T_m, i));
    cell.area_m2 += part.area_m2;
    center_sum += part.area_m2 * part.center_T_m;
    normal_sum += part.area_m2 * part.normal_T;
  }
  cell.center_T_m = center_sum / cell.area_m2;
  const double surface_m2 = cell.area_m2;
  cell.area_m2 = normal_sum.norm();
  cell.normal_T = normal_sum.normalized();
  scene::Mat3 second_m2 = scene::Mat3::Zero(), normal_by_place_m = scene::Mat3::Zero();
  for (const std::int32_t i : triangles) {
    const SurfaceCell part = flat_cell(nth(triangles_T_m, i));
    const Vec3 off_m = part.center_T_m - cell.center_T_m;
    normal_by_place_m += part.area_m2 / cell.area_m2 * part.normal_T * off_m.transpose();
    second_m2 += part.area_m2 / surface_m2 *
                 (off_m * off_m.transpose() + part.spread_m[0] * part.spread_m[0].transpose() +
                  part.spread_m[1] * part.spread_m[1].transpose());
  }
  cell.spread_m = spread_of(second_m2);
  const Eigen::SelfAdjointEigenSolver<scene::Mat3> axes(second_m2);
  // The normal's linear change that has the same moment.
  for (Eigen::Index k = 1; k < 3; ++k) {
    const Vec3 axis = axes.eigenvectors().col(k), change_m = normal_by_place_m * axis;
    if (!(axes.eigenvalues()[k] > 0.0)) continue;
    for (std::size_t j = 0; j < 2; ++j) cell.turn[j] += axis.dot(cell.spread_m[j]) / axes.eigenvalues()[k] * change_m;
  }
  const Vec3 u = axes.eigenvectors().col(2), v = cell.normal_T.cross(u).normalized(), w = u.cross(v);
  Vec3 half_m = Vec3::Zero();
  for (const std::int32_t i : triangles) {
    for (const Vec3& corner_T_m : nth(triangles_T_m, i)) {
      const Vec3 off_m = corner_T_m - cell.center_T_m;
      half_m = half_m.cwiseMax(Vec3(off_m.dot(u), off_m.dot(v), off_m.dot(w)).cwiseAbs());
      cell.radius_m = std::max(cell.radius_m, off_m.norm());
    }
  }
  cell.corner_m = {-half_m.x() * u - half_m.y() * v, half_m.x() * u - half_m.y() * v, half_m.x() * u + half_m.y() * v,
                   -half_m.x() * u + half_m.y() * v};
  cell.bulge_m = half_m.z();
  return cell;
}

std::size_t CellGroups::memory_bytes() const noexcept {
  return nodes.size() * sizeof(Node) + triangles_T_m.size() * sizeof(triangles_T_m[0]);
}

std::array<SurfaceCell, 2> halves(const SurfaceCell& cell, const CellGroups& groups) noexcept {
  std::array<SurfaceCell, 2> parts;
  if (cell.group >= 0) {
    const CellGroups::Node& node = nth(groups.nodes, cell.group);
    parts = {groups.cell(node.child[0]), groups.cell(node.child[1])};
  } else {
    parts = cell.curved ? band_halves(cell) : flat_halves(cell);
  }
  for (SurfaceCell& part : parts) part.sample = cell.sample;
  return parts;
}

CutPolygon::CutPolygon(std::span<const Vec3> corners_m) noexcept : count_(static_cast<int>(corners_m.size())) {
  std::copy(corners_m.begin(), corners_m.end(), corner_m_.begin());
  side_.fill(-1);
}

CutPolygon::CutPolygon(const SurfaceCell& cell) noexcept
    : CutPolygon({cell.corner_m.data(), static_cast<std::size_t>(cell.corners)}) {
  if (cell.corners != 4) return;
  for (std::size_t k = 0; k < 4; ++k) side_[k] = k % 2;
  sag_m_ = cell.sag_m;
}

void CutPolygon::keep_below(std::span<const double> level, const Vec3& normal_T) noexcept {
  const std::array bend{4.0 * normal_T.dot(sag_m_[0]), 4.0 * normal_T.dot(sag_m_[1])};
  std::array<Vec3, max_corners> kept;
  std::array<std::int8_t, max_corners> side;
  cut_ = true;
  std::size_t count = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const std::size_t next = k + 1 == static_cast<std::size_t>(count_) ? 0 : k + 1;
    if (count + 2 > max_corners) break;
    const bool whole = (level[k] < 0.0) == (level[next] < 0.0);
    if (level[k] < 0.0) {
      side[count] = whole ? side_[k] : std::int8_t{-1};
      kept[count++] = corner_m_[k];
    }
    if (whole) continue;
    const double along = crossing(level[k], level[next], side_[k] < 0 ? 0.0 : nth(bend, side_[k]));
    side[count] = -1;
    kept[count++] = corner_m_[k] + along * (corner_m_[next] - corner_m_[k]);
  }
  std::copy_n(kept.begin(), count, corner_m_.begin());
  std::copy_n(side.begin(), count, side_.begin());
  count_ = static_cast<int>(count);
}

void CutPolygon::keep_below(const Vec3& normal_T, double level) noexcept {
  std::array<double, max_corners> at_corner;
  bool cuts = false;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    at_corner[k] = normal_T.dot(corner_m_[k]) + level;
    cuts = cuts || at_corner[k] >= 0.0;
  }
  if (cuts) keep_below({at_corner.data(), static_cast<std::size_t>(count_)}, normal_T);
}

CutPolygon::Moments CutPolygon::moments() const noexcept {
  Moments sum;
  if (count_ < 3) return sum;
  Vec3 center_sum = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < static_cast<std::size_t>(count_); ++k) {
    const double area_m2 = 0.5 * (corner_m_[k] - corner_m_[0]).cross(corner_m_[k + 1] - corner_m_[0]).norm();
    sum.area_m2 += area_m2;
    center_sum += area_m2 / 3.0 * (corner_m_[0] + corner_m_[k] + corner_m_[k + 1]);
  }
  if (sum.area_m2 > 0.0) sum.center_m = center_sum / sum.area_m2;
  return sum;
}

}  // namespace touchstone::fast
