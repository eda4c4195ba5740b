#include "fast/contact/equivalent_point.h"

#include "fast/contact/point_loops.h"

#include <algorithm>

namespace touchstone::fast {

using scene::Vec3;

DeformationOrigin deformation_origin(const scene::Shape& body, ExitDistance exit_distance_m, const Vec3& d,
                                     const RegionExtent& extent) noexcept {
  const Vec3 along_d_m = extent.center_W_m - exit_distance_m(body, extent.center_W_m, -d) * d;
  // The closest point removes the rounding of the projection and names the patch.
  return origin_at(body, along_d_m);
}

DeformationOrigin origin_at(const scene::Shape& body, const Vec3& p_W_m) noexcept {
  const scene::SurfaceQuery on_surface = body.query(p_W_m);
  return {on_surface.point_m, on_surface.normal, on_surface.patch};
}

bool limit_depths(double limit_m, RegionPoints& points) noexcept {
  if (!reaches_limit(limit_m, points)) return false;
  bool held = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    held = held || points.depth_m[i] > limit_m;
    points.depth_m[i] = std::min(points.depth_m[i], limit_m);
    if (!points.spread) continue;
    const double spread_m = points.depth_spread_m(i), left_m = limit_m - points.depth_m[i];
    if (!(spread_m > left_m)) continue;
    points.rise1_m[i] *= left_m / spread_m;
    points.rise2_m[i] *= left_m / spread_m;
  }
  return held;
}

}  // namespace touchstone::fast
