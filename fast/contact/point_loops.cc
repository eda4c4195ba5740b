#include "fast/contact/point_loops.h"

#include "fast/realtime/wide_loops.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

TOUCHSTONE_INLINE double larger(double a, double b) noexcept { return a < b ? b : a; }
TOUCHSTONE_INLINE double smaller(double a, double b) noexcept { return b < a ? b : a; }

/// Numbers of a vector, for loops.
struct Numbers {
  double x, y, z;
};
TOUCHSTONE_INLINE Numbers numbers(const Vec3& v) noexcept { return {v.x(), v.y(), v.z()}; }

/// Of one point, from the normal of the plane that d leads to.
struct Rises {
  Rises(const Mat3& R_WT, const Vec3& direction, double least_cosine) noexcept
      : R(R_WT), d(numbers(direction)), least(least_cosine) {}
  TOUCHSTONE_INLINE Rise of(double nx, double ny, double nz, const RegionPoints& p, std::size_t i) const noexcept {
    const double against = smaller(nx * d.x + ny * d.y + nz * d.z, -least);
    const double x = nx / against, y = ny / against, z = nz / against;
    const double sx = R(0, 0) * x + R(1, 0) * y + R(2, 0) * z, sy = R(0, 1) * x + R(1, 1) * y + R(2, 1) * z,
                 sz = R(0, 2) * x + R(1, 2) * y + R(2, 2) * z;
    return {sx * p.e1x_T_m[i] + sy * p.e1y_T_m[i] + sz * p.e1z_T_m[i],
            sx * p.e2x_T_m[i] + sy * p.e2y_T_m[i] + sz * p.e2z_T_m[i]};
  }
  Mat3 R;
  Numbers d;
  double least;
};

}  // namespace

TOUCHSTONE_WIDE_LOOPS
static bool set_cosines(const Vec3& d_T, const RegionPoints& p) noexcept {
  const Numbers d = numbers(d_T);
  const auto count = static_cast<std::size_t>(p.count);
  double least = 0.0;
  // Columns never overlap, here and below.
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) p.cos_theta[i] = p.nx_T[i] * d.x + p.ny_T[i] * d.y + p.nz_T[i] * d.z;
  for (std::size_t i = 0; i < count; ++i) least = smaller(least, p.cos_theta[i]);
  return least < 0.0;
}

void keep_facing(const Vec3& d_T, RegionPoints& points) noexcept {
  if (!set_cosines(d_T, points)) return;
  int kept = 0;
  for (int i = 0; i < points.count; ++i) {
    if (points.cos_theta[i] < 0.0) continue;
    if (kept != i) {
      points.move(i, kept);
      points.cos_theta[kept] = points.cos_theta[i];
    }
    ++kept;
  }
  points.count = kept;
}

// The shapes' own formulas, of copies that no column overlaps.

template <class WayOut>
TOUCHSTONE_INLINE void set_depths_by(const WayOut way_out_m, RegionPoints& p) noexcept {
  const auto count = static_cast<std::size_t>(p.count);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) p.depth_m[i] = way_out_m(p.x_W_m[i], p.y_W_m[i], p.z_W_m[i]);
}

TOUCHSTONE_WIDE_LOOPS
void set_depths(const scene::BoxExit& way_out_m, RegionPoints& p) noexcept { set_depths_by(way_out_m, p); }
TOUCHSTONE_WIDE_LOOPS
void set_depths(const scene::SphereExit& way_out_m, RegionPoints& p) noexcept { set_depths_by(way_out_m, p); }
TOUCHSTONE_WIDE_LOOPS
void set_depths(const scene::EllipsoidExit& way_out_m, RegionPoints& p) noexcept { set_depths_by(way_out_m, p); }

TOUCHSTONE_WIDE_LOOPS
void set_rises(const Mat3& R_WT, const Vec3& d, RegionPoints& p) noexcept {
  const Rises rises(R_WT, d, grazes_curved);
  const auto count = static_cast<std::size_t>(p.count);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const Rise rise = rises.of(p.rest_nx_W[i], p.rest_ny_W[i], p.rest_nz_W[i], p, i);
    p.rise1_m[i] = rise.along1_m;
    p.rise2_m[i] = rise.along2_m;
  }
}

