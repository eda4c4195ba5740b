// Where the paper's rule puts anchor points on a rest surface, section V-A: natural vertices, discontinuities of the
// curvature and of its first derivative, extrema of curvature, inflections. A search for set-up time, not for a tick.
#pragma once

#include "scene/shape/revolution.h"
#include "scene/shape/shape.h"

#include <functional>
#include <span>
#include <vector>

namespace touchstone::fast {

/// Why a point is an anchor point.
enum class AnchorReason {
  natural_vertex,       ///< three or more patches with different normals meet, or the tip of a surface of revolution
  profile_corner,       ///< the profile's tangent jumps
  curvature_jump,       ///< the profile's curvature jumps
  curvature_rate_jump,  ///< the first derivative of the profile's curvature jumps
  curvature_maximum,
  curvature_minimum,
  curvature_saddle,  ///< maximum along one principal section, minimum along the other
  inflection,        ///< the profile's curvature changes its sign
  sphere_axis,       ///< the same curvature everywhere: three perpendicular axes through the centre
  support            ///< none of the paper's: the lowest point, which ends the patches of a body whose bottom is a dome
};
/// In words, after "anchor point:".
[[nodiscard]] const char* words(AnchorReason reason) noexcept;

/// An anchor point and its reason.
struct FoundAnchor {
  scene::Vec3 point_m;
  AnchorReason reason;
};

/// A smooth piece of a plane curve by its arc length.
struct CurvePiece {
  struct Point {
    Eigen::Vector2d rz_m, normal;  ///< place and unit normal, always on the same side
    double curvature_per_m;
  };
  double length_m = 0.0;
  std::function<Point(double)> at;  ///< @param s from 0 to 1 along the piece
};

/// An anchor point of a plane curve: at part s of a piece. A joint of two pieces is s = 1 of the first.
struct CurveAnchor {
  int piece = 0;
  double s = 0.0;
  AnchorReason reason = AnchorReason::profile_corner;
};

/// The rule on an open curve that starts and ends on the axis r = 0 and goes on beyond it as its mirror image. Lines
/// and arcs have none inside; pieces of changing curvature may.
[[nodiscard]] std::vector<CurveAnchor> curve_anchors(std::span<const CurvePiece> pieces);

/// The rule on the profile of a surface of revolution.
[[nodiscard]] std::vector<CurveAnchor> profile_anchors(const scene::Revolution& revolution);

/// The rule on any shape. A surface of revolution has four points per anchor circle, on +x, +y, -x, -y from its axis,
/// and its tips. A smooth closed surface has the isolated points where the Gaussian curvature is stationary, and four
/// points of a circle of such points, on two perpendicular axes. One of the same curvature everywhere has six.
[[nodiscard]] std::vector<FoundAnchor> find_anchor_points(const scene::Shape& shape);

}  // namespace touchstone::fast
