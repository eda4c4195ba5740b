#include "fast/surface/region_point.h"

#include "fast/surface/region_kernels.h"

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

template <class Formulation>
Vec3 displacement_at(const SurfacePatches& rest, const AnchorPoints& anchors, const ShapeStack& stack,
                     const LocalConstants* local, const scene::SurfaceQuery& at) noexcept {
  if (stack.count() == 0) return Vec3::Zero();
  const PatchPlace place = anchors.at(at.patch, at.point_m);
  Vec3 u_m = Formulation::global_at(rest, stack, at, place);
  if (local == nullptr) return u_m;
  const auto r2_m2 = [&](std::size_t k) { return (at.point_m - stack.region[k].p0_W_m).squaredNorm(); };
  for (std::size_t i = 0; i < stack.count(); ++i) {
    const double own_m2 = r2_m2(i);
    if (own_m2 >= local->r_R_m * local->r_R_m) continue;
    double change = Formulation::factor(*local, stack.region[i].size, std::sqrt(own_m2)) - 1.0;
    for (std::size_t k = 0; k < i; ++k) {
      if (stack.hats.takes_part(k)) change *= Formulation::room(*local, stack.region[k].size, std::sqrt(r2_m2(k)));
    }
    u_m += change * Formulation::increment_at(rest, stack, i, at, place);
  }
  return u_m;
}

/// Computes patch coordinates of the points in the stack's block of vertices.
TOUCHSTONE_INLINE void take_points(const AnchorPoints& anchors, int patch, const PointLanes& lanes,
                                   SurfacePatches& points) noexcept {
  PlaceColumns places;
  for (std::size_t k = 0; k < corners_max; ++k) places.weight[k] = points.weight[k].data();
  places.free = points.free.data();
  anchors.at(patch, {lanes.point_m[0], lanes.point_m[1], lanes.point_m[2]}, places);
  VertexBlock& block = points.blocks[0];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double *from_m = lanes.point_m[axis].data(), *from_normal = lanes.normal[axis].data();
    float *point_m = points.rest_W_m[axis].data(), *normal = points.normal[axis].data();
    std::array<float, lanes_at_once> low_m, high_m;
    low_m.fill(static_cast<float>(from_m[0]));
    high_m = low_m;
    // Columns never overlap.
#pragma GCC ivdep
    for (std::size_t v = 0; v < PointLanes::size; ++v) {
      point_m[v] = static_cast<float>(from_m[v]);
      normal[v] = static_cast<float>(from_normal[v]);
    }
    for (std::size_t v = 0; v < PointLanes::size; v += lanes_at_once) {
      for (std::size_t k = 0; k < lanes_at_once; ++k) {
        low_m[k] = point_m[v + k] < low_m[k] ? point_m[v + k] : low_m[k];
        high_m[k] = point_m[v + k] > high_m[k] ? point_m[v + k] : high_m[k];
      }
    }
    block.low_W_m[static_cast<int>(axis)] = *std::min_element(low_m.begin(), low_m.end());
    block.high_W_m[static_cast<int>(axis)] = *std::max_element(high_m.begin(), high_m.end());
  }
}

template <class Formulation>
TOUCHSTONE_INLINE void displacements_at(const AnchorPoints& anchors, const LocalConstants* local, int patch,
                                        ShapeStack& stack, PointLanes& lanes) noexcept {
  const auto p = static_cast<std::size_t>(patch);
  SurfacePatches& points = stack.scratch.points;
  take_points(anchors, patch, lanes, points);
  const VertexBlock& block = points.blocks[0];
  take_weights(points, block, stack);
  if (stack.count() > 0) raise_hats(points, 0, stack.count() - 1, p, block, stack);
  Lane3 sum;
  Formulation::whole(points, stack, p, block, sum);
  if (local != nullptr) {
    const auto r_R_m = static_cast<float>(local->r_R_m);
    stack.scratch.near.clear();
    for (std::size_t i = 0; i < stack.count(); ++i) {
      if (block.distance2_m2(stack.reach[i].p0_W_m) < r_R_m * r_R_m) stack.scratch.near.push_back(i);
    }
    if (!stack.scratch.near.empty()) add_changes<Formulation>(points, r_R_m, p, block, stack, sum);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t v = 0; v < PointLanes::size; ++v) lanes.displacement_m[axis][v] = sum[axis][v];
  }
}

}  // namespace

Vec3 displacement_at_published(const SurfacePatches& rest, const AnchorPoints& anchors, const ShapeStack& stack,
                               const LocalConstants* local, const scene::SurfaceQuery& at) noexcept {
  return displacement_at<Published>(rest, anchors, stack, local, at);
}

Vec3 displacement_at_corrected(const SurfacePatches& rest, const AnchorPoints& anchors, const ShapeStack& stack,
                               const LocalConstants* local, const scene::SurfaceQuery& at) noexcept {
  return displacement_at<Corrected>(rest, anchors, stack, local, at);
}

TOUCHSTONE_WIDE_LOOPS
void displacements_at_published(const AnchorPoints& anchors, const LocalConstants* local, int patch, ShapeStack& stack,
                                PointLanes& lanes) noexcept {
  displacements_at<Published>(anchors, local, patch, stack, lanes);
}

TOUCHSTONE_WIDE_LOOPS
void displacements_at_corrected(const AnchorPoints& anchors, const LocalConstants* local, int patch, ShapeStack& stack,
                                PointLanes& lanes) noexcept {
  displacements_at<Corrected>(anchors, local, patch, stack, lanes);
}

}  // namespace touchstone::fast
