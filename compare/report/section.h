// A cut by a plane of constant y: through the rest surface, to be moved with the body, and through tool and inclusions.
#pragma once

#include "scene/model/scene.h"
#include "scene/shape/surface.h"

#include <vector>

namespace touchstone::compare {

/// A point on the edge between two rest points: (1 - share) * a + share * b.
struct EdgePoint {
  Eigen::Index a = 0, b = 0;
  double share = 0.0;

  /// The same mean of any quantity given per rest point.
  [[nodiscard]] scene::Vec3 of(const Eigen::Matrix3Xd& values) const {
    return (1.0 - share) * values.col(a) + share * values.col(b);
  }
};

/// Closed outlines of the cut, each without its first point repeated; empty when the plane misses the surface.
/// No rest point may lie on the plane, where rounding would decide its side: choose a plane slightly beside it.
/// @param gap_share  of the surface's size: ends of the cut no further apart than this belong together
[[nodiscard]] std::vector<std::vector<EdgePoint>> cut_at_y(const scene::Surface& surface, double y_m,
                                                           double gap_share = 1e-6);

/// The plane through the tool's mass centre, or the nearest that meets the body, slightly beside it so that no rest
/// point lies on it.
[[nodiscard]] double cut_y_m(const scene::Surface& surface, const scene::Pose& tool);

/// Closed outlines in the world frame, each without its first point repeated [m].
using Outlines = std::vector<std::vector<scene::Vec3>>;

/// The tool's, whatever its shape; empty when the plane misses it.
[[nodiscard]] Outlines tool_outlines_m(const scene::Tool& tool, const scene::Pose& pose, double y_m);

/// Of all inclusions where they are at rest.
[[nodiscard]] Outlines inclusion_outlines_m(const scene::Body& body, double y_m);

/// The part of a triangle with y >= y_m, as a polygon of at most four corners in the triangle's order.
[[nodiscard]] std::vector<EdgePoint> triangle_behind_y(const scene::Surface& surface, std::size_t triangle, double y_m);

}  // namespace touchstone::compare
