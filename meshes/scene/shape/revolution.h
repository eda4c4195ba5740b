// Surfaces of revolution about z: the profile curve and the shape it sweeps out.
#pragma once

#include "scene/shape/shape.h"

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

/// A convex surface of revolution about the z axis. Patches: from the bottom up, every piece of the profile gives four,
/// one per quadrant of the azimuth (quadrant q from q to q + 1 right angles), except that a piece which ends on the
/// axis at the top gives one patch, the whole cap, unless it meets the axis at an angle (the tip of a cone).
/// A flat bottom is one patch likewise; a pointed or domed bottom has four. So a capsule has 4 + 4 + 1 patches (bottom
/// dome, side, top dome), a sharp cylinder 1 + 4 + 1, a cone standing on its base 1 + 4, a double cone 4 + 4.
/// On a quadrant's patch u runs with the azimuth and v up along the piece; on a whole cap u runs once around and v from
/// the axis to the rim. Quadrant 0 starts at +x and holds the axis; a border belongs to the quadrant it starts.
/// Of pieces equally near to a point the lowest answers the query.
class Revolution final : public Shape {
 public:
  /// @param profile without profile_faults(); @param offset_m added to every point
  explicit Revolution(Profile profile, const Vec3& offset_m = Vec3::Zero());
  [[nodiscard]] int patch_count() const noexcept override { return patch_count_; }
  [[nodiscard]] SurfacePoint at(int patch, double u, double v) const noexcept override;
  [[nodiscard]] SurfaceQuery query(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override;
  [[nodiscard]] double area_m2() const noexcept override;
  [[nodiscard]] double volume_m3() const noexcept override;
  [[nodiscard]] Bounds bounds() const noexcept override;
  [[nodiscard]] Surface tessellated(int triangles) const override;

  [[nodiscard]] int piece_count() const noexcept { return static_cast<int>(pieces_.size()); }
  /// Pieces from the bottom up, straight ones in line joined.
  [[nodiscard]] const RevolutionPiece& piece(int index) const noexcept {
    return pieces_[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] int piece_of(int patch) const noexcept;
  /// 0 to 3, or -1 for a whole cap.
  [[nodiscard]] int quadrant_of(int patch) const noexcept;
  /// The bottom is a disc.
  [[nodiscard]] bool flat_bottom() const noexcept { return pieces_.front().whole; }
  [[nodiscard]] const Vec3& offset_m() const noexcept { return offset_m_; }

  /// A point of the profile with the meridian's outward normal and curvature. @param s from 0 to 1 up along the piece
  struct MeridianPoint {
    Eigen::Vector2d rz_m, normal;
    double curvature_along_per_m, curvature_around_per_m;
  };
  [[nodiscard]] MeridianPoint meridian(int piece, double s) const noexcept;
  /// A point of the patch's piece in any quadrant. @param u in [0,1] through the quadrant; @param s as in meridian()
  [[nodiscard]] SurfacePoint at_quadrant(int patch, int quadrant, double u, double s) const noexcept;

 private:
  struct Foot {
    Eigen::Vector2d rz_m, normal;
    double signed_distance_m;
    int piece;
  };
  /// Closest point of the profile to a point (r, z), r >= 0.
  [[nodiscard]] Foot foot(const Eigen::Vector2d& p_m) const noexcept;

  std::vector<RevolutionPiece> pieces_;
  Vec3 offset_m_;
  int patch_count_ = 0;
  double size_m_ = 0.0;  ///< largest radius or height
  double radius_m_ = 0.0;
};

}  // namespace touchstone::scene
