#include "fast/contact/mass_distribution.h"

#include "fast/contact/point_loops.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// r_i^2 about the line through the mass centre along d [m^2].
double lever_arm2_m2(const RegionPoints& points, std::size_t i, const Vec3& d_T) noexcept {
  const Vec3 p(points.x_T_m[i], points.y_T_m[i], points.z_T_m[i]);
  return (p - p.dot(d_T) * d_T).squaredNorm();
}

void normalise(RegionPoints& points, double sum) noexcept {
  const auto count = static_cast<std::size_t>(points.count);
  if (sum > 0.0) {
    for (std::size_t i = 0; i < count; ++i) points.share[i] /= sum;
  } else {
    for (std::size_t i = 0; i < count; ++i) points.share[i] = 1.0 / points.count;
  }
}

}  // namespace

void distribute_mass_published(const Vec3& d_T, const CellGroups&, CellIntegrals&, RegionPoints& points) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    points.share[i] = std::sqrt(lever_arm2_m2(points, i, d_T)) * points.cos_theta[i];
    sum += points.share[i];
  }
  normalise(points, sum);
}

double mean_inverse_distance_per_m(double r2_m2, double disc_radius_m) noexcept {
  const double R = disc_radius_m, R2_m2 = R * R;
  if (r2_m2 > 9.0 * R2_m2) {
    const double x = R2_m2 / r2_m2;
    return (1.0 + x * (1.0 / 8.0 + x * (3.0 / 64.0 + x * (25.0 / 1024.0)))) / std::sqrt(r2_m2);
  }
  // The potential of a disc: complete elliptic integrals of x, the smaller of r and R over the larger, by Abramowitz
  // and Stegun 17.3.34 and 17.3.36 (2e-8).
  const bool beneath = r2_m2 <= R2_m2;
  const double x2 = beneath ? r2_m2 / R2_m2 : R2_m2 / r2_m2;
  const double m = std::max(1.0 - x2, 1e-12), log = -std::log(m);
  const double E = 1.0 + m * (0.44325141463 + m * (0.06260601220 + m * (0.04757383546 + m * 0.01736506451))) +
                   m * (0.24998368310 + m * (0.09200180037 + m * (0.04069697526 + m * 0.00526449639))) * log;
  if (beneath) return 4.0 / (std::numbers::pi * R) * E;
  const double K = 1.38629436112 + m * (0.09666344259 + m * (0.03590092383 + m * (0.03742563713 + m * 0.01451196212))) +
                   (0.5 + m * (0.12498593597 + m * (0.06880248576 + m * (0.03328355346 + m * 0.00441787012)))) * log;
  return 4.0 * std::sqrt(r2_m2) / (std::numbers::pi * R2_m2) * (E - m * K);
}

namespace {

/// Mean of 1 / r over a polygon in the plane, r from the origin [1/m]: sums over its sides.
double mean_over_polygon_per_m(std::span<const Eigen::Vector2d> corner_m) noexcept {
  double sum_m = 0.0, area_m2 = 0.0;
  const Eigen::Vector2d* before = &corner_m.back();
  double before_m = before->norm();
  for (const Eigen::Vector2d& b : corner_m) {
    const Eigen::Vector2d& a = *std::exchange(before, &b);
    const double b_m = b.norm(), a_m = std::exchange(before_m, b_m);
    const double twice_m2 = a.x() * b.y() - a.y() * b.x(), dot_m2 = a.dot(b), product_m2 = a_m * b_m;
    const double side_m = (b - a).norm(), both_m = a_m + b_m;
    area_m2 += 0.5 * twice_m2;
    // A side in line with the origin adds nothing.
    if (!(std::abs(twice_m2) > 1e-14 * both_m * both_m)) continue;
    // ((|a| + |b|)^2 - |b - a|^2) / 2, without cancellation for an origin close to the side.
    const double beyond_m2 = dot_m2 < 0.0 ? twice_m2 * twice_m2 / (product_m2 - dot_m2) : product_m2 + dot_m2;
    sum_m += twice_m2 / side_m * std::log((both_m + side_m) * (both_m + side_m) / (2.0 * beyond_m2));
  }
  return sum_m / area_m2;
}

/// Moments of a piece of surface projected along d, about the line through the mass centre.
struct Projected {
  double area_m2;
  double r2_m2;                 ///< squared distance of its middle
  double along1_m2, along2_m2;  ///< its spread's two vectors times the middle's place
  double variance_m2;           ///< its spread across d

