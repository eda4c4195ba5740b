#include "fast/contact/cell_batch.h"

#include "fast/realtime/wide_loops.h"

#include <cmath>

namespace touchstone::fast {
namespace {

TOUCHSTONE_INLINE double larger(double a, double b) noexcept { return a > b ? a : b; }
TOUCHSTONE_INLINE double smaller(double a, double b) noexcept { return a < b ? a : b; }

}  // namespace

TOUCHSTONE_WIDE_LOOPS
void place_batch(const Placement& at, CellBatch& batch) noexcept {
  const scene::Mat3 R = at.R_WT;
  const scene::Vec3 origin_m = at.origin_W_m;
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) {
    const double x = batch.x_m[i], y = batch.y_m[i], z = batch.z_m[i];
    batch.x_m[i] = R(0, 0) * x + R(0, 1) * y + R(0, 2) * z + origin_m.x();
    batch.y_m[i] = R(1, 0) * x + R(1, 1) * y + R(1, 2) * z + origin_m.y();
    // As Eigen adds up the last row.
    batch.z_m[i] = R(2, 0) * x + (R(2, 1) * y + R(2, 2) * z) + origin_m.z();
  }
}

// The shapes' own formulas, of copies that no column overlaps.
// NOLINTBEGIN(performance-unnecessary-copy-initialization)

TOUCHSTONE_WIDE_LOOPS
void beyond_batch(const scene::Ellipsoid& given, CellBatch& batch) noexcept {
  const scene::Ellipsoid body = given;
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i)
    batch.beyond[i] = body.beyond(batch.x_m[i], batch.y_m[i], batch.z_m[i], batch.reach_m[i]);
}

TOUCHSTONE_WIDE_LOOPS
void rest_batch(const scene::Box& given, CellBatch& batch) noexcept {
  const scene::Box body = given;
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) batch.set_rest(i, body.distance_at(batch.x_m[i], batch.y_m[i], batch.z_m[i]));
}

TOUCHSTONE_WIDE_LOOPS
void rest_batch(const scene::Sphere& given, CellBatch& batch) noexcept {
  const scene::Sphere body = given;
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) batch.set_rest(i, body.distance_at(batch.x_m[i], batch.y_m[i], batch.z_m[i]));
}

namespace {

/// What has become of a lane's search, as a number among those that it works on.
constexpr double searching = 0.0, found = 1.0, lost = 2.0;

}  // namespace

/// The steps of Ellipsoid::distance_at(), each lane until it has its answer.
TOUCHSTONE_WIDE_LOOPS
void rest_batch(const scene::Ellipsoid& body, CellBatch& batch) noexcept {
  constexpr std::size_t wide = 8;
  const scene::Vec3 center_m = body.center_m();
  const scene::EllipsoidSearch search(body.semi_axes_m());
  for (std::size_t begin = 0; begin < batch.count; begin += wide) {
    alignas(64) double lx[wide], ly[wide], lz[wide], t[wide], state[wide];
    for (std::size_t i = 0; i < wide; ++i) {
      const std::size_t k = begin + i < batch.count ? begin + i : batch.count - 1;
      lx[i] = batch.x_m[k] - center_m.x();
      ly[i] = batch.y_m[k] - center_m.y();
      lz[i] = batch.z_m[k] - center_m.z();
      t[i] = 0.0;
      state[i] = searching;
    }
    for (int k = 0; k < scene::EllipsoidSearch::steps_max; ++k) {
      for (std::size_t i = 0; i < wide; ++i) {
        const scene::EllipsoidSearch::Step step = search.step(lx[i], ly[i], lz[i], t[i]);
        const bool goes_on = state[i] == searching;
        const double becomes = search.lost(step) ? lost : scene::EllipsoidSearch::settled(step) ? found : searching;
        t[i] = (goes_on & !scene::EllipsoidSearch::stands(step)) ? step.next : t[i];
        state[i] = goes_on ? becomes : state[i];
      }
      double least = found;
      for (std::size_t i = 0; i < wide; ++i) least = smaller(least, state[i]);
      if (least != searching) break;
    }
    alignas(64) double distance_m[wide], nx[wide], ny[wide], nz[wide];
    for (std::size_t i = 0; i < wide; ++i) {
      const scene::Distance d = search.answer(lx[i], ly[i], lz[i], t[i]);
      distance_m[i] = d.signed_distance_m;
      nx[i] = d.nx;
      ny[i] = d.ny;
      nz[i] = d.nz;
    }
    for (std::size_t i = 0; i < wide && begin + i < batch.count; ++i) {
      const std::size_t k = begin + i;
      batch.set_rest(k, {distance_m[i], nx[i], ny[i], nz[i]});
      if (state[i] == found) continue;
      const scene::SurfaceQuery safe = body.query(scene::Vec3(batch.x_m[k], batch.y_m[k], batch.z_m[k]));
      batch.set_rest(k, {safe.signed_distance_m, safe.normal.x(), safe.normal.y(), safe.normal.z()});
    }
  }
}

namespace {

/// The slope that is smaller in magnitude; 0 where the two have different signs.
TOUCHSTONE_INLINE double common_slope(double a, double b) noexcept {
  const double least = smaller(std::abs(a), std::abs(b));
  return a * b > 0.0 ? least : 0.0;
}

/// How far slope_m t - 4 t (1 - t) sagitta_m falls below 0 for t from 0 to 1.
TOUCHSTONE_INLINE double dip(double slope_m, double sagitta_m) noexcept {
  const double rest_m = larger(0.0, 4.0 * sagitta_m - slope_m);
  return sagitta_m > 0.0 ? rest_m * rest_m / (16.0 * sagitta_m) : 0.0;
}

}  // namespace

