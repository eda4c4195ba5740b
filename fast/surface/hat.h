// Kernel function (here: hat) of a contact point: its weight in the interpolation of the surface around it, section
// V-E.
#pragma once

#include "fast/surface/surface_patches.h"

namespace touchstone::fast {

/// If the weight of an anchor point at p0 is at least this, the hat is confined to the patches of that anchor point.
/// With a smaller weight it extends over the edge that p0 is near. At every p0 some anchor point has at least this
/// weight.
inline constexpr double hat_weight = 0.1;

/// A hat on one patch: the minimum of `ceiling`, per_free PatchPlace::free and base + slope weight for every weight,
/// and 0 where that is negative.
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
/// p0 divides it. The weights are continuous, so the hat is continuous over all patches and in p0: when p0 crosses an
/// edge or an anchor point, its hat already extends over all patches there. The held surface does not move.
/// @param from the patch with p0; @param top p0's place in it, not held; @param to the patch asked for
[[nodiscard]] HatPart hat_part(const Patch& from, const PatchPlace& top, const Patch& to) noexcept;

/// The same for angles to the normal. They have no meaning beyond a crease, so the hat ends there.
[[nodiscard]] HatPart hat_part_to_creases(const Patch& from, const PatchPlace& top, const Patch& to) noexcept;

}  // namespace touchstone::fast
