#include "scene/base/index.h"
#include "scene/base/least_value.h"
#include "scene/mesh/mesh_checks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace touchstone::scene {
namespace {

using Vec2 = Eigen::Vector2d;

/// A tree of bounding boxes of points, to find the point furthest along a direction.
class PointTree {
 public:
  explicit PointTree(const std::vector<Vec3>& points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    build(0, order_.size());
  }

  /// The point with the largest product with a direction, or nothing if none exceeds the bound.
  [[nodiscard]] const Vec3* furthest(const Vec3& along, double bound) const {
    const Vec3* best = nullptr;
    search(0, along, bound, best);
    return best;
  }

 private:
  struct Node {
    Vec3 lower = Vec3::Constant(INFINITY), upper = Vec3::Constant(-INFINITY);
    std::size_t begin = 0, end = 0;
    std::size_t left = 0, right = 0;  ///< children; 0 in a leaf

    [[nodiscard]] double furthest(const Vec3& along) const {
      return along.cwiseProduct(lower).cwiseMax(along.cwiseProduct(upper)).sum();
    }
  };

  std::size_t build(std::size_t begin, std::size_t end) {
    Node node;
    node.begin = begin;
    node.end = end;
    for (std::size_t i = begin; i < end; ++i) {
      node.lower = node.lower.cwiseMin(points_[order_[i]]);
      node.upper = node.upper.cwiseMax(points_[order_[i]]);
    }
    const std::size_t index = nodes_.size();
    nodes_.emplace_back();
    if (end - begin > 8) {
      int axis = 0;
      (node.upper - node.lower).maxCoeff(&axis);
      const auto first = order_.begin() + static_cast<std::ptrdiff_t>(begin),
                 last = order_.begin() + static_cast<std::ptrdiff_t>(end), middle = first + (last - first) / 2;
      std::nth_element(first, middle, last,
                       [&](std::size_t a, std::size_t b) { return points_[a][axis] < points_[b][axis]; });
      node.left = build(begin, (begin + end) / 2);
      node.right = build((begin + end) / 2, end);
    }
    nodes_[index] = node;
    return index;
  }

  void search(std::size_t index, const Vec3& along, double& bound, const Vec3*& best) const {
    const Node& node = nodes_[index];
    if (node.furthest(along) <= bound) return;
    if (node.left == 0) {
      for (std::size_t i = node.begin; i < node.end; ++i) {
        const Vec3& point = points_[order_[i]];
        if (!(along.dot(point) > bound)) continue;
        bound = along.dot(point);
        best = &point;
      }
      return;
    }
    const bool left_first = nodes_[node.left].furthest(along) > nodes_[node.right].furthest(along);
    search(left_first ? node.left : node.right, along, bound, best);
    search(left_first ? node.right : node.left, along, bound, best);
  }

