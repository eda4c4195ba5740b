// Anchor points of a body and the surface patches between them, sections V-A and V-E.
#pragma once

#include "fast/skeleton/anchor_rule.h"
#include "scene/model/scene.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace touchstone::fast {

inline constexpr int patch_corners_max = 4;

/// Where a surface point lies in its patch.
struct PatchPlace {
  /// Weight of each of the patch's anchor points; they sum to 1.
  std::array<double, patch_corners_max> weight{};
  /// How far from the held surface: 0 on it, 1 at its farthest on a patch that borders on it, and 1 on all others.
  double free = 0.0;

  /// True on held surface.
  [[nodiscard]] bool held() const noexcept { return free <= 0.0; }
};

/// Where PatchPlaces go by component, in single precision.
struct PlaceColumns {
  std::array<float*, patch_corners_max> weight;
  float* free;
};

/// The anchor points p_i of a body, the patches they bound, and which of them the support holds.
/// Immutable after construction; at() is noexcept and free of heap use.
class AnchorPoints {
 public:
  virtual ~AnchorPoints() = default;
  /// Anchor points on the rest surface [m].
  [[nodiscard]] const std::vector<scene::Vec3>& points_m() const noexcept { return points_m_; }
  /// Why each is one.
  [[nodiscard]] const std::vector<AnchorReason>& reasons() const noexcept { return reasons_; }
  /// True for an anchor point on held surface: it never moves.
  [[nodiscard]] const std::vector<bool>& held() const noexcept { return held_; }
  /// Per patch of the shape, its anchor points in the order of PatchPlace::weight. A patch with fewer than four
  /// repeats its first at the end, whose repeated weight is 0.
  [[nodiscard]] const std::vector<std::array<int, patch_corners_max>>& patches() const noexcept { return patches_; }
  /// A patch's anchor points in their order around it.
  [[nodiscard]] virtual std::vector<int> around(int patch) const = 0;
  /// False for a patch that goes on where another one ends, between the same anchor points.
  [[nodiscard]] virtual bool first_between_its_anchors(int patch) const;
  /// Centre of the shortest curve on a patch between two of its anchor points [m], appendix IV.
  [[nodiscard]] virtual scene::Vec3 halfway_m(int patch, int i, int j) const = 0;
  /// @param p_m a point of the rest surface on that patch
  [[nodiscard]] virtual PatchPlace at(int patch, const scene::Vec3& p_m) const noexcept = 0;
  /// The same of many points, by component.
  virtual void at(int patch, const std::array<std::span<const double>, 3>& p_m, const PlaceColumns& out) const noexcept;

 protected:
  /// Adds an anchor point that the rule has found, at its exact place.
  void add(const scene::Vec3& point_m, bool held, AnchorReason reason);
  /// The place of these weights, as free as their part on anchor points that are not held.
  [[nodiscard]] PatchPlace place(int patch, const std::array<double, patch_corners_max>& weight) const noexcept;

  std::vector<scene::Vec3> points_m_;
  std::vector<AnchorReason> reasons_;
  std::vector<bool> held_;
  std::vector<std::array<int, patch_corners_max>> patches_;
};

/// A box: its eight vertices. Faces are bilinear in their edges, so a face's displacement is that of its corners, and
/// the held bottom corners keep the bottom face and the lower edges of the sides at rest.
class BoxAnchors final : public AnchorPoints {
 public:
  /// Anchor i has bit 0 set at +x, bit 1 at +y, bit 2 at +z. The bottom face is held.
  explicit BoxAnchors(const scene::Box& box);
  [[nodiscard]] std::vector<int> around(int patch) const override;
  [[nodiscard]] scene::Vec3 halfway_m(int patch, int i, int j) const override;
  [[nodiscard]] PatchPlace at(int patch, const scene::Vec3& p_m) const noexcept override;
  void at(int patch, const std::array<std::span<const double>, 3>& p_m,
          const PlaceColumns& out) const noexcept override;

 private:
  scene::Box box_;
};

/// An ellipsoid or a sphere: the six ends of its axes, in the order +x, -x, +y, -y, +z, -z. Octants are barycentric in
/// |x_k / a_k|: on a sphere, in the flat triangle of their anchors seen from the centre. Below the equator the held
/// ring takes the place of the held pole: the displacement is that of the equator, falling linearly in height to zero
/// at the support, and zero below it.
class EllipsoidAnchors final : public AnchorPoints {
 public:
  /// @param support_height_m surface below this height is held; less than that of the centre
  EllipsoidAnchors(const scene::Sphere& sphere, double support_height_m);
  EllipsoidAnchors(const scene::Ellipsoid& ellipsoid, double support_height_m);
  [[nodiscard]] std::vector<int> around(int patch) const override;
  [[nodiscard]] scene::Vec3 halfway_m(int patch, int i, int j) const override;
  using AnchorPoints::at;
  [[nodiscard]] PatchPlace at(int patch, const scene::Vec3& p_m) const noexcept override;

