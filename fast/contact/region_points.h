// The points of a contact region with what detection finds of them, and the storage that holds them.
#pragma once

#include "fast/contact/surface_cells.h"
#include "scene/base/frames.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace touchstone::fast {

/// The tool's placement in the world, with the rotation written out: p_W = R_WT p_T + origin_W_m.
struct Placement {
  scene::Mat3 R_WT = scene::Mat3::Identity();
  scene::Vec3 origin_W_m = scene::Vec3::Zero();  ///< the tool's mass centre
};

/// A point of the tool's surface as detection finds it.
struct FoundPoint {
  scene::Vec3 p_W_m, p_T_m;
  scene::Vec3 normal_T;
  double area_m2;
  double depth_m;  ///< to the rest surface, negative outside
  std::int32_t sample;
};

/// A piece of it.
struct FoundPiece {
  FoundPoint middle;
  scene::Vec3 rest_normal_W;  ///< of the rest surface at the closest point
  Spread spread_T_m;
  Turn turn_T;
  const SurfaceCell* whole;  ///< the cell, if the piece is all of it
};

/// The points p_i of one contact region: a window on a PointStore.
struct RegionPoints {
  int count = 0, capacity = 0;
  bool spread = false;  ///< points are pieces of surface, over which the depth varies; otherwise samples
  double *x_W_m = nullptr, *y_W_m = nullptr, *z_W_m = nullptr;  ///< p_i in the world
  double *x_T_m = nullptr, *y_T_m = nullptr, *z_T_m = nullptr;  ///< p_i about the tool's mass centre
  double *nx_T = nullptr, *ny_T = nullptr, *nz_T = nullptr;     ///< outward normal n_i of the tool
  /// Where `spread`: of the rest surface at the closest point.
  double *rest_nx_W = nullptr, *rest_ny_W = nullptr, *rest_nz_W = nullptr;
  double* area_m2 = nullptr;                                          ///< A_i
  double* cos_theta = nullptr;                                        ///< n_i . d, >= 0
  double *e1x_T_m = nullptr, *e1y_T_m = nullptr, *e1z_T_m = nullptr;  ///< Spread of A_i, first vector; of cells
  double *e2x_T_m = nullptr, *e2y_T_m = nullptr, *e2z_T_m = nullptr;  ///< second
  double *t1x_T = nullptr, *t1y_T = nullptr, *t1z_T = nullptr;        ///< Turn of n_i along the first
  double *t2x_T = nullptr, *t2y_T = nullptr, *t2z_T = nullptr;        ///< along the second
  double* depth_m = nullptr;                      ///< d_i, along d from the rest surface; as found: to it
  double *rise1_m = nullptr, *rise2_m = nullptr;  ///< of the depth along the two vectors; where `spread`
  double* share = nullptr;                        ///< m_i / m
  const SurfaceCell** cell = nullptr;             ///< that is wholly the point
  std::int32_t* sample = nullptr;                 ///< of ToolSamples; several may have one