  const std::vector<Vec3>& points_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

using Corners = std::array<Vec3, 3>;

/// A direction, `normal` or one within some 60 degrees of it, along which no point of the tree is further than the
/// triangle's lowest corner plus the tolerance; nothing if there is none.
std::optional<Vec3> outward_direction(const PointTree& tree, const Corners& corners, const Vec3& normal,
                                      double tolerance) {
  // Excess of the furthest point, and its derivative by the direction; the excess is convex in the direction.
  const auto excess = [&](const Vec3& along) {
    std::array<double, 3> at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = along.dot(corners[k]);
    const auto lowest = static_cast<std::size_t>(std::min_element(at.begin(), at.end()) - at.begin());
    const Vec3* above = tree.furthest(along, at[lowest] + tolerance);
    if (above == nullptr) return Sample<3>{0.0, Vec3::Zero()};
    return Sample<3>{along.dot(*above) - at[lowest] - tolerance, *above - corners[lowest]};
  };
  if (excess(normal).value == 0.0) return normal;
  // Directions normal + t_x x + t_y y, with x and y perpendicular to the normal.
  constexpr double furthest_tangent = 2.0;
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
  const double close = 1e-3 * tolerance;
  std::optional<Vec3> found;
  least_value<2>(
      Vec2::Zero(), furthest_tangent, close, close,
      [&](const Vec2& t) {
        const Vec3 along = normal + t.x() * x + t.y() * y;
        const Sample<3> here = excess(along);
        if (here.value == 0.0) found = along.normalized();
        return Sample<2>{here.value, Vec2(here.gradient.dot(x), here.gradient.dot(y))};
      },
      [&](const Vec2& t) {
        const double length = t.norm();
        if (length <= furthest_tangent) return Reach<2>{0.0, t, Vec2::Zero()};
        return Reach<2>{length - furthest_tangent, t * (furthest_tangent / length), t / length};
      });
  return found;
}

/// The triangles of a mesh with their positions.
class Facets {
 public:
  explicit Facets(const RawMesh& mesh)
      : triangles_(mesh.triangles), points_(mesh.points), at_(mesh.points.size()), turn_at_(mesh.points.size()) {
    // Relative to one of the mesh's own points, so that far from the origin no digits are lost.
    for (Vec3& p : points_) p -= mesh.points.front();
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (const std::int32_t i : triangles_[t]) nth(at_, i).push_back(t);
    }
    twice_area_at_.assign(points_.size(), Vec3::Zero());
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (const std::int32_t i : triangles_[t]) nth(twice_area_at_, i) += twice_area(t);
    }
  }
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  [[nodiscard]] std::size_t size() const { return triangles_.size(); }
  [[nodiscard]] Corners corners(std::size_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return {nth(points_, a), nth(points_, b), nth(points_, c)};
  }

  /// Unit normal. For a triangle thinner than `thin` it is inaccurate, so that its neighbours are used.
  [[nodiscard]] Vec3 normal(std::size_t t, double thin) const {
    const Corners c = corners(t);
    const double longest = std::max({(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()});
    Vec3 normal = twice_area(t);
    if (normal.norm() < thin * longest) {
      normal.setZero();
      for (const std::int32_t i : triangles_[t]) normal += nth(twice_area_at_, i);
    }
    return normal.normalized();
  }

  /// Marks the triangle and those connected to it, as long as all their corners are at least `least` along the
  /// direction.
  void mark_above(std::size_t first, const Vec3& along, double least, std::vector<bool>& marked) {
    std::vector<std::size_t> next = {first};
    marked[first] = true;
    ++turn_;
    while (!next.empty()) {
      const std::size_t t = next.back();
      next.pop_back();
      for (const std::int32_t i : triangles_[t]) {
        // Visited once: a vertex may have thousands of triangles.
        if (std::exchange(nth(turn_at_, i), turn_) == turn_) continue;
        for (const std::size_t near : nth(at_, i)) {
          if (marked[near]) continue;
          const Corners c = corners(near);
          if (!std::all_of(c.begin(), c.end(), [&](const Vec3& p) { return along.dot(p) >= least; })) continue;
          marked[near] = true;
          next.push_back(near);
        }
      }
    }
  }

 private:
  [[nodiscard]] Vec3 twice_area(std::size_t t) const {
    const Corners c = corners(t);
    return (c[1] - c[0]).cross(c[2] - c[0]);
  }

  const std::vector<std::array<std::int32_t, 3>>& triangles_;
  std::vector<Vec3> points_;
  std::vector<std::vector<std::size_t>> at_;  ///< the triangles at every point
  std::vector<Vec3> twice_area_at_;           ///< their sum
  std::vector<std::size_t> turn_at_;          ///< number of the last visit
  std::size_t turn_ = 0;
};

}  // namespace

bool convex(const RawMesh& mesh, double tolerance) {
  Facets facets(mesh);
  const PointTree tree(facets.points());
  std::vector<bool> seen(facets.size(), false);
  for (std::size_t t = 0; t < facets.size(); ++t) {
    if (seen[t]) continue;
    const auto along = outward_direction(tree, facets.corners(t), facets.normal(t, tolerance), tolerance);
    if (!along) return false;
    // One plane covers all neighbouring triangles that it touches.
    const Vec3* furthest = tree.furthest(*along, -INFINITY);
    facets.mark_above(t, *along, along->dot(*furthest) - tolerance, seen);
  }
  return true;
}

}  // namespace touchstone::scene