  Projected(double part_m2, const Vec3& center_T_m, const Spread& spread_m, const Vec3& d_T) noexcept
      : area_m2(part_m2) {
    const double on_line_m = center_T_m.dot(d_T), up1_m = spread_m[0].dot(d_T), up2_m = spread_m[1].dot(d_T);
    r2_m2 = std::max(0.0, center_T_m.squaredNorm() - on_line_m * on_line_m);
    along1_m2 = spread_m[0].dot(center_T_m) - up1_m * on_line_m;
    along2_m2 = spread_m[1].dot(center_T_m) - up2_m * on_line_m;
    variance_m2 = spread_m[0].squaredNorm() + spread_m[1].squaredNorm() - up1_m * up1_m - up2_m * up2_m;
  }
  /// Too near for the first terms of a series.
  [[nodiscard]] bool near() const noexcept { return !(r2_m2 > 6.0 * variance_m2); }
  /// Integral of 1 / r [m], where that is not near.
  [[nodiscard]] double over_distance_m() const noexcept {
    const double inverse_per_m2 = 1.0 / r2_m2;
    const double across_m2 = 3.0 * (along1_m2 * along1_m2 + along2_m2 * along2_m2) * inverse_per_m2 - variance_m2;
    return area_m2 * std::sqrt(inverse_per_m2) * (1.0 + 0.5 * across_m2 * inverse_per_m2);
  }
};

/// Integral of 1 / r over a whole cell, by its shape where it is near [m].
double over_distance_m(const SurfaceCell& cell, const CellGroups& groups, const Vec3& d_T) noexcept {
  const double area_m2 = cell.area_m2 * cell.normal_T.dot(d_T);
  if (!(area_m2 > 0.0)) return 0.0;
  const Projected whole(area_m2, cell.center_T_m, cell.spread_m, d_T);
  if (!whole.near()) return whole.over_distance_m();
  if (cell.group >= 0) {
    double sum_m = 0.0;
    for (const SurfaceCell& half : halves(cell, groups)) sum_m += over_distance_m(half, groups, d_T);
    return sum_m;
  }
  const Vec3 u_T = d_T.unitOrthogonal(), v_T = d_T.cross(u_T);
  const Outline border = outline(cell);
  std::array<Eigen::Vector2d, 10> corner_m;
  for (std::size_t k = 0; k < border.corners; ++k)
    corner_m[k] = {border.corner_T_m[k].dot(u_T), border.corner_T_m[k].dot(v_T)};
  const double mean_per_m = mean_over_polygon_per_m({corner_m.data(), border.corners});
  // No shape has more than the disc about the line; one seen from its edge has rounding in place of an area.
  const double most_per_m = 2.0 * std::sqrt(std::numbers::pi / area_m2);
  return area_m2 * (mean_per_m > 0.0 && mean_per_m < most_per_m ? mean_per_m : most_per_m);
}

}  // namespace

double CellIntegrals::over_distance_m(const SurfaceCell& cell, const CellGroups& groups, const Vec3& d_T) noexcept {
  // By its place in memory, which says nothing about the cell that is there now.
  Kept& kept = kept_[std::bit_cast<std::uintptr_t>(&cell) / sizeof(SurfaceCell) % kept_.size()];
  if (kept.area_m2 != cell.area_m2 || kept.center_T_m != cell.center_T_m || kept.d_T != d_T)
    kept = {cell.center_T_m, d_T, cell.area_m2, fast::over_distance_m(cell, groups, d_T)};
  return kept.over_distance_m;
}

void distribute_mass_corrected(const Vec3& d_T, const CellGroups& groups, CellIntegrals& integrals,
                               RegionPoints& points) noexcept {
  set_shares(d_T, points);
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    if (points.share[i] == near_the_line) {
      const double area_m2 = points.area_m2[i] * points.cos_theta[i];
      points.share[i] = points.cell[i] != nullptr
                            ? integrals.over_distance_m(*points.cell[i], groups, d_T)
                            : area_m2 * mean_inverse_distance_per_m(
                                            Projected(area_m2, points.p_T_m(i), points.spread_T_m(i), d_T).r2_m2,
                                            std::sqrt(area_m2 / std::numbers::pi));
    }
    sum += points.share[i];
  }
  normalise(points, sum);
}

}  // namespace touchstone::fast
