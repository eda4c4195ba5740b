#include "fast/contact/region_points.h"

#include "scene/base/index.h"

#include <array>
#include <bit>
#include <limits>
#include <type_traits>

namespace touchstone::fast {
namespace {

constexpr int columns = 30;  // of doubles

/// Columns that lie a power of two apart would share a few lines of the cache.
std::size_t stride(std::size_t capacity) noexcept { return (capacity / 8 | 1) * 8 + 16; }

constexpr std::size_t of_a_sample = 11, of_a_piece = 26;

/// First those that detection fills for every point, then those that it fills for a piece of surface.
std::array<double**, columns> columns_of(RegionPoints& p) noexcept {
  return {&p.x_W_m,     &p.y_W_m,     &p.z_W_m,     &p.x_T_m,     &p.y_T_m,   &p.z_T_m,   &p.nx_T,
          &p.ny_T,      &p.nz_T,      &p.area_m2,   &p.depth_m,  //
          &p.rest_nx_W, &p.rest_ny_W, &p.rest_nz_W, &p.e1x_T_m,   &p.e1y_T_m, &p.e1z_T_m, &p.e2x_T_m,
          &p.e2y_T_m,   &p.e2z_T_m,   &p.t1x_T,     &p.t1y_T,     &p.t1z_T,   &p.t2x_T,   &p.t2y_T,
          &p.t2z_T,     &p.rise1_m,   &p.rise2_m,   &p.cos_theta, &p.share};
}

}  // namespace

void RegionPoints::move(int from, int to) noexcept {
  const auto i = static_cast<std::size_t>(from), k = static_cast<std::size_t>(to);
  for (double* column : {x_W_m, y_W_m, z_W_m, x_T_m, y_T_m, z_T_m, nx_T, ny_T, nz_T, area_m2, depth_m})
    column[k] = column[i];
  sample[k] = sample[i];
  if (!spread) return;
  for (double* column : {rest_nx_W, rest_ny_W, rest_nz_W, e1x_T_m, e1y_T_m, e1z_T_m, e2x_T_m, e2y_T_m, e2z_T_m, t1x_T,
                         t1y_T, t1z_T, t2x_T, t2y_T, t2z_T})
    column[k] = column[i];
  cell[k] = cell[i];
}

void RegionPoints::reorder(std::span<const std::int32_t> order, double* scratch) noexcept {
  const auto through_scratch = [&](auto* column) {
    for (std::size_t k = 0; k < order.size(); ++k) scratch[k] = static_cast<double>(nth(column, order[k]));
    for (std::size_t k = 0; k < order.size(); ++k)
      column[k] = static_cast<std::remove_reference_t<decltype(*column)>>(scratch[k]);
  };
  const auto all = columns_of(*this);
  for (std::size_t c = 0; c < (spread ? of_a_piece : of_a_sample); ++c) through_scratch(*all[c]);
  through_scratch(sample);
  if (spread) {
    for (std::size_t k = 0; k < order.size(); ++k) scratch[k] = std::bit_cast<double>(nth(cell, order[k]));
    for (std::size_t k = 0; k < order.size(); ++k) cell[k] = std::bit_cast<const SurfaceCell*>(scratch[k]);
  }
  count = static_cast<int>(order.size());
}

RegionPoints RegionPoints::slice(int begin, int size) const noexcept {
  RegionPoints part = *this;
  for (double** column : columns_of(part)) *column += begin;
  part.cell += begin;
  part.sample += begin;
  part.count = part.capacity = size;
  return part;
}

PointStore::PointStore(int capacity)
    : numbers_(columns * stride(static_cast<std::size_t>(capacity))),
      cells_(static_cast<std::size_t>(capacity)),
      samples_(static_cast<std::size_t>(capacity)) {}

RegionPoints PointStore::window() noexcept {
  RegionPoints points;
  double* next = numbers_.data();
  for (double** column : columns_of(points)) {
    *column = next;
    next += stride(samples_.size());
  }
  points.cell = cells_.data();
  points.sample = samples_.data();
  points.capacity = capacity();
  return points;
}

}  // namespace touchstone::fast
