#include "fast/tool_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Splits the samples at the median of their longest side until a leaf is small enough.
class TreeBuilder {
 public:
  explicit TreeBuilder(const std::vector<Vec3>& points_m) : points_m_(points_m), order_(points_m.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    split(0, static_cast<std::int32_t>(order_.size()));
  }
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  [[nodiscard]] std::vector<SampleBall> take() { return std::move(tree_); }

 private:
  [[nodiscard]] const Vec3& at(std::int32_t i) const {
    return points_m_[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])];
  }

  void split(std::int32_t begin, std::int32_t end) {
    Vec3 lower_m = at(begin), upper_m = at(begin);
    for (std::int32_t i = begin; i < end; ++i) {
      lower_m = lower_m.cwiseMin(at(i));
      upper_m = upper_m.cwiseMax(at(i));
    }
    SampleBall ball;
    ball.center_T_m = 0.5 * (lower_m + upper_m);
    for (std::int32_t i = begin; i < end; ++i)
      ball.radius_m = std::max(ball.radius_m, (at(i) - ball.center_T_m).norm());
    // Rounding must not prune a sample that lies on the ball.
    ball.radius_m *= 1.0 + 1e-12;
    ball.begin = begin;
    ball.end = end;
    ball.leaf = end - begin <= tool_leaf_size;
    const std::size_t self = tree_.size();
    tree_.push_back(ball);
    if (!ball.leaf) {
      int axis = 0;
      (upper_m - lower_m).maxCoeff(&axis);
      const std::int32_t middle = (begin + end) / 2;
      const auto first = order_.begin();
      std::nth_element(first + begin, first + middle, first + end, [&](std::int32_t a, std::int32_t b) {
        const Vec3 &pa = points_m_[static_cast<std::size_t>(a)], &pb = points_m_[static_cast<std::size_t>(b)];
        return pa[axis] != pb[axis] ? pa[axis] < pb[axis] : a < b;
      });
      split(begin, middle);
      split(middle, end);
    }
    tree_[self].next = static_cast<std::int32_t>(tree_.size());
  }

  const std::vector<Vec3>& points_m_;
  std::vector<std::int32_t> order_;
  std::vector<SampleBall> tree_;
};

}  // namespace

std::size_t ToolSamples::memory_bytes() const noexcept {
  return 7 * x_T_m.size() * sizeof(double) + tree.size() * sizeof(SampleBall);
}

ToolSamples sample_tool(const scene::Sphere& tool, int count) {
  // Rings of equal area, four points on each, each ring a golden angle (of a quarter turn) further: every point stands
  // for the same area, and a press along the axis has no side force or torque of the sampling's own making.
  // A last ring short of points is the topmost.
  constexpr int on_ring = 4;
  const int rings = (count + on_ring - 1) / on_ring;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  std::vector<Vec3> normals, points_m;
  for (int i = 0; i < count; ++i) {
    const int ring = i / on_ring;
    const double z = -1.0 + (2.0 * ring + 1.0) / rings;
    const double across = std::sqrt(1.0 - z * z);
    const double turn = std::fmod(golden * ring, 1.0);
    const double x = across * std::cos(0.5 * std::numbers::pi * turn),
                 y = across * std::sin(0.5 * std::numbers::pi * turn);
    const std::array<Vec3, on_ring> quarter{Vec3(x, y, z), Vec3(-y, x, z), Vec3(-x, -y, z), Vec3(y, -x, z)};
    normals.push_back(quarter[static_cast<std::size_t>(i % on_ring)]);
    points_m.push_back(tool.center_m() + tool.radius_m() * normals.back());
  }
  TreeBuilder builder(points_m);
  ToolSamples samples;
  for (const std::int32_t i : builder.order()) {
    const Vec3 &p = points_m[static_cast<std::size_t>(i)], &n = normals[static_cast<std::size_t>(i)];
    samples.x_T_m.push_back(p.x());
    samples.y_T_m.push_back(p.y());
    samples.z_T_m.push_back(p.z());
    samples.nx_T.push_back(n.x());
    samples.ny_T.push_back(n.y());
    samples.nz_T.push_back(n.z());
    samples.area_m2.push_back(tool.area_m2() / count);
  }
  samples.spacing_m = std::sqrt(tool.area_m2() / count);
  samples.tree = builder.take();
  return samples;
}

}  // namespace touchstone::fast
