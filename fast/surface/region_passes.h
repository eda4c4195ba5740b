// Passes over all vertices for the shape of several contact regions, section VI-B.
#pragma once

#include "fast/surface/shape_stack.h"

namespace touchstone::fast {

/// Fills field.displacement_m with the global deformation of all regions.
using InterpolateSeveral = void (*)(const SurfacePatches&, ShapeStack&, SurfaceField&) noexcept;
void interpolate_several_published(const SurfacePatches&, ShapeStack&, SurfaceField&) noexcept;
void interpolate_several_corrected(const SurfacePatches&, ShapeStack&, SurfaceField&) noexcept;

/// Adds (w_i - 1) u_i inside every region's R_i to it. A point in contact with region i or an earlier one keeps u_i: it
/// is no noncontact point. At an earlier p0_k there is no u_i to begin with, and a later region's point moves as the
/// rest of Shape_i does, on which that region is built.
using ApplyLocalFactors = void (*)(const SurfacePatches&, const LocalConstants&, ShapeStack&, SurfaceField&) noexcept;
void apply_local_factors_published(const SurfacePatches&, const LocalConstants&, ShapeStack&, SurfaceField&) noexcept;
void apply_local_factors_corrected(const SurfacePatches&, const LocalConstants&, ShapeStack&, SurfaceField&) noexcept;

}  // namespace touchstone::fast
