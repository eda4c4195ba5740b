// Global deformation: the displacements of the anchor points and of the contact point spread over the patches between
// them, section V-E.
#pragma once

#include "fast/surface/surface_patches.h"

#include <vector>

namespace touchstone::fast {

/// The contact point that takes part in the interpolation.
struct ContactPoint {
  scene::Vec3 displacement_m = scene::Vec3::Zero();  ///< D d; zero on the held surface, which does not move
  scene::Vec3 normal = scene::Vec3::UnitZ();         ///< of the rest surface at p0
  int patch = 0;                                     ///< that holds p0
  PatchPlace place;                                  ///< of p0 in it
};

/// Fills field.displacement_m of every vertex.
///
/// A quantity q of patch k is the sum of its anchor points' q by weight. The contact point enters as one more
/// interpolation point: its q minus that of the anchor points alone at p0, times the kernel function of p0 (hat.h). The
/// supported surface does not move: a held anchor point has no displacement, and on the held surface the other anchor
/// points have zero weight and the kernel function is zero.
using Interpolate = void (*)(const SurfacePatches&, const std::vector<scene::Vec3>& anchor_displacement_m,
                             const ContactPoint&, SurfaceField&) noexcept;

/// As printed: q is the length of the displacement and its angle to the outward normal. Errata E15: the angle alone
/// leaves the azimuth undefined; here it is that of the mean displacement of the patch's interpolation points. A point
/// that does not move has no angle and takes that of the same mean. Lengths are kept >= 0 and angles within 0 to pi.
void interpolate_published(const SurfacePatches&, const std::vector<scene::Vec3>& anchor_displacement_m,
                           const ContactPoint&, SurfaceField&) noexcept;

/// Errata E15: q is the displacement vector.
void interpolate_corrected(const SurfacePatches&, const std::vector<scene::Vec3>& anchor_displacement_m,
                           const ContactPoint&, SurfaceField&) noexcept;

}  // namespace touchstone::fast
