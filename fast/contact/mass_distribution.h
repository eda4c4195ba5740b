// Mass weights: distribution of the tool's mass over the points of a contact region, appendix III.
#pragma once

#include "fast/contact/contact_detection.h"

#include <array>
#include <limits>

namespace touchstone::fast {

/// Integrals of 1 / r over whole cells near the line through the mass centre. They depend on the cell and d alone,
/// which a press keeps from tick to tick, so they are kept.
class CellIntegrals {
 public:
  /// @return [m]
  [[nodiscard]] double over_distance_m(const SurfaceCell& cell, const CellGroups& groups,
                                       const scene::Vec3& d_T) noexcept;

 private:
  struct Kept {
    scene::Vec3 center_T_m, d_T;
    double area_m2 = std::numeric_limits<double>::quiet_NaN();  ///< equal to no other
    double over_distance_m = 0.0;
  };
  std::array<Kept, 64> kept_;
};

/// Sets share[i] = m_i / m of every point, from r_i (distance of p_i from the line through the tool's mass centre along
/// d), theta_i and A_i. The mass weights are >= 0 and sum to 1; where all terms vanish they are uniform.
/// @param d_T unit direction of deformation in tool coordinates
/// @param groups of the tool's cells
using DistributeMass = void (*)(const scene::Vec3& d_T, const CellGroups& groups, CellIntegrals&,
                                RegionPoints& points) noexcept;

/// As printed: m_i ~ r_i cos(theta_i). Errata E6: the printed formula contradicts the text beside it; a point under the
/// mass centre has weight zero. Guarded where the sum vanishes.
void distribute_mass_published(const scene::Vec3& d_T, const CellGroups& groups, CellIntegrals&,
                               RegionPoints& points) noexcept;

/// Errata E6: m_i is the integral of 1 / r over the point's area projected along d, which is the text's "inversely
/// proportional", and the depth d_i becomes the mean depth over that area weighted by 1 / r. Both are exact to second
/// order in the size of the area over r. Nearer to the mass centre the integral is that over the cell's shape, or over
/// a disc for a cut cell. So the sum over the points tends to the integral over the contact, however few they are.
void distribute_mass_corrected(const scene::Vec3& d_T, const CellGroups& groups, CellIntegrals&,
                               RegionPoints& points) noexcept;

/// Mean of 1 / r over a disc [1/m], r the distance from a point of the disc's plane.
/// @param r2_m2 squared distance of that point from the disc's centre; @param disc_radius_m > 0
[[nodiscard]] double mean_inverse_distance_per_m(double r2_m2, double disc_radius_m) noexcept;

}  // namespace touchstone::fast
