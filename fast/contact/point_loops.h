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
/// @param least_cosine a way that grazes a surface more ends soon
[[nodiscard]] inline scene::Vec3 depth_slope_T(const scene::Mat3& R_WT, const scene::Vec3& d,
                                               const scene::Vec3& exit_normal, double least_cosine) noexcept {
  return R_WT.transpose() * (exit_normal / std::min(exit_normal.dot(d), -least_cosine));
}
/// Of a surface that curves away, and of planes that meet at an edge.
inline constexpr double grazes_curved = 0.3, grazes_plane = 0.02;

/// How the depth changes along the two vectors of a point's spread.
struct Rise {
  double along1_m, along2_m;
};
/// Sets the rises of a piece from whose middle d leads to one face, and lowers its depth if d leads from a part of it
/// to a second one: to the mean over the piece. That is so if the ways to both differ by less than they change over it.
/// @param between_m  from the first one's plane to the second one's, along d. Over the piece it is taken to vary
/// evenly.
TOUCHSTONE_INLINE void set_over_edge(const Rise& first, const Rise& second, double between_m, RegionPoints& p,
                                     std::size_t i) noexcept {
  const double change1_m = first.along1_m - second.along1_m, change2_m = first.along2_m - second.along2_m;
  const double most_m = std::sqrt(3.0 * (change1_m * change1_m + change2_m * change2_m)), over_m = most_m - between_m;
  const double share = over_m > 0.0 ? 0.5 * over_m / most_m : 0.0;
  const double depth_m = p.depth_m[i] - (over_m > 0.0 ? 0.5 * over_m * share : 0.0);
  p.depth_m[i] = depth_m > 0.0 ? depth_m : 0.0;
  p.rise1_m[i] = first.along1_m - share * change1_m;
  p.rise2_m[i] = first.along2_m - share * change2_m;
}

/// Sets how the depths change along the two vectors of the points' spread, where d leads to the plane of the closest
/// point.
void set_rises(const scene::Mat3& R_WT, const scene::Vec3& d, RegionPoints& points) noexcept;
/// The same where it leads to a face of the box. Over its edges it also lowers the depths of pieces from whose parts d
/// leads to different faces, to the mean over the piece.
void set_rises(const scene::BoxExit& way_out, const scene::Mat3& R_WT, const scene::Vec3& d,
               RegionPoints& points) noexcept;

/// Whether some of the depths, with their spread, goes beyond a limit.
[[nodiscard]] bool reaches_limit(double limit_m, const RegionPoints& points) noexcept;

/// What stands for the share of a point that is too near the line through the mass centre for the first terms of a
/// series.
inline constexpr double near_the_line = -1.0;
/// Sets every share to the integral of 1 / r over the point's part of the surface, or to near_the_line, and takes from
/// the depth what its change over that part makes together with that of 1 / r and of the normal.
void set_shares(const scene::Vec3& d_T, RegionPoints& points) noexcept;

/// F_i and d_i of the points [begin, begin + count). @tparam spread RegionPoints::spread
template <bool spread>
void point_forces(const DuffingLaw& law, const RegionPoints& points, double depth_scale, std::size_t begin,
                  std::size_t count, double* force_n, double* depth_m) noexcept;

}  // namespace touchstone::fast