/// Where all depths change by the same slope.
TOUCHSTONE_WIDE_LOOPS
static void set_rises(const Vec3& slope_T, RegionPoints& p) noexcept {
  const Numbers slope = numbers(slope_T);
  const auto count = static_cast<std::size_t>(p.count);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    p.rise1_m[i] = slope.x * p.e1x_T_m[i] + slope.y * p.e1y_T_m[i] + slope.z * p.e1z_T_m[i];
    p.rise2_m[i] = slope.x * p.e2x_T_m[i] + slope.y * p.e2y_T_m[i] + slope.z * p.e2z_T_m[i];
  }
}

void set_rises(const scene::BoxExit& way_out, const Mat3& R_WT, const Vec3& d, RegionPoints& p) noexcept {
  // Along an axis d leads to one face only, whose outward normal is -d.
  if (d.cwiseAbs().maxCoeff() > 1.0 - 1e-12) return set_rises(depth_slope_T(R_WT, d, -d, grazes_plane), p);
  const Rises rises(R_WT, d, grazes_plane);
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.count); ++i) {
    const scene::BoxExit::TwoFaces met = way_out.two_faces(p.x_W_m[i], p.y_W_m[i], p.z_W_m[i]);
    set_over_edge(rises.of(met.first.nx, met.first.ny, met.first.nz, p, i),
                  rises.of(met.second.nx, met.second.ny, met.second.nz, p, i), met.between_m, p, i);
  }
}

TOUCHSTONE_WIDE_LOOPS
static double most_with_spread_m(const RegionPoints& p) noexcept {
  const auto count = static_cast<std::size_t>(p.count);
  double most_m = 0.0;
  constexpr std::size_t wide = 8;
  double most[wide] = {};
  std::size_t i = 0;
  for (; i + wide <= count; i += wide) {
    for (std::size_t k = 0; k < wide; ++k) {
      const double rise1_m = p.rise1_m[i + k], rise2_m = p.rise2_m[i + k];
      most[k] = larger(most[k], p.depth_m[i + k] + std::sqrt(rise1_m * rise1_m + rise2_m * rise2_m));
    }
  }
  for (; i < count; ++i) most[0] = larger(most[0], p.depth_m[i] + p.depth_spread_m(i));
  for (const double m : most) most_m = larger(most_m, m);
  return most_m;
}

bool reaches_limit(double limit_m, const RegionPoints& points) noexcept {
  if (points.spread) {
    // A little less than the limit is for limit_depths() to tell.
    return !(most_with_spread_m(points) < limit_m * (1.0 - 1e-12));
  }
  bool beyond = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i)
    beyond = beyond || !(points.depth_m[i] <= limit_m);
  return beyond;
}

/// Below it, the first terms of the normal's change say little.
constexpr double least_cosine = 0.3;

