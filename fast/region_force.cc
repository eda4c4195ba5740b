#include "fast/region_force.h"

namespace touchstone::fast {

using scene::Vec3;

RegionForce region_force(const DuffingLaw& law, const scene::Mat3& R_WT, const Vec3& d,
                         const RegionPoints& points) noexcept {
  RegionForce sum;
  Vec3 load_center_T = Vec3::Zero();  // sum of F_i p_i
  double deepest_m = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const double F_i = points.share[i] * law.force_n(points.depth_m[i]);
    sum.magnitude_n += F_i;
    load_center_T += F_i * Vec3(points.x_T_m[i], points.y_T_m[i], points.z_T_m[i]);
    deepest_m = std::max(deepest_m, points.depth_m[i]);
  }
  sum.saturated = deepest_m > law.peak_depth_m();
  sum.force_n = -sum.magnitude_n * d;
  // All forces share the direction -d, so their moments add up to that of the load's centre.
  sum.torque_nm = (R_WT * load_center_T).cross(-d);
  return sum;
}

}  // namespace touchstone::fast
