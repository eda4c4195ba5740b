// Where a straight line runs through a convex shape.
#pragma once

#include "scene/shape/shape.h"

#include <algorithm>

namespace touchstone::scene {

/// A straight line by its length; of no length: nothing crosses it.
struct Line {
  Line(const Vec3& from, const Vec3& to) noexcept : from_m(from), length_m((to - from).norm()) {
    if (length_m > 0.0) direction = (to - from) / length_m;
  }
  [[nodiscard]] Vec3 at(double t_m) const noexcept { return from_m + t_m * direction; }
  [[nodiscard]] Crossing within(double enter_m, double leave_m) const noexcept {
    const double enter = std::max(enter_m, 0.0), leave = std::min(leave_m, length_m);
    return leave > enter ? Crossing{enter, leave} : Crossing{};
  }
  Vec3 from_m, direction = Vec3::Zero();
  double length_m;
};

/// Of the ball |m + t d| < 1.
[[nodiscard]] Crossing cross_unit_ball(const Line& line, const Vec3& m, const Vec3& d) noexcept;

/// By the shape's exact signed distance alone, which is convex along a line: its least value by the tangents at both
/// ends, then Newton's method from outside on either side, where it never overshoots. To 1e-12 of the line's length.
[[nodiscard]] Crossing cross_convex(const Shape&, const Vec3& from_m, const Vec3& to_m) noexcept;

}  // namespace touchstone::scene
