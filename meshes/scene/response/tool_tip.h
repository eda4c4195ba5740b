// The parts of a tool that touch a body: surfaces of revolution about the surface's normal, or a capsule on its side.
#pragma once

#include "scene/model/scene.h"

#include <cstddef>
#include <string>
#include <vector>

namespace touchstone::scene {

/// A ball, a ball that is swept along a line, or a flat disc with a rounded rim. Frame T is the tool's.
struct ToolTip {
  Vec3 center_T_m = Vec3::Zero();     ///< of the ball; of the line; of the disc
  Vec3 axis_T = Vec3::Zero();         ///< of the disc, out of the tool, unit length; zero for a ball
  Vec3 half_line_T_m = Vec3::Zero();  ///< from the line's centre to one end of it; zero for a ball
  double flat_radius_m = 0.0;         ///< of the disc without its rim
  double radius_m = 0.0;              ///< of the ball, or of the rim's fillet

  /// Round below; also where it is swept along a line.
  [[nodiscard]] bool ball() const noexcept { return axis_T.isZero(0.0); }
  [[nodiscard]] bool line() const noexcept { return !half_line_T_m.isZero(0.0); }
  /// A ball that is not swept.
  [[nodiscard]] bool round() const noexcept { return ball() && !line(); }
  /// The radius up to which there is a tip.
  [[nodiscard]] double reach_m() const noexcept { return flat_radius_m + radius_m; }
  /// Height of the tip's surface over its lowest plane at radius r [m], of a line at distance r from it; beyond its
  /// reach that of the rim.
  [[nodiscard]] double height_m(double r_m) const noexcept;
  /// Its slope at radius r, below the reach.
  [[nodiscard]] double slope(double r_m) const noexcept;
};

/// Where a tip touches: the surface's point below it, and how deep it is there.
struct Touch {
  Vec3 point_m = Vec3::Zero();  ///< p0, on the rest surface
  Vec3 normal = Vec3::UnitZ();  ///< outward
  double depth_m = 0.0;         ///< D; negative while apart
  double tilt = 0.0;            ///< of a disc or a line against the surface [rad]; 0 for a ball
};
[[nodiscard]] Touch touch(const Shape& body, const ToolTip& tip, const Pose& pose) noexcept;

/// The largest tilt at which a disc or a line counts as lying flat [rad].
inline constexpr double tilt_max = 0.02;

/// Tips at most.
inline constexpr std::size_t tips_max = 10;

/// The tips that touch the body on the scene's track, or in words why they are not of the kinds above, completing "the
/// response model needs that ...".
struct FoundTips {
  std::vector<ToolTip> tips;  ///< at least one where there is no reason
  std::string why;
};

}  // namespace touchstone::scene