TOUCHSTONE_WIDE_LOOPS
void set_shares(const Vec3& d_T, RegionPoints& p) noexcept {
  const Numbers d = numbers(d_T);
  const auto count = static_cast<std::size_t>(p.count);
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const double area_m2 = p.area_m2[i] * p.cos_theta[i];
    const double x = p.x_T_m[i], y = p.y_T_m[i], z = p.z_T_m[i];
    const double ax = p.e1x_T_m[i], ay = p.e1y_T_m[i], az = p.e1z_T_m[i];
    const double bx = p.e2x_T_m[i], by = p.e2y_T_m[i], bz = p.e2z_T_m[i];
    // See Projected.
    const double on_line_m = x * d.x + y * d.y + z * d.z, up1_m = ax * d.x + ay * d.y + az * d.z,
                 up2_m = bx * d.x + by * d.y + bz * d.z;
    const double r2_m2 = larger(0.0, x * x + y * y + z * z - on_line_m * on_line_m);
    const double along1_m2 = ax * x + ay * y + az * z - up1_m * on_line_m,
                 along2_m2 = bx * x + by * y + bz * z - up2_m * on_line_m;
    const double variance_m2 =
        ax * ax + ay * ay + az * az + (bx * bx + by * by + bz * bz) - up1_m * up1_m - up2_m * up2_m;
    const bool near = !(r2_m2 > 6.0 * variance_m2);
    const double inverse_per_m2 = 1.0 / (near ? 1.0 : r2_m2);
    const double across_m2 = 3.0 * (along1_m2 * along1_m2 + along2_m2 * along2_m2) * inverse_per_m2 - variance_m2;
    const double over_m = area_m2 * std::sqrt(inverse_per_m2) * (1.0 + 0.5 * across_m2 * inverse_per_m2);
    // Where more of the part is seen along d, it counts more; a part seen from its edge has no such place.
    const double cosine = larger(p.cos_theta[i], least_cosine);
    const double shift_m = (p.rise1_m[i] * along1_m2 + p.rise2_m[i] * along2_m2) /
                               larger(larger(r2_m2, variance_m2), std::numeric_limits<double>::min()) -
                           (p.rise1_m[i] * (p.t1x_T[i] * d.x + p.t1y_T[i] * d.y + p.t1z_T[i] * d.z) +
                            p.rise2_m[i] * (p.t2x_T[i] * d.x + p.t2y_T[i] * d.y + p.t2z_T[i] * d.z)) /
                               cosine;
    const bool covers = area_m2 > 0.0;
    const double depth_m = p.depth_m[i];
    p.share[i] = covers ? (near ? near_the_line : over_m) : 0.0;
    p.depth_m[i] = covers ? larger(0.0, depth_m - shift_m) : depth_m;
  }
}

template <bool spread>
TOUCHSTONE_INLINE void forces(const DuffingLaw& law, const RegionPoints& p, double depth_scale, std::size_t begin,
                              std::size_t count, double* force_n, double* depth_m) noexcept {
  const DuffingLaw at = law;
#pragma GCC ivdep
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = begin + k;
    const double depth = depth_scale * p.depth_m[i];
    depth_m[k] = depth;
    if constexpr (spread) {
      const double rise1_m = p.rise1_m[i], rise2_m = p.rise2_m[i];
      // A ramp begins at depth 0.
      const double spread_m =
          smaller(depth_scale * std::sqrt(rise1_m * rise1_m + rise2_m * rise2_m), depth / std::numbers::sqrt3);
      // Exact for a cubic law over depths that vary evenly about their mean.
      force_n[k] = p.share[i] * (0.5 * (at.force_n(depth - spread_m) + at.force_n(depth + spread_m)));
    } else {
      force_n[k] = p.share[i] * at.force_n(depth);
    }
  }
}

TOUCHSTONE_WIDE_LOOPS
static void forces_of_pieces(const DuffingLaw& law, const RegionPoints& p, double depth_scale, std::size_t begin,
                             std::size_t count, double* force_n, double* depth_m) noexcept {
  forces<true>(law, p, depth_scale, begin, count, force_n, depth_m);
}
TOUCHSTONE_WIDE_LOOPS
static void forces_of_samples(const DuffingLaw& law, const RegionPoints& p, double depth_scale, std::size_t begin,
                              std::size_t count, double* force_n, double* depth_m) noexcept {
  forces<false>(law, p, depth_scale, begin, count, force_n, depth_m);
}

template <>
void point_forces<true>(const DuffingLaw& law, const RegionPoints& p, double depth_scale, std::size_t begin,
                        std::size_t count, double* force_n, double* depth_m) noexcept {
  forces_of_pieces(law, p, depth_scale, begin, count, force_n, depth_m);
}
template <>
void point_forces<false>(const DuffingLaw& law, const RegionPoints& p, double depth_scale, std::size_t begin,
                         std::size_t count, double* force_n, double* depth_m) noexcept {
  forces_of_samples(law, p, depth_scale, begin, count, force_n, depth_m);
}

}  // namespace touchstone::fast
