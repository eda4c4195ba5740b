#include "fast/contact/region_force.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::fast {

using scene::Vec3;

namespace {

template <bool spread>
RegionLoad load_of(const DuffingLaw& law, const RegionPoints& points, double depth_scale) noexcept {
  RegionLoad sum;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const double depth_m = depth_scale * points.depth_m[i];
    double F_i = points.share[i];
    if constexpr (spread) {
      // A ramp begins at depth 0.
      const double spread_m = std::min(depth_scale * points.depth_spread_m(i), depth_m / std::numbers::sqrt3);
      // Exact for a cubic law over depths that vary evenly about their mean.
      F_i *= 0.5 * (law.force_n(depth_m - spread_m) + law.force_n(depth_m + spread_m));
    } else {
      F_i *= law.force_n(depth_m);
    }
    sum.force_n += F_i;
    sum.center_T_m += F_i * points.p_T_m(i);
    sum.deepest_m = std::max(sum.deepest_m, depth_m);
  }
  if (sum.force_n > 0.0) sum.center_T_m /= sum.force_n;
  return sum;
}

}  // namespace

RegionLoad region_load(const DuffingLaw& law, const RegionPoints& points, double depth_scale) noexcept {
  return points.spread ? load_of<true>(law, points, depth_scale) : load_of<false>(law, points, depth_scale);
}

RegionForce region_force(const DuffingLaw& law, const scene::Mat3& R_WT, const Vec3& d,
                         const RegionPoints& points) noexcept {
  const RegionLoad load = region_load(law, points);
  RegionForce force;
  force.load_center_m = R_WT * load.center_T_m;
  force.saturated = load.deepest_m > law.peak_depth_m();
  set_force(d, load.force_n, Vec3::Zero(), force);
  return force;
}

void set_force(const Vec3& d, double normal_n, const Vec3& tangential_n, RegionForce& force) noexcept {
  force.normal_n = normal_n;
  force.tangential_n = tangential_n;
  force.force_n = tangential_n - normal_n * d;
  force.magnitude_n = std::hypot(normal_n, tangential_n.norm());
  force.torque_nm = force.load_center_m.cross(force.force_n);
}

}  // namespace touchstone::fast
