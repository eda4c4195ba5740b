// A cut through the rest surface by a plane of constant y, which can then be moved with the body.
#pragma once

#include "scene/surface.h"

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
/// No rest point may lie on the plane, for it would be on either side by rounding: choose one a hair off.
[[nodiscard]] std::vector<std::vector<EdgePoint>> cut_at_y(const scene::Surface& surface, double y_m);

/// The part of a triangle with y >= y_m, as a polygon of at most four corners in the triangle's order.
[[nodiscard]] std::vector<EdgePoint> triangle_behind_y(const scene::Surface& surface, std::size_t triangle, double y_m);

}  // namespace touchstone::compare
