// How the tool's mass is shared out over the points of a contact region, appendix III.
#pragma once

#include "fast/contact_detection.h"

namespace touchstone::fast {

/// Sets share[i] = m_i / m of every point, from r_i (distance of p_i from the line through the tool's mass centre along
/// d), theta_i and A_i. Shares are >= 0 and sum to 1; where all weights vanish they are uniform.
/// @param d_T unit direction of deformation in tool coordinates
/// @param r_0_m spacing of the tool's samples
using DistributeMass = void (*)(const scene::Vec3& d_T, double r_0_m, RegionPoints& points) noexcept;

/// As printed: m_i ~ r_i cos(theta_i). Errata E6: the printed formula contradicts the text beside it; a point under the
/// mass centre gets nothing. Guarded where the sum vanishes.
void distribute_mass_published(const scene::Vec3& d_T, double r_0_m, RegionPoints& points) noexcept;

/// Errata E6: m_i ~ A_i cos(theta_i) / sqrt(r_i^2 + r_0^2), which is the text's "inversely proportional", kept finite
/// under the mass centre and free of the samples' density.
void distribute_mass_corrected(const scene::Vec3& d_T, double r_0_m, RegionPoints& points) noexcept;

}  // namespace touchstone::fast
