// The deformed shape of several contact regions, section VI-B: its two formulations.
#pragma once

#include "fast/surface/region_passes.h"
#include "fast/surface/region_point.h"
#include "fast/surface/shape_stack.h"

namespace touchstone::fast {

/// One formulation. With a single region both passes equal interpolate_* and apply_local_factor_*.
struct SeveralRegions {
  AddRegion add = nullptr;
  InterpolateSeveral interpolate = nullptr;
  ApplyLocalFactors apply_local_factors = nullptr;
  DisplacementAt displacement_at = nullptr;
  DisplacementsAt displacements_at = nullptr;
};

/// As printed: lengths and angles, region upon region at every vertex, an earlier contact point entering with length
/// zero and, having no direction, the angle of the mean displacement (errata E15). Normals and distances are those of
/// the rest shape, where section VI would take those of Shape_{i-1}.
inline constexpr SeveralRegions several_regions_published{add_region_published, interpolate_several_published,
                                                          apply_local_factors_published, displacement_at_published,
                                                          displacements_at_published};

/// Errata E15: vectors. Being linear, the anchor points' parts and the coefficients of all regions are summed first:
/// one pass over the surface, then one hat per region.
inline constexpr SeveralRegions several_regions_corrected{add_region_corrected, interpolate_several_corrected,
                                                          apply_local_factors_corrected, displacement_at_corrected,
                                                          displacements_at_corrected};

}  // namespace touchstone::fast
