// Profiles of surfaces of revolution: corners joined by lines and arcs.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

namespace touchstone::scene {

/// A right angle [rad].
inline constexpr double quarter = 0.5 * std::numbers::pi;

/// a x b of vectors in the plane.
[[nodiscard]] inline double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) noexcept {
  return a.x() * b.y() - a.y() * b.x();
}

/// A convex profile in the meridian half-plane (r, z), from its lowest point on the axis up to its highest: corners
/// joined by straight lines or by circular arcs that bulge outwards and turn less than half a circle.
struct Profile {
  std::vector<Eigen::Vector2d> rz_m;  ///< corners (r, z) [m]; first and last on the axis, r = 0
  std::vector<double> arc_radius_m;   ///< per piece between two corners, 0 for a straight one; empty: all straight
};

/// What keeps a profile from bounding a convex body of revolution, in words; empty when nothing does. A non-convex
/// profile is named with the corner that turns inwards. Two pieces may meet smoothly: up to 1e-7 rad of inward turn
/// counts as rounding. Straight pieces in line with each other are allowed and become one.
[[nodiscard]] std::vector<std::string> profile_faults(const Profile& profile);

/// The profile's first piece is a disc: straight and level.
[[nodiscard]] bool flat_bottom(const Profile& profile) noexcept;

/// Profiles of the shapes with names, centred on the origin.
/// @param length_m of the straight part
[[nodiscard]] Profile capsule_profile(double radius_m, double length_m);
/// @param length_m overall; @param edge_radius_m of the fillet at both rims, 0 for sharp ones
[[nodiscard]] Profile cylinder_profile(double radius_m, double length_m, double edge_radius_m);

/// A piece of the profile between two corners, with the patches it sweeps out. Places are (r, z) about the axis,
/// without the shape's offset.
struct RevolutionPiece {
  Eigen::Vector2d start_m, end_m;                      ///< the piece runs upwards with the solid on its left
  Eigen::Vector2d center_m = Eigen::Vector2d::Zero();  ///< of the circle of an arc
  double radius_m = 0.0;                               ///< of that circle; 0: straight
  double start_angle = 0.0, end_angle = 0.0;  ///< of the outward normal over the horizontal, -pi/2 (down) to pi/2 [rad]
  double length_m = 0.0;
  int first_patch = 0;
  bool whole = false;  ///< a cap of one patch; otherwise the patches first_patch + q, q = 0..3 the quadrant

  [[nodiscard]] bool straight() const noexcept { return radius_m == 0.0; }
  [[nodiscard]] int patch_count() const noexcept { return whole ? 1 : 4; }
};

/// Turn below which two pieces of a profile meet smoothly [rad].
constexpr double smooth_turn = 1e-7;

/// Without its patches. @param index of the corner where it starts
[[nodiscard]] RevolutionPiece profile_piece(const Profile& profile, std::size_t index) noexcept;

}  // namespace touchstone::scene
