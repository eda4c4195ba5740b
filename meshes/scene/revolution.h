// Surfaces of revolution about z: the profile curve and the shape it sweeps out.
#pragma once

#include "scene/shape.h"

#include <string>
#include <vector>

namespace touchstone::scene {

/// A convex profile in the meridian half-plane (r, z), from its lowest point on the axis up to its highest: corners
/// joined by straight lines or by circular arcs that bulge outwards and turn less than half a circle.
struct Profile {
  std::vector<Eigen::Vector2d> rz_m;  ///< corners (r, z) [m]; first and last on the axis, r = 0
  std::vector<double> arc_radius_m;   ///< per piece between two corners, 0 for a straight one; empty: all straight
};

/// What keeps a profile from bounding a convex body of revolution, in words; empty when nothing does. A non-convex
/// profile is named with the corner that turns inwards.
[[nodiscard]] std::vector<std::string> profile_faults(const Profile& profile);

/// Profiles of the shapes with names, centred on the origin.
/// @param length_m of the straight part
[[nodiscard]] Profile capsule_profile(double radius_m, double length_m);
/// @param length_m overall; @param edge_radius_m of the fillet at both rims, 0 for sharp ones
[[nodiscard]] Profile cylinder_profile(double radius_m, double length_m, double edge_radius_m);

/// A convex surface of revolution about the z axis. Patches: from the bottom up, every piece of the profile gives four,
/// one per quadrant of the azimuth (quadrant q from q to q + 1 right angles), except that a piece which ends on the
/// axis at the top gives one patch, the whole cap, unless it meets the axis at an angle (the tip of a cone).
/// The bottom cap of a flat or pointed body likewise; a domed bottom has four patches.
class Revolution final : public Shape {
 public:
  /// @param profile without profile_faults(); @param offset_m added to every point
  explicit Revolution(Profile profile, const Vec3& offset_m = Vec3::Zero());
  [[nodiscard]] int patch_count() const noexcept override;
  [[nodiscard]] SurfacePoint at(int patch, double u, double v) const noexcept override;
  [[nodiscard]] SurfaceQuery query(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double area_m2() const noexcept override;
  [[nodiscard]] double volume_m3() const noexcept override;
  [[nodiscard]] Bounds bounds() const noexcept override;
};

}  // namespace touchstone::scene
