// Distance to the surface of a convex shape along a line from inside, without a closed form.
#pragma once

#include "scene/shape/box.h"

#include <algorithm>

namespace touchstone::scene {

/// Distance from points inside any convex shape along one direction to its surface, by Newton's method on its signed
/// distance. Along a line that is convex: whatever the first step from inside, it ends on the surface or beyond, and
/// from there the steps come back without passing the surface.
template <class Body>
class ConvexExit {
 public:
  /// @param direction unit length
  ConvexExit(const Body& body, const Vec3& direction) noexcept
      : body_(body),
        direction_(direction),
        around_(0.5 * (body.bounds().lower_m + body.bounds().upper_m), body.bounds().upper_m - body.bounds().lower_m),
        bounds_(around_.exit_along(direction)),
        tolerance_m_(1e-13 * 2.0 * around_.half_m().maxCoeff()) {}
  [[nodiscard]] double operator()(const Vec3& p_m) const noexcept {
    const SurfaceQuery start = body_.query(p_m);
    if (!(start.signed_distance_m < 0.0)) return 0.0;
    const double farthest_m = bounds_(p_m), slope = start.normal.dot(direction_);
    // The distance cannot be shorter than the signed one, and a first step that hardly climbs would go too far.
    double way_m = -start.signed_distance_m < slope * farthest_m ? -start.signed_distance_m / slope : farthest_m;
    for (int step = 0; step < most_steps; ++step) {
      const SurfaceQuery here = body_.query(p_m + way_m * direction_);
      const double climb = here.normal.dot(direction_);
      if (!(here.signed_distance_m > tolerance_m_) || !(climb > 0.0)) break;
      way_m -= here.signed_distance_m / climb;
    }
    return std::max(way_m, -start.signed_distance_m);
  }

 private:
  static constexpr int most_steps = 60;
  const Body& body_;
  Vec3 direction_;
  Box around_;
  BoxExit bounds_;
  double tolerance_m_;
};

}  // namespace touchstone::scene
