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

TOUCHSTONE_WIDE_LOOPS
bool beyond_batch(const scene::Ellipsoid& body, CellBatch& batch) noexcept {
  const scene::Vec3 center_m = body.center_m(), per_m = body.semi_axes_m().cwiseInverse();
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) {
    const double sx = (batch.x_m[i] - center_m.x()) * per_m.x(), sy = (batch.y_m[i] - center_m.y()) * per_m.y(),
                 sz = (batch.z_m[i] - center_m.z()) * per_m.z();
    const double gx = sx * per_m.x(), gy = sy * per_m.y(), gz = sz * per_m.z();
    const double ratio2 = sx * sx + sy * sy + sz * sz;
    batch.beyond[i] = ratio2 - std::sqrt(ratio2) - batch.reach_m[i] * std::sqrt(gx * gx + gy * gy + gz * gz);
  }
  return true;
}

TOUCHSTONE_WIDE_LOOPS
void rest_batch(const scene::Box& body, CellBatch& batch) noexcept {
  const scene::Vec3 center_m = body.center_m(), half_m = body.half_m();
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) {
    const double lx = batch.x_m[i] - center_m.x(), ly = batch.y_m[i] - center_m.y(), lz = batch.z_m[i] - center_m.z();
    const double ax = std::abs(lx) - half_m.x(), ay = std::abs(ly) - half_m.y(), az = std::abs(lz) - half_m.z();
    batch.distance_m[i] = larger(larger(ax, ay), az);
    const bool x = (ax >= ay) & (ax >= az), y = !x & (ay >= az);
    batch.nx[i] = x ? std::copysign(1.0, lx) : 0.0;
    batch.ny[i] = y ? std::copysign(1.0, ly) : 0.0;
    batch.nz[i] = x | y ? 0.0 : std::copysign(1.0, lz);
  }
}

TOUCHSTONE_WIDE_LOOPS
void rest_batch(const scene::Sphere& body, CellBatch& batch) noexcept {
  const scene::Vec3 center_m = body.center_m();
  const double radius_m = body.radius_m();
  const std::size_t lanes = batch.lanes();
  for (std::size_t i = 0; i < lanes; ++i) {
    const double lx = batch.x_m[i] - center_m.x(), ly = batch.y_m[i] - center_m.y(), lz = batch.z_m[i] - center_m.z();
    const double distance_m = std::sqrt(lx * lx + ly * ly + lz * lz);
    batch.distance_m[i] = distance_m - radius_m;
    const bool apart = distance_m > 0.0;
    batch.nx[i] = apart ? lx / distance_m : 0.0;
    batch.ny[i] = apart ? ly / distance_m : 0.0;
    batch.nz[i] = apart ? lz / distance_m : 1.0;
  }
}

namespace {

/// What has become of a lane's search, as a number among those that it works on.
constexpr double searching = 0.0, found = 1.0, lost = 2.0;

}  // namespace

/// The steps of rest_distance(), each lane until it has its answer.
TOUCHSTONE_WIDE_LOOPS
void rest_batch(const scene::Ellipsoid& body, CellBatch& batch) noexcept {
  constexpr std::size_t wide = 8;
  const scene::Vec3 center_m = body.center_m(), a = body.semi_axes_m(), a2 = a.cwiseProduct(a);
  const double deepest = -0.9 * a2.minCoeff();
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
    for (int step = 0; step < 12; ++step) {
      for (std::size_t i = 0; i < wide; ++i) {
        const double px = 1.0 / (a2.x() + t[i]), py = 1.0 / (a2.y() + t[i]), pz = 1.0 / (a2.z() + t[i]);
        const double qx = a.x() * lx[i] * px, qy = a.y() * ly[i] * py, qz = a.z() * lz[i] * pz;
        const double qx2 = qx * qx, qy2 = qy * qy, qz2 = qz * qz;
        const double rx = qx2 * px, ry = qy2 * py, rz = qz2 * pz;
        const double length2 = qx2 + qy2 + qz2, length = std::sqrt(length2), over = length - 1.0;
        const double s1 = rx + ry + rz, s2 = rx * px + ry * py + rz * pz;
        const double bent = 2.0 * s1 * s1 + 3.0 * over * (s1 * s1 - length2 * s2);
        const double next = t[i] + 2.0 * length2 * over * s1 / (bent > s1 * s1 ? bent : 2.0 * s1 * s1);
        const bool on = std::abs(over) < 4e-16, goes_on = state[i] == searching;
        const double becomes = on | !(next > deepest) ? lost : std::abs(over) < 1e-5 ? found : searching;
        t[i] = goes_on & !on ? next : t[i];
        state[i] = goes_on ? becomes : state[i];
      }
      double least = found;
      for (std::size_t i = 0; i < wide; ++i) least = smaller(least, state[i]);
      if (least != searching) break;
    }
    alignas(64) double distance_m[wide], nx[wide], ny[wide], nz[wide];
    for (std::size_t i = 0; i < wide; ++i) {
      const double x = lx[i] / (a2.x() + t[i]), y = ly[i] / (a2.y() + t[i]), z = lz[i] / (a2.z() + t[i]);
      const double length = std::sqrt(x * x + y * y + z * z);
      nx[i] = x / length;
      ny[i] = y / length;
      nz[i] = z / length;
      const double ax = a.x() * nx[i], ay = a.y() * ny[i], az = a.z() * nz[i];
      distance_m[i] = lx[i] * nx[i] + ly[i] * ny[i] + lz[i] * nz[i] - std::sqrt(ax * ax + ay * ay + az * az);
    }
    for (std::size_t i = 0; i < wide && begin + i < batch.count; ++i) {
      const std::size_t k = begin + i;
      batch.distance_m[k] = distance_m[i];
      batch.nx[k] = nx[i];
      batch.ny[k] = ny[i];
      batch.nz[k] = nz[i];
      if (state[i] == found) continue;
      const scene::SurfaceQuery closest = body.query(scene::Vec3(batch.x_m[k], batch.y_m[k], batch.z_m[k]));
      batch.distance_m[k] = closest.signed_distance_m;
      batch.nx[k] = closest.normal.x();
      batch.ny[k] = closest.normal.y();
      batch.nz[k] = closest.normal.z();
    }
  }
}

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
    // Each corner, and where the plane crosses the side behind it.
    Corner corner[8];
#pragma GCC unroll 4
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t next = (k + 1) % 4;
      const double x = c[k][0][i], y = c[k][1][i], z = c[k][2][i], along = at[k] / (at[k] - at[next]);
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

}  // namespace touchstone::fast
