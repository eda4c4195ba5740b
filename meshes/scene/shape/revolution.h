// Surfaces of revolution about z: the profile curve and the shape it sweeps out.
#pragma once

#include "scene/shape/profile.h"
#include "scene/shape/shape.h"

#include <vector>

namespace touchstone::scene {

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
