// Anchor points of a body and the surface patches between them, sections V-A and V-E.
#pragma once

#include "scene/scene.h"

#include <array>
#include <memory>
#include <vector>

namespace touchstone::fast {

inline constexpr int patch_corners_max = 4;

/// Where a surface point lies in its patch.
struct PatchPlace {
  /// Weight of each of the patch's anchor points; they sum to 1.
  std::array<double, patch_corners_max> weight{};
  /// Distance to each edge of the patch, in units of the patch: 0 on the edge, 1 at the far side. The line where the
  /// support begins is an edge like any other, and all are 0 on held surface.
  std::array<double, patch_corners_max> edge{};

  /// True on held surface.
  [[nodiscard]] bool held() const noexcept { return edge == std::array<double, patch_corners_max>{}; }
};

/// The anchor points p_i of a body, the patches they bound, and which of them the support holds.
/// Immutable after construction; at() is noexcept and free of heap use.
class AnchorPoints {
 public:
  virtual ~AnchorPoints() = default;
  /// Anchor points on the rest surface [m].
  [[nodiscard]] const std::vector<scene::Vec3>& points_m() const noexcept { return points_m_; }
  /// True for an anchor point on held surface: it never moves.
  [[nodiscard]] const std::vector<bool>& held() const noexcept { return held_; }
  /// Per patch of the shape, its anchor points in the order of PatchPlace::weight. A patch with fewer than four
  /// repeats its first at the end, whose repeated weight is 0.
  [[nodiscard]] const std::vector<std::array<int, patch_corners_max>>& patches() const noexcept { return patches_; }
  /// A patch's anchor points in the order in which they stand around it.
  [[nodiscard]] virtual std::vector<int> around(int patch) const = 0;
  /// Centre of the shortest curve on the surface between two anchor points of one patch [m], appendix IV.
  [[nodiscard]] virtual scene::Vec3 halfway_m(int i, int j) const = 0;
  /// @param p_m a point of the rest surface on that patch
  [[nodiscard]] virtual PatchPlace at(int patch, const scene::Vec3& p_m) const noexcept = 0;

 protected:
  std::vector<scene::Vec3> points_m_;
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
  [[nodiscard]] scene::Vec3 halfway_m(int i, int j) const override;
  [[nodiscard]] PatchPlace at(int patch, const scene::Vec3& p_m) const noexcept override;

 private:
  scene::Box box_;
};

/// A sphere: the six points on the axes through its centre, in the order +x, -x, +y, -y, +z, -z. Octants are
/// barycentric in the flat triangle of their anchors, seen from the centre. Below the equator the held circle takes
/// the place of the held pole: the displacement is that of the equator, falling linearly in height to zero at the
/// support, and zero below it.
class SphereAnchors final : public AnchorPoints {
 public:
  /// @param support_height_m surface below this height is held; less than the radius
  SphereAnchors(const scene::Sphere& sphere, double support_height_m);
  [[nodiscard]] std::vector<int> around(int patch) const override;
  [[nodiscard]] scene::Vec3 halfway_m(int i, int j) const override;
  [[nodiscard]] PatchPlace at(int patch, const scene::Vec3& p_m) const noexcept override;

 private:
  scene::Sphere sphere_;
  double support_height_m_;
};

[[nodiscard]] std::unique_ptr<const AnchorPoints> anchor_points(const scene::Body& body, const scene::Shape& shape);

}  // namespace touchstone::fast
