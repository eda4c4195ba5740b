#include "scene/mesh/mesh_checks.h"

#include "scene/base/index.h"

#include <algorithm>
#include <numeric>

namespace touchstone::scene {
namespace {

using Corners = std::array<Vec3, 3>;

struct Node {
  Vec3 lower, upper;
  int left = -1, right = -1;  ///< children, or none in a leaf
  int begin = 0, end = 0;     ///< triangles of a leaf

  [[nodiscard]] bool leaf() const noexcept { return left < 0; }
  [[nodiscard]] bool meets(const Node& other) const noexcept {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
};

/// A tree of bounding boxes of triangles.
class Tree {
 public:
  Tree(const RawMesh& mesh, std::size_t pairs_max)
      : mesh_(mesh), pairs_left_(pairs_max), order_(mesh.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    build(0, static_cast<int>(order_.size()));
  }
  [[nodiscard]] std::optional<Vec3> find() { return within(0); }

 private:
  Corners corners(int t) const {
    const auto& [a, b, c] = nth(mesh_.triangles, t);
    return {nth(mesh_.points, a), nth(mesh_.points, b), nth(mesh_.points, c)};
  }
  int build(int begin, int end);
  std::optional<Vec3> within(int node);
  std::optional<Vec3> between(int a, int b);
  std::optional<Vec3> between_triangles(int s, int t);

  const RawMesh& mesh_;
  std::size_t pairs_left_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

int Tree::build(int begin, int end) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Node node;
  node.begin = begin;
  node.end = end;
  node.lower = Vec3::Constant(INFINITY);
  node.upper = -node.lower;
  for (int i = begin; i < end; ++i) {
    for (const Vec3& p : corners(nth(order_, i))) {
      node.lower = node.lower.cwiseMin(p);
      node.upper = node.upper.cwiseMax(p);
    }
  }
  if (end - begin > 4) {
    int axis = 0;
    (node.upper - node.lower).maxCoeff(&axis);
    const int middle = (begin + end) / 2;
    const auto center = [&](int t) {
      const Corners c = corners(t);
      return c[0][axis] + c[1][axis] + c[2][axis];
    };
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int s, int t) {
      const double a = center(s), b = center(t);
      return a != b ? a < b : s < t;
    });
    node.left = build(begin, middle);
    node.right = build(middle, end);
  }
  nth(nodes_, index) = node;
  return index;
}

/// Separating axis theorem: two convex sets are apart exactly if their projections on one of these directions are: the
/// two normals, the cross products of edges and, for triangles in one plane, the in-plane normals of the edges.
bool apart(const Corners& a, const Corners& b) {
  const auto edges = [](const Corners& t) { return Corners{t[1] - t[0], t[2] - t[1], t[0] - t[2]}; };
  const Corners ea = edges(a), eb = edges(b);
  const auto apart_along = [&](const Vec3& axis) {
    double low_a = INFINITY, high_a = -INFINITY, low_b = INFINITY, high_b = -INFINITY;
    for (std::size_t k = 0; k < 3; ++k) {
      // Relative to a corner, so that far from the origin no digits are lost.
      const double pa = axis.dot(a[k] - a[0]), pb = axis.dot(b[k] - a[0]);
      low_a = std::min(low_a, pa);
      high_a = std::max(high_a, pa);
      low_b = std::min(low_b, pb);
      high_b = std::max(high_b, pb);
    }
    return low_a > high_b || low_b > high_a;
  };
  const Vec3 na = ea[0].cross(ea[1]), nb = eb[0].cross(eb[1]);
  if (apart_along(na) || apart_along(nb)) return true;
  for (const Vec3& x : ea) {
    for (const Vec3& y : eb) {
      if (apart_along(x.cross(y))) return true;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (apart_along(na.cross(ea[k])) || apart_along(nb.cross(eb[k]))) return true;
  }
  return false;
}

std::optional<Vec3> Tree::between_triangles(int s, int t) {
  if (pairs_left_-- == 0) throw TooManyPairs{};
  for (const std::int32_t i : nth(mesh_.triangles, s)) {
    for (const std::int32_t j : nth(mesh_.triangles, t)) {
      if (i == j) return std::nullopt;
    }
  }
  const Corners a = corners(s), b = corners(t);
  if (apart(a, b)) return std::nullopt;
  // The centre of the overlap of their boxes.
  Vec3 lower_a = a[0], upper_a = a[0], lower_b = b[0], upper_b = b[0];
  for (std::size_t k = 1; k < 3; ++k) {
    lower_a = lower_a.cwiseMin(a[k]);
    upper_a = upper_a.cwiseMax(a[k]);
    lower_b = lower_b.cwiseMin(b[k]);
    upper_b = upper_b.cwiseMax(b[k]);
  }
  return Vec3(0.5 * (lower_a.cwiseMax(lower_b) + upper_a.cwiseMin(upper_b)));
}

std::optional<Vec3> Tree::between(int a, int b) {
  const Node &na = nth(nodes_, a), &nb = nth(nodes_, b);
  if (!na.meets(nb)) return std::nullopt;
  if (na.leaf() && nb.leaf()) {
    for (int i = na.begin; i < na.end; ++i) {
      for (int j = nb.begin; j < nb.end; ++j) {
        if (const auto place = between_triangles(nth(order_, i), nth(order_, j))) return place;
      }
    }
    return std::nullopt;
  }
  // Descends into the larger of the two.
  if (nb.leaf() || (!na.leaf() && na.end - na.begin >= nb.end - nb.begin)) {
    const auto place = between(na.left, b);
    return place ? place : between(na.right, b);
  }
  const auto place = between(a, nb.left);
  return place ? place : between(a, nb.right);
}

std::optional<Vec3> Tree::within(int index) {
  const Node& node = nth(nodes_, index);
  if (node.leaf()) {
    for (int i = node.begin; i < node.end; ++i) {
      for (int j = i + 1; j < node.end; ++j) {
        if (const auto place = between_triangles(nth(order_, i), nth(order_, j))) return place;
      }
    }
    return std::nullopt;
  }
  for (const int child : {node.left, node.right}) {
    if (const auto place = within(child)) return place;
  }
  return between(node.left, node.right);
}

}  // namespace

std::optional<Vec3> self_intersection(const RawMesh& mesh, std::size_t pairs_max) {
  if (mesh.triangles.empty()) return std::nullopt;
  return Tree(mesh, pairs_max).find();
}

}  // namespace touchstone::scene