 private:
  EllipsoidAnchors(const scene::Shape& shape, const scene::Vec3& center_m, const scene::Vec3& semi_axes_m,
                   double support_height_m);

  scene::Vec3 center_m_, semi_axes_m_;
  double support_height_m_;
};

/// A surface of revolution: four points per anchor circle, on +x, +y, -x, -y from the axis, from the bottom up, and its
/// tips. A body whose bottom is a dome also has its lowest point, which is on the support.
///
/// The pieces of the profile between two circles, or a circle and the axis, make a band. s is the arc length along it,
/// phi' = sin phi / (sin phi + cos phi) the distance along the chord of a quadrant. Displacements are linear in both,
/// on a band and on a sector that ends in a tip or a held pole. A cap without an anchor point on the axis is one patch
/// over all four points of its rim: with t the arc length from the axis over that of the rim, a = t cos phi / (|cos
/// phi| + |sin phi|) and b = t sin phi / (...) lie in a diamond whose corners are the points, and weights are bilinear
/// in it. Where a band crosses the support's height the height over it, from 0 to 1 at the band's upper end, is used in
/// place of s: the displacement falls linearly to zero there, and below it all is held.
///
/// Where the rule finds no circle, as on a sphere written as a profile, the profile's corners take their place: the
/// sphere's upper pole would lie inside a patch.
class RevolutionAnchors final : public AnchorPoints {
 public:
  /// @param support_height_m surface below this height is held; a flat bottom is held with its rim, and only it
  RevolutionAnchors(const scene::Revolution& revolution, double support_height_m);
  [[nodiscard]] std::vector<int> around(int patch) const override;
  [[nodiscard]] bool first_between_its_anchors(int patch) const override;
  [[nodiscard]] scene::Vec3 halfway_m(int patch, int i, int j) const override;
  using AnchorPoints::at;
  [[nodiscard]] PatchPlace at(int patch, const scene::Vec3& p_m) const noexcept override;

 private:
  enum class Kind { band, sector_up, sector_down, cap };  ///< a sector by where its pole is
  /// A piece of the profile in its band. Arc lengths from the bottom, heights in the world frame.
  struct Part {
    Kind kind = Kind::band;
    int first_piece = 0;               ///< of the band
    int low = -1, high = -1;           ///< first anchor point of the band's lower and upper end
    double arc_begin_m = 0.0;          ///< of the piece
    double low_m = 0.0, high_m = 0.0;  ///< of the band, along the arc
    double band_top_m = 0.0;           ///< height of the band's
    bool crosses = false;              ///< the support's height lies within the band
    double rim_m = 0.0;                ///< cap: arc length from the axis to its rim
    double held_rim_m = 0.0;           ///< cap with its rim held: the same to where the held surface begins, else 0
  };
  void find_circles(std::vector<bool>& circle, std::vector<AnchorReason>& reason) const;
  void place_bands(const std::vector<int>& anchor_of_corner);
  [[nodiscard]] double height_m(int corner) const noexcept;
  [[nodiscard]] bool at_or_below_support(double height_m) const noexcept;
  /// Arc length from the bottom of a point on a piece, by its place (r, z) without the offset.
  [[nodiscard]] double arc_m(int piece, const Eigen::Vector2d& rz_m) const noexcept;
  [[nodiscard]] double arc_at_height_m(int piece, double height_m) const;
  /// @param quarters azimuth in right angles
  [[nodiscard]] scene::Vec3 on_surface_m(double arc_m, double quarters) const;

  scene::Revolution revolution_;
  double support_height_m_;
  double length_m_ = 0.0;  ///< of the profile
  std::vector<Part> parts_;
  std::vector<double> anchor_arc_m_;  ///< where each anchor point lies on the profile
  std::vector<int> anchor_quarter_;   ///< its azimuth in right angles; -1 on the axis
};

/// By the rule of section V-A.
[[nodiscard]] std::unique_ptr<const AnchorPoints> anchor_points(const scene::Body& body, const scene::Shape& shape);

}  // namespace touchstone::fast
