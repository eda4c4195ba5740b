// Cells of the tool's surface: the piece of it that a sample stands for, which can be halved again and again. A contact
// that few samples reach is looked at in smaller cells, so no contact falls between the samples, and the body's
// surface cuts cells, so the contact's area does not jump by whole samples.
#pragma once

#include "fast/realtime/wide_loops.h"
#include "scene/base/frames.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace touchstone::fast {

/// A piece of a surface of revolution: a part of its meridian, turned through an angle. Places are (r, z) about the
/// axis.
struct Band {
  using Vec2 = Eigen::Vector2d;
  Vec2 start_m = Vec2::Zero(), end_m = Vec2::Zero();                ///< of the meridian's part
  Vec2 start_normal = Vec2::UnitX(), end_normal = Vec2::UnitX();    ///< of the meridian there
  Vec2 arc_center_m = Vec2::Zero();                                 ///< of an arc
  double arc_radius_m = 0.0;                                        ///< 0: straight
  double arc_angle = 0.0;                                           ///< an arc's turn [rad]
  Vec2 start_azimuth = Vec2::UnitX(), end_azimuth = Vec2::UnitX();  ///< unit vectors
  double turn = 0.0;                                                ///< angle between the two, below pi [rad]
  scene::Vec3 axis_T_m = scene::Vec3::Zero();                       ///< where (0, 0) is
};

/// How a surface is spread about its middle: the mean of x x^T over it is the sum of a a^T over these two vectors, x
/// from the middle.
using Spread = std::array<scene::Vec3, 2>;
/// How the normal changes along each of those, to first order.
using Turn = std::array<scene::Vec3, 2>;

/// Frame T. A cell that is too far away asks for the first line of the cache only, one that is wholly inside for two.
struct alignas(64) SurfaceCell {
  scene::Vec3 center_T_m;  ///< mean of its surface, so a little below a curved one
  scene::Vec3 normal_T;    ///< outward, mean over its surface
  double area_m2 = 0.0;    ///< projected along normal_T, so that a direction sees the whole cell's projection
  double radius_m = 0.0;   ///< about the centre, of a ball with all of it
  Spread spread_m;
  Turn turn{scene::Vec3::Zero(), scene::Vec3::Zero()};
  std::int32_t sample = 0;  ///< of ToolSamples, whose cell this is or was cut from
  std::int32_t group = -1;  ///< of CellGroups: neighbouring triangles of a fine mesh
  std::int8_t corners = 4;  ///< 3 or 4
  bool curved = false;      ///< `band` says how; without group: flat
  double bulge_m = 0.0;     ///< no point of it is further from the polygon of its corners
  /// Of a curved cell, for even and odd sides: at a share t of the way along, the surface is no further than
  /// 4 t (1 - t) of this from the straight side.
  std::array<double, 2> sagitta_m{};
  std::array<scene::Vec3, 4> corner_m;  ///< from the centre, in order; of a group: of a rectangle around it
  double polygon_m2 = 0.0;              ///< area of the polygon of its corners
  scene::Vec3 polygon_center_m;         ///< from the centre
  Spread sag_m{scene::Vec3::Zero(), scene::Vec3::Zero()};  ///< from the middle of an even or odd side to the surface
  Band band;
};

/// Flat cell. @param corners_T_m three or four, counterclockwise from outside
[[nodiscard]] SurfaceCell flat_cell(std::span<const scene::Vec3> corners_T_m) noexcept;
[[nodiscard]] SurfaceCell band_cell(const Band& band) noexcept;
/// Of the surface itself.
[[nodiscard]] double band_area_m2(const Band& band) noexcept;

/// A part of a cell as a vector: its outward normal times its area, projected along that normal. The normal changes
/// linearly over the cell, so that parts sum up to the whole. @param share of the cell's area
/// @param off_m  from the cell's centre to the middle of the part
[[nodiscard]] scene::Vec3 part_area_m2(const SurfaceCell& cell, double share, const scene::Vec3& off_m) noexcept;

/// A cell's border, but of a group, as a polygon that follows wide arcs closely, in order.
struct Outline {
  std::array<scene::Vec3, 10> corner_T_m;
  std::size_t corners = 0;
};
[[nodiscard]] Outline outline(const SurfaceCell& cell) noexcept;

/// Triangles of a fine mesh that share a cell, in a binary tree.
struct CellGroups {
  struct Node {
    SurfaceCell cell;
    std::array<std::int32_t, 2> child{};  ///< a node, or ~i for triangle i
  };
  std::vector<Node> nodes;
  std::vector<std::array<scene::Vec3, 3>> triangles_T_m;

  /// A node's or a triangle's cell.
  [[nodiscard]] SurfaceCell cell(std::int32_t child) const noexcept;
  /// The cell of some triangles, with their area, middle and spread.
  [[nodiscard]] SurfaceCell around(std::span<const std::int32_t> triangles) const;
  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// The two parts of a cell, cut across its longer side.
[[nodiscard]] std::array<SurfaceCell, 2> halves(const SurfaceCell& cell, const CellGroups& groups) noexcept;

/// Where a level is 0 between two corners, one above and one below, as a share of the way: one Newton step from the
/// straight side. @param bend  four times what the middle of the surface's side is above the straight one
TOUCHSTONE_INLINE double crossing(double level, double next_level, double bend) noexcept {
  const double falls = level - next_level, straight = level / falls;
  const double moved = straight + bend * straight * (1.0 - straight) / (falls - bend * (1.0 - 2.0 * straight));
  return moved > 0.0 ? (moved < 1.0 ? moved : 1.0) : 0.0;
}

/// The polygon of a cell's corners, or of any others, that half-spaces cut, at most twelve of them. Corners are vectors
/// from any one point.
class CutPolygon {
 public:
  static constexpr std::size_t max_corners = 16;
  explicit CutPolygon(std::span<const scene::Vec3> corners_m) noexcept;
  explicit CutPolygon(const SurfaceCell& cell) noexcept;
  /// Keeps the part where a level is below 0. @param level of every corner, see corners(); @param normal_T  its slope,
  /// for the bend of sides
  void keep_below(std::span<const double> level, const scene::Vec3& normal_T) noexcept;
  /// Keeps x with normal . x + level < 0.
  void keep_below(const scene::Vec3& normal_T, double level) noexcept;
  [[nodiscard]] std::span<const scene::Vec3> corners() const noexcept {
    return {corner_m_.data(), static_cast<std::size_t>(count_)};
  }
  /// Something was taken away.
  [[nodiscard]] bool is_cut() const noexcept { return cut_; }
  struct Moments {
    double area_m2 = 0.0;
    scene::Vec3 center_m = scene::Vec3::Zero();
  };
  [[nodiscard]] Moments moments() const noexcept;

 private:
  std::array<scene::Vec3, max_corners> corner_m_;
  std::array<std::int8_t, max_corners>
      side_;  ///< of the cell, 0 even or 1 odd, from this corner to the next; -1: no whole one
  Spread sag_m_{scene::Vec3::Zero(), scene::Vec3::Zero()};
  int count_ = 0;
  bool cut_ = false;
};

}  // namespace touchstone::fast
