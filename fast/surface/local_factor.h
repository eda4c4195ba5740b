// Local neighbourhood deformation: the factor on the global displacement inside R, section V-F.
#pragma once

#include "fast/surface/surface_patches.h"

namespace touchstone::fast {

/// The paper's constants of the local factor.
struct LocalConstants {
  double C_n = 0.0;    ///< strength
  double C_r_m = 0.0;  ///< core radius, > 0
  double r_R_m = 0.0;  ///< radius of the neighbourhood R
};

/// How large the contact region is.
struct RegionSize {
  int points = 0;        ///< n, tool samples in the region
  double area_m2 = 0.0;  ///< A, RegionExtent::area_m2
};

/// What the factor of one region has in common at every vertex, in single precision.
struct FactorTerms {
  float C_n, C_r_m, inverse_C_r_per_m, inverse_r_R_per_m;
  float inverse_reach_per_m;  ///< 1 / (r_R + C_r)
  float area_part;            ///< factor on the displacement due to the region's size
  float rim_m;                ///< contact points are nearer
};

/// As printed, with the natural logarithm:
/// w'_p = (1 + C_n ln((r + C_r) / (r_R + C_r))) / (1 + ln n) for a noncontact point at distance r from p0 inside R, n
/// at least 1. Contact points, r <= sqrt(A / pi), keep their displacement. Errata E16: jumps at r_R, depends on the
/// number of samples, and becomes negative for a large C_n.
[[nodiscard]] double local_factor_published(const LocalConstants&, const RegionSize&, double r_m) noexcept;

/// Errata E16: n is replaced by max(1, A / A_0) with A_0 = pi C_r^2, a contact no larger than the core counts as a
/// point; the factor due to the area tends to 1 at r_R, where the other factor is 1; never negative. Contact points
/// keep their displacement, and the factor sets in over one core radius outside their rim, so that no edge appears
/// there.
[[nodiscard]] double local_factor_corrected(const LocalConstants&, const RegionSize&, double r_m) noexcept;

/// Weight of the factor's effect around a region's contact points, at distance r from its p0: 0 at the contact points,
/// 1 away from them. The factor above already includes that of its own region.
[[nodiscard]] double local_room_published(const LocalConstants&, const RegionSize&, double r_m) noexcept;
[[nodiscard]] double local_room_corrected(const LocalConstants&, const RegionSize&, double r_m) noexcept;

[[nodiscard]] FactorTerms factor_terms_published(const LocalConstants&, const RegionSize&) noexcept;
[[nodiscard]] FactorTerms factor_terms_corrected(const LocalConstants&, const RegionSize&) noexcept;

/// Multiplies the displacement of every vertex with r < r_R, r its rest distance from p0.
using ApplyLocalFactor = void (*)(const SurfacePatches&, const LocalConstants&, const RegionSize&,
                                  const scene::Vec3& p0_W_m, SurfaceField&) noexcept;
void apply_local_factor_published(const SurfacePatches&, const LocalConstants&, const RegionSize&,
                                  const scene::Vec3& p0_W_m, SurfaceField&) noexcept;
void apply_local_factor_corrected(const SurfacePatches&, const LocalConstants&, const RegionSize&,
                                  const scene::Vec3& p0_W_m, SurfaceField&) noexcept;

}  // namespace touchstone::fast
