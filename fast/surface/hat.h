// How a contact point lifts the surface around it: the shape of its share in the interpolation, section V-E.
#pragma once

#include "fast/surface/surface_patches.h"

namespace touchstone::fast {

/// A weight this large keeps the hat of a point to the patches of that anchor point; from smaller ones on it spreads
/// over the edge that the point comes near to. No weight of a hat's top is below it for every anchor point.
inline constexpr double hat_weight = 0.1;

/// A hat on one patch: the least of `ceiling`, per_free PatchPlace::free and base + slope weight for every weight, and
/// 0 where that is negative.
struct HatPart {
  double ceiling = 0.0;  ///< 0: the hat does not reach the patch
  double per_free = 0.0;
  std::array<double, patch_corners_max> base{}, slope{};

  [[nodiscard]] bool reaches() const noexcept { return ceiling > 0.0; }
  [[nodiscard]] double at(const PatchPlace& place) const noexcept;
};

/// The hat over a surface point p0: 1 there and, with c_a the weight of anchor point a at p0 and w_a elsewhere, the
/// least over the a of p0's patch of 1 + (w_a - c_a) / max(c_a, hat_weight), but no more than in proportion to how free
/// a point is, and never negative. In a triangle, away from its edges, that is linear on the three triangles into which
/// p0 parts it. Weights being continuous, the hat is so over all patches and in p0: when p0 crosses an edge or an
/// anchor point its hat has spread over all patches there. Held surface stays put.
/// @param from the patch with p0; @param top p0's place in it, not held; @param to the patch asked for
[[nodiscard]] HatPart hat_part(const Patch& from, const PatchPlace& top, const Patch& to) noexcept;

/// The same for angles to the normal, which say nothing beyond a crease: the hat ends there.
[[nodiscard]] HatPart hat_part_to_creases(const Patch& from, const PatchPlace& top, const Patch& to) noexcept;

}  // namespace touchstone::fast