TOUCHSTONE_WIDE_LOOPS
void level_batch(const scene::Mat3& R_WT, CellBatch& batch) noexcept {
  const scene::Mat3 R = R_WT;
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) {
    const double x = batch.nx[i], y = batch.ny[i], z = batch.nz[i];
    const double nx = R(0, 0) * x + R(1, 0) * y + R(2, 0) * z, ny = R(0, 1) * x + R(1, 1) * y + R(2, 1) * z,
                 nz = R(0, 2) * x + R(1, 2) * y + R(2, 2) * z;
    const auto& c = batch.corner_m;
    const double c0 = nx * c[0][0][i] + ny * c[0][1][i] + nz * c[0][2][i],
                 c1 = nx * c[1][0][i] + ny * c[1][1][i] + nz * c[1][2][i],
                 c2 = nx * c[2][0][i] + ny * c[2][1][i] + nz * c[2][2][i],
                 c3 = nx * c[3][0][i] + ny * c[3][1][i] + nz * c[3][2][i];
    batch.nx_T[i] = nx;
    batch.ny_T[i] = ny;
    batch.nz_T[i] = nz;
    batch.lowest_m[i] = batch.distance_m[i] + smaller(smaller(c0, c1), smaller(c2, c3));
    batch.highest_m[i] = batch.distance_m[i] + larger(larger(c0, c1), larger(c2, c3));
    // A circle about the tool's z axis leaves its chord across that axis only, an arc of the meridian in any direction.
    batch.dip_m[i] = dip(common_slope(c1 - c0, c2 - c3), batch.sagitta_m[0][i] * std::sqrt(nx * nx + ny * ny)) +
                     dip(common_slope(c3 - c0, c2 - c1), batch.sagitta_m[1][i]);
  }
}

namespace {

/// A corner of the part below the plane, or none.
struct Corner {
  double x, y, z;
  bool there;
};
TOUCHSTONE_INLINE Corner chosen(bool first, const Corner& a, const Corner& b) noexcept {
  return {first ? a.x : b.x, first ? a.y : b.y, first ? a.z : b.z, true};
}

}  // namespace

TOUCHSTONE_WIDE_LOOPS
void cut_batch(CellBatch& batch) noexcept {
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) {
    const auto& c = batch.corner_m;
    const double nx = batch.nx_T[i], ny = batch.ny_T[i], nz = batch.nz_T[i], level = batch.distance_m[i];
    double at[4];
#pragma GCC unroll 4
    for (std::size_t k = 0; k < 4; ++k) at[k] = nx * c[k][0][i] + ny * c[k][1][i] + nz * c[k][2][i] + level;
    double bend[2];
#pragma GCC unroll 2
    for (std::size_t k = 0; k < 2; ++k)
      bend[k] = 4.0 * (nx * batch.sag_m[k][0][i] + ny * batch.sag_m[k][1][i] + nz * batch.sag_m[k][2][i]);
    // Each corner, and where the plane crosses the side behind it, which bends.
    Corner corner[8];
#pragma GCC unroll 4
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t next = (k + 1) % 4;
      const double x = c[k][0][i], y = c[k][1][i], z = c[k][2][i], along = crossing(at[k], at[next], bend[k % 2]);
      corner[2 * k] = {x, y, z, at[k] < 0.0};
      corner[2 * k + 1] = {x + along * (c[next][0][i] - x), y + along * (c[next][1][i] - y),
                           z + along * (c[next][2][i] - z), (at[k] < 0.0) != (at[next] < 0.0)};
    }
    Corner first = corner[7];
#pragma GCC unroll 8
    for (std::size_t k = 7; k-- > 0;) first = chosen(corner[k].there, corner[k], first);
    // Triangles from the first; where there is no corner, one without area.
    Corner last = first;
    double area_m2 = 0.0, sum_x = 0.0, sum_y = 0.0, sum_z = 0.0;
#pragma GCC unroll 8
    for (std::size_t k = 0; k < 8; ++k) {
      const Corner here = chosen(corner[k].there, corner[k], last);
      const double ax = last.x - first.x, ay = last.y - first.y, az = last.z - first.z;
      const double bx = here.x - first.x, by = here.y - first.y, bz = here.z - first.z;
      const double x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
      const double part_m2 = 0.5 * std::sqrt(x * x + y * y + z * z), third_m2 = part_m2 / 3.0;
      area_m2 += part_m2;
      sum_x += third_m2 * (first.x + last.x + here.x);
      sum_y += third_m2 * (first.y + last.y + here.y);
      sum_z += third_m2 * (first.z + last.z + here.z);
      last = here;
    }
    const bool some = area_m2 > 0.0;
    batch.area_m2[i] = area_m2;
    batch.x_m[i] = some ? sum_x / area_m2 : 0.0;
    batch.y_m[i] = some ? sum_y / area_m2 : 0.0;
    batch.z_m[i] = some ? sum_z / area_m2 : 0.0;
  }
}

// NOLINTEND(performance-unnecessary-copy-initialization)

}  // namespace touchstone::fast