  [[nodiscard]] scene::Vec3 p_W_m(std::size_t i) const noexcept { return {x_W_m[i], y_W_m[i], z_W_m[i]}; }
  [[nodiscard]] scene::Vec3 rest_normal_W(std::size_t i) const noexcept {
    return {rest_nx_W[i], rest_ny_W[i], rest_nz_W[i]};
  }
  [[nodiscard]] scene::Vec3 p_T_m(std::size_t i) const noexcept { return {x_T_m[i], y_T_m[i], z_T_m[i]}; }
  /// Copies point `from` to the place `to`, as far as detection has filled it.
  void move(int from, int to) noexcept;
  [[nodiscard]] Spread spread_T_m(std::size_t i) const noexcept {
    return {scene::Vec3(e1x_T_m[i], e1y_T_m[i], e1z_T_m[i]), scene::Vec3(e2x_T_m[i], e2y_T_m[i], e2z_T_m[i])};
  }
  /// Standard deviation of the depth over the point's area, where `spread`.
  [[nodiscard]] double depth_spread_m(std::size_t i) const noexcept {
    return std::sqrt(rise1_m[i] * rise1_m[i] + rise2_m[i] * rise2_m[i]);
  }
  void set_rest_normal(int k, const scene::Vec3& rest_normal_W) noexcept {
    rest_nx_W[k] = rest_normal_W.x();
    rest_ny_W[k] = rest_normal_W.y();
    rest_nz_W[k] = rest_normal_W.z();
  }
  /// Fills place k as detection does.
  TOUCHSTONE_INLINE void set(int k, const FoundPoint& point) noexcept {
    x_W_m[k] = point.p_W_m.x();
    y_W_m[k] = point.p_W_m.y();
    z_W_m[k] = point.p_W_m.z();
    x_T_m[k] = point.p_T_m.x();
    y_T_m[k] = point.p_T_m.y();
    z_T_m[k] = point.p_T_m.z();
    nx_T[k] = point.normal_T.x();
    ny_T[k] = point.normal_T.y();
    nz_T[k] = point.normal_T.z();
    area_m2[k] = point.area_m2;
    depth_m[k] = point.depth_m;
    sample[k] = point.sample;
  }
  /// The same, where `spread`.
  TOUCHSTONE_INLINE void set(int k, const FoundPiece& piece) noexcept {
    set(k, piece.middle);
    set_rest_normal(k, piece.rest_normal_W);
    cell[k] = piece.whole;
    e1x_T_m[k] = piece.spread_T_m[0].x();
    e1y_T_m[k] = piece.spread_T_m[0].y();
    e1z_T_m[k] = piece.spread_T_m[0].z();
    e2x_T_m[k] = piece.spread_T_m[1].x();
    e2y_T_m[k] = piece.spread_T_m[1].y();
    e2z_T_m[k] = piece.spread_T_m[1].z();
    t1x_T[k] = piece.turn_T[0].x();
    t1y_T[k] = piece.turn_T[0].y();
    t1z_T[k] = piece.turn_T[0].z();
    t2x_T[k] = piece.turn_T[1].x();
    t2y_T[k] = piece.turn_T[1].y();
    t2z_T[k] = piece.turn_T[1].z();
  }
  /// Puts point order[k] at place k, for all k; as far as detection has filled them. Points not named are gone.
  /// @param scratch room for as many numbers as `order` holds
  void reorder(std::span<const std::int32_t> order, double* scratch) noexcept;
  /// The points [begin, begin + size) of this window.
  [[nodiscard]] RegionPoints slice(int begin, int size) const noexcept;
};

/// Owns the storage of the points, fixed at construction.
class PointStore {
 public:
  explicit PointStore(int capacity);
  /// A window on all of it, without points yet.
  [[nodiscard]] RegionPoints window() noexcept;
  [[nodiscard]] int capacity() const noexcept { return static_cast<int>(samples_.size()); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept {
    return numbers_.size() * sizeof(double) + samples_.size() * (sizeof(std::int32_t) + sizeof(SurfaceCell*));
  }

 private:
  std::vector<double> numbers_;
  std::vector<const SurfaceCell*> cells_;
  std::vector<std::int32_t> samples_;
};

/// What the inside samples say about the rest surface above them, each weighted by its area times its distance to
/// the rest surface.
struct InsideSummary {
  scene::Vec3 normal_sum = scene::Vec3::Zero();  ///< of the rest surface's normals at the closest points
  double weight_sum = 0.0;
  double deepest_m = 0.0;  ///< largest distance to the rest surface

  void add(const scene::Vec3& normal, double depth_m, double area_m2) noexcept {
    const double weight = depth_m * area_m2;
    normal_sum += weight * normal;
    weight_sum += weight;
    deepest_m = std::max(deepest_m, depth_m);
  }
};

/// What the region looks like along d.
struct RegionExtent {
  double deepest_m = 0.0;                        ///< largest d_i
  double thickness_m = 0.0;                      ///< of the body, along d through the deepest point
  double area_m2 = 0.0;                          ///< sum of A_i cos(theta_i): the samples' area projected along d
  scene::Vec3 center_W_m = scene::Vec3::Zero();  ///< area-weighted centre of the points projected along d
};

}  // namespace touchstone::fast
