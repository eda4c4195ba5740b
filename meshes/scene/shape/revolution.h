// Surfaces of revolution about z: the profile curve and the shape it sweeps out.
#pragma once

#include "scene/shape/convex_exit.h"
#include "scene/shape/profile.h"
#include "scene/shape/shape.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace touchstone::scene {

class RevolutionExit;

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
  [[nodiscard]] int face_of(int patch) const noexcept override;
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

  [[nodiscard]] RevolutionExit exit_along(const Vec3& direction) const noexcept;

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

/// Pieces of the profile that sweep out cones, planes or spheres are met in closed form. A line from inside a convex
/// body leaves it once, so a meeting that lies on its piece is the exit; the piece of the last exit is tried first.
class RevolutionExit {
 public:
  /// @param direction unit length
  RevolutionExit(const Revolution& revolution, const Vec3& direction) noexcept
      : revolution_(revolution), direction_(direction), any_(revolution, direction) {}
  [[nodiscard]] double operator()(const Vec3& p_m) const noexcept {
    const Vec3 local = p_m - revolution_.offset_m();
    const double r = std::sqrt(local.x() * local.x() + local.y() * local.y());
    const int pieces = revolution_.piece_count();
    for (int k = 0; k < pieces; ++k) {
      const int index = last_ + k < pieces ? last_ + k : last_ + k - pieces;
      const double way_m = meeting_m(revolution_.piece(index), local, r);
      if (!(way_m > 0.0)) continue;
      last_ = index;
      return way_m;
    }
    return any_(p_m);
  }

 private:
  /// Distance to a piece from a point beneath it; at most 0 if it is not met, or not certainly.
  [[nodiscard]] double meeting_m(const RevolutionPiece& piece, const Vec3& local, double r) const noexcept {
    double way_m;
    if (!piece.straight() && piece.center_m.x() != 0.0) {
      way_m = ring_meeting_m(piece, local);
    } else if (!piece.straight()) {
      const Vec3 from_center = local - Vec3(0.0, 0.0, piece.center_m.y());
      const double inside_m2 = piece.radius_m * piece.radius_m - from_center.squaredNorm();
      if (!(inside_m2 > 0.0)) return -1.0;
      const double along_m = from_center.dot(direction_);
      const double root_m = std::sqrt(along_m * along_m + inside_m2);
      way_m = along_m > 0.0 ? inside_m2 / (root_m + along_m) : root_m - along_m;
    } else if (piece.start_m.y() == piece.end_m.y()) {
      way_m = (piece.start_m.y() - local.z()) / direction_.z();
      const double x = local.x() + way_m * direction_.x(), y = local.y() + way_m * direction_.y();
      const double rim_m = std::max(piece.start_m.x(), piece.end_m.x()),
                   hole_m = std::min(piece.start_m.x(), piece.end_m.x()), r2_m2 = x * x + y * y;
      return r2_m2 <= rim_m * rim_m && r2_m2 >= hole_m * hole_m ? way_m : -1.0;
    } else {
      // n_r r + n_z z = c with the normal (n_r, n_z), squared where it holds r.
      const Eigen::Vector2d along = (piece.end_m - piece.start_m) / piece.length_m;
      const double nr = along.y(), nz = -along.x();
      if (nr < 1e-3) return -1.0;  // so flat that the squares would cost digits
      const double w = nr * piece.start_m.x() + nz * (piece.start_m.y() - local.z());
      const double out_m2 = (nr * r - w) * (nr * r + w);
      if (!(out_m2 < 0.0)) return -1.0;
      const double dx = direction_.x(), dy = direction_.y(), dz = direction_.z();
      const double A = nr * nr * (dx * dx + dy * dy) - nz * nz * dz * dz;
      const double B = nr * nr * (local.x() * dx + local.y() * dy) + nz * dz * w;
      const double D = B * B - A * out_m2;
      if (!(D >= 0.0) || (A <= 0.0 && B <= 0.0)) return -1.0;
      way_m = B > 0.0 ? -out_m2 / (B + std::sqrt(D)) : (std::sqrt(D) - B) / A;
    }
    const double z = local.z() + way_m * direction_.z();
    return z >= piece.start_m.y() && z <= piece.end_m.y() ? way_m : -1.0;
  }

  /// The same for an arc off the axis: Newton's method on the distance to its circle, which is convex along the line
  /// where r is beyond the circle's centre.
  [[nodiscard]] double ring_meeting_m(const RevolutionPiece& piece, const Vec3& local) const noexcept {
    double way_m = 0.0;
    for (int step = 0; step < 20; ++step) {
      const Vec3 p_m = local + way_m * direction_;
      const double r = std::sqrt(p_m.x() * p_m.x() + p_m.y() * p_m.y());
      const double beyond_m = r - piece.center_m.x(), above_m = p_m.z() - piece.center_m.y();
      const double length_m = std::sqrt(beyond_m * beyond_m + above_m * above_m);
      if (!(beyond_m > 0.0)) return -1.0;
      const double climb =
          (beyond_m * (p_m.x() * direction_.x() + p_m.y() * direction_.y()) / r + above_m * direction_.z()) / length_m;
      const double over_m = length_m - piece.radius_m;
      if (!(climb > 0.0) || !(over_m < 0.5 * piece.radius_m)) return -1.0;
      way_m -= over_m / climb;
      if (std::abs(over_m) < 1e-9 * piece.radius_m) return way_m;
    }
    return -1.0;
  }

  const Revolution& revolution_;
  Vec3 direction_;
  ConvexExit<Revolution> any_;
  mutable int last_ = 0;
};

inline RevolutionExit Revolution::exit_along(const Vec3& direction) const noexcept { return {*this, direction}; }

}  // namespace touchstone::scene
