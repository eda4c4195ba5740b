// Loops over the points of a contact region that run over several points at once. Every number is the one that the same
// formula gives for a single point with Eigen's vectors, bit by bit.
#pragma once

#include "fast/contact/contact_law.h"
#include "fast/contact/region_points.h"
#include "fast/contact/rest_distance.h"
#include "scene/shape/solids.h"

#include <cstddef>

namespace touchstone::fast {

/// Sets cos_theta and keeps the points where it is not negative. @param d_T unit direction of deformation, tool frame
void keep_facing(const scene::Vec3& d_T, RegionPoints& points) noexcept;

/// Sets the depths: the way out from each point.
template <class WayOut>
void set_depths(const WayOut& way_out_m, RegionPoints& points) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i)
    points.depth_m[i] = way_out_m(points.p_W_m(i));
}
void set_depths(const scene::BoxExit& way_out_m, RegionPoints& points) noexcept;
void set_depths(const scene::SphereExit& way_out_m, RegionPoints& points) noexcept;
void set_depths(const scene::EllipsoidExit& way_out_m, RegionPoints& points) noexcept;

/// How the depth changes along a way in the tool's surface, which d leads from to a tangent plane of the rest surface.
/// @param exit_normal of that plane, outward
[[nodiscard]] inline scene::Vec3 depth_slope_T(const scene::Mat3& R_WT, const scene::Vec3& d,
                                               const scene::Vec3& exit_normal) noexcept {
  // A way that grazes the surface ends soon.
  return R_WT.transpose() * (exit_normal / std::min(exit_normal.dot(d), -0.3));
}
/// Sets how the depths change along the two vectors of the points' spread, where d leads to the plane of the closest
/// point.
void set_rises(const scene::Mat3& R_WT, const scene::Vec3& d, RegionPoints& points) noexcept;
/// The same where it leads to a face of the box.
void set_rises(const scene::BoxExit& way_out, const scene::Mat3& R_WT, const scene::Vec3& d,
               RegionPoints& points) noexcept;

/// Whether some of the depths, with their spread, goes beyond a limit.
[[nodiscard]] bool reaches_limit(double limit_m, const RegionPoints& points) noexcept;

/// What stands for the share of a point that is too near the line through the mass centre for the first terms of a
/// series.
inline constexpr double near_the_line = -1.0;
/// Sets every share to the integral of 1 / r over the point's part of the surface, or to near_the_line, and takes from
/// the depth what its change over that part and that of 1 / r make together.
void set_shares(const scene::Vec3& d_T, RegionPoints& points) noexcept;

/// F_i and d_i of the points [begin, begin + count). @tparam spread RegionPoints::spread
template <bool spread>
void point_forces(const DuffingLaw& law, const RegionPoints& points, double depth_scale, std::size_t begin,
                  std::size_t count, double* force_n, double* depth_m) noexcept;

}  // namespace touchstone::fast
