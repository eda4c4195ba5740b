// Cells of the tool worked off a batch at a time, in columns, so that loops run over several at once. Every number is
// the one that rest_distance() and Eigen give for a single cell, bit by bit.
#pragma once

#include "fast/contact/region_points.h"
#include "fast/contact/rest_distance.h"
#include "scene/shape/solids.h"

#include <array>
#include <cstddef>

namespace touchstone::fast {

/// A few cells, or a few points.
struct CellBatch {
  static constexpr std::size_t size = 32;
  using Column = std::array<double, size>;
  std::size_t count = 0;
  alignas(64) Column x_m{}, y_m{}, z_m{};             ///< of the middle, frame T; place_batch(): in the world
  alignas(64) Column reach_m{};                       ///< what is further out need not be looked at
  alignas(64) Column beyond{};                        ///< above 0: surely further out
  alignas(64) Column distance_m{}, nx{}, ny{}, nz{};  ///< RestDistance of the middle
  std::array<std::array<Column, 3>, 4> corner_m{};    ///< from the middle, frame T
  std::array<std::array<Column, 3>, 2> sag_m{};       ///< of SurfaceCell
  std::array<Column, 2> sagitta_m{};                  ///< of SurfaceCell
  alignas(64) Column nx_T{}, ny_T{}, nz_T{};          ///< (nx, ny, nz) in frame T
  alignas(64) Column lowest_m{}, highest_m{};         ///< corners, over the tangent plane of the rest surface
  alignas(64) Column dip_m{};                         ///< no point of a curved cell is further below its lowest corner
  alignas(64) Column area_m2{};                       ///< of what cut_batch() leaves

  /// Lanes that loops work off: those behind `count` hold what the last one does.
  [[nodiscard]] std::size_t lanes() const noexcept { return (count + 3) / 4 * 4; }
  /// Copies the last middle to the lanes behind it.
  void pad() noexcept {
    for (std::size_t i = count; i < lanes(); ++i) {
      x_m[i] = x_m[count - 1];
      y_m[i] = y_m[count - 1];
      z_m[i] = z_m[count - 1];
      reach_m[i] = reach_m[count - 1];
    }
  }
  void set(std::size_t i, const scene::Vec3& middle_m, double reach) noexcept {
    x_m[i] = middle_m.x();
    y_m[i] = middle_m.y();
    z_m[i] = middle_m.z();
    reach_m[i] = reach;
  }
  void set_corners(std::size_t i, const SurfaceCell& cell) noexcept {
    for (std::size_t k = 0; k < corner_m.size(); ++k) {
      // A triangle has its first one twice.
      const scene::Vec3& at_m = cell.corner_m[k < static_cast<std::size_t>(cell.corners) ? k : 0];
      corner_m[k][0][i] = at_m.x();
      corner_m[k][1][i] = at_m.y();
      corner_m[k][2][i] = at_m.z();
    }
    for (std::size_t k = 0; k < sagitta_m.size(); ++k) sagitta_m[k][i] = cell.sagitta_m[k];
  }
  void set_sag(std::size_t i, const SurfaceCell& cell) noexcept {
    for (std::size_t k = 0; k < sag_m.size(); ++k) {
      sag_m[k][0][i] = cell.sag_m[k].x();
      sag_m[k][1][i] = cell.sag_m[k].y();
      sag_m[k][2][i] = cell.sag_m[k].z();
    }
  }
  TOUCHSTONE_INLINE void set_rest(std::size_t i, const scene::Distance& d) noexcept {
    distance_m[i] = d.signed_distance_m;
    nx[i] = d.nx;
    ny[i] = d.ny;
    nz[i] = d.nz;
  }
  /// Takes lane `from` for lane `to`, as far as place_batch() has filled it.
  void move(std::size_t from, std::size_t to) noexcept {
    for (Column* column : {&x_m, &y_m, &z_m, &reach_m}) (*column)[to] = (*column)[from];
  }
};

/// Middles to the world.
void place_batch(const Placement&, CellBatch&) noexcept;
/// Sets `beyond`, of a shape that knows it.
template <class Body>
void beyond_batch(const Body& body, CellBatch& batch) noexcept {
  for (std::size_t i = 0; i < batch.lanes(); ++i)
    batch.beyond[i] = body.beyond(batch.x_m[i], batch.y_m[i], batch.z_m[i], batch.reach_m[i]);
}
void beyond_batch(const scene::Ellipsoid&, CellBatch&) noexcept;
/// RestDistance of the middles. Shapes with an overload have the loop for wide registers.
template <class Body>
void rest_batch(const Body& body, CellBatch& batch) noexcept {
  for (std::size_t i = 0; i < batch.count; ++i) {
    const RestDistance rest = rest_distance(body, scene::Vec3(batch.x_m[i], batch.y_m[i], batch.z_m[i]));
    batch.set_rest(i, {rest.signed_distance_m, rest.normal.x(), rest.normal.y(), rest.normal.z()});
  }
}
void rest_batch(const scene::Box&, CellBatch&) noexcept;
void rest_batch(const scene::Sphere&, CellBatch&) noexcept;
void rest_batch(const scene::Ellipsoid&, CellBatch&) noexcept;
/// Normals in frame T, the levels of the corners, and dips.
void level_batch(const scene::Mat3& R_WT, CellBatch&) noexcept;
/// Area and middle (x_m, y_m, z_m), from the cell's, of the part of the polygon of the corners that is below the plane
/// of (nx_T, ny_T, nz_T) and distance_m: what CutPolygon gives.
void cut_batch(CellBatch&) noexcept;

}  // namespace touchstone::fast
