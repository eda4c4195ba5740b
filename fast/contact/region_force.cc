#include "fast/contact/region_force.h"

#include "fast/contact/point_loops.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::fast {

using scene::Vec3;

namespace {

template <bool spread>
RegionLoad load_of(const DuffingLaw& law, const RegionPoints& points, double depth_scale) noexcept {
  RegionLoad sum;
  constexpr std::size_t batch = 64;
  double force_n[batch], depth_m[batch];
  const auto all = static_cast<std::size_t>(points.count);
  for (std::size_t begin = 0; begin < all; begin += batch) {
    const std::size_t count = std::min(batch, all - begin);
    point_forces<spread>(law, points, depth_scale, begin, count, force_n, depth_m);
    for (std::size_t k = 0; k < count; ++k) {
      sum.force_n += force_n[k];
      sum.center_T_m += force_n[k] * points.p_T_m(begin + k);
      sum.deepest_m = std::max(sum.deepest_m, depth_m[k]);
    }
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
