#include "scene/response/tool_tip.h"

#include <algorithm>
#include <cmath>

namespace touchstone::scene {

double ToolTip::height_m(double r_m) const noexcept {
  const double out_m = std::clamp(r_m - flat_radius_m, 0.0, radius_m);
  return out_m * out_m / (radius_m + std::sqrt(radius_m * radius_m - out_m * out_m));
}

double ToolTip::slope(double r_m) const noexcept {
  const double out_m = std::max(r_m - flat_radius_m, 0.0);
  return out_m / std::sqrt(std::max(radius_m * radius_m - out_m * out_m, 1e-12 * radius_m * radius_m));
}

Touch touch(const Shape& body, const ToolTip& tip, const Pose& pose) noexcept {
  const Vec3 center_m = pose.orientation * tip.center_T_m + pose.position_m;
  const SurfaceQuery nearest = body.query(center_m);
  if (tip.ball()) {
    const double rise = tip.line() ? (pose.orientation * tip.half_line_T_m.normalized()).dot(nearest.normal) : 0.0;
    return {nearest.point_m, nearest.normal, tip.radius_m - nearest.signed_distance_m,
            std::abs(std::asin(std::clamp(rise, -1.0, 1.0)))};
  }
  const Vec3 axis = pose.orientation * tip.axis_T;
  return {nearest.point_m, nearest.normal, -nearest.signed_distance_m,
          std::acos(std::clamp(-axis.dot(nearest.normal), -1.0, 1.0))};
}

}  // namespace touchstone::scene
