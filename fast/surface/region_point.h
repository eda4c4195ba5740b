// Displacement of single points, and of a block of them, in the shape of several contact regions: what contact of a
// later region needs.
#pragma once

#include "fast/contact/pull_back.h"
#include "fast/surface/shape_stack.h"

namespace touchstone::fast {

/// Displacement of a rest surface point [m], world: what the two passes (region_passes.h) give a vertex there, without
/// the pass. Only the regions in the stack count, so with regions 1 to i - 1 in it this is Shape_{i-1}.
/// @param local null where there is no local factor; @param at the point, its normal and its patch
using DisplacementAt = scene::Vec3 (*)(const SurfacePatches&, const AnchorPoints&, const ShapeStack&,
                                       const LocalConstants* local, const scene::SurfaceQuery& at) noexcept;

[[nodiscard]] scene::Vec3 displacement_at_published(const SurfacePatches&, const AnchorPoints&, const ShapeStack&,
                                                    const LocalConstants*, const scene::SurfaceQuery&) noexcept;
[[nodiscard]] scene::Vec3 displacement_at_corrected(const SurfacePatches&, const AnchorPoints&, const ShapeStack&,
                                                    const LocalConstants*, const scene::SurfaceQuery&) noexcept;

/// The same of a block of points of one patch, in single precision.
using DisplacementsAt = void (*)(const AnchorPoints&, const LocalConstants* local, int patch, ShapeStack&,
                                 PointLanes&) noexcept;
void displacements_at_published(const AnchorPoints&, const LocalConstants*, int patch, ShapeStack&,
                                PointLanes&) noexcept;
void displacements_at_corrected(const AnchorPoints&, const LocalConstants*, int patch, ShapeStack&,
                                PointLanes&) noexcept;

}  // namespace touchstone::fast
