#include "fast/contact/tool_samples.h"

#include "scene/base/index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Splits the samples at the median of their longest side until a leaf is small enough.
class TreeBuilder {
 public:
  TreeBuilder(const std::vector<Vec3>& points_m, const std::vector<SurfaceCell>& cells)
      : points_m_(points_m), cells_(cells), order_(points_m.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    split(0, static_cast<std::int32_t>(order_.size()));
  }
  [[nodiscard]] const std::vector<std::int32_t>& order() const { return order_; }
  [[nodiscard]] std::vector<SampleBall> take() { return std::move(tree_); }

 private:
  [[nodiscard]] const Vec3& at(std::int32_t i) const { return nth(points_m_, nth(order_, i)); }

  void split(std::int32_t begin, std::int32_t end) {
    Vec3 lower_m = at(begin), upper_m = at(begin);
    for (std::int32_t i = begin; i < end; ++i) {
      lower_m = lower_m.cwiseMin(at(i));
      upper_m = upper_m.cwiseMax(at(i));
    }
    SampleBall ball;
    ball.center_T_m = 0.5 * (lower_m + upper_m);
    for (std::int32_t i = begin; i < end; ++i) {
      ball.radius_m = std::max(ball.radius_m, (at(i) - ball.center_T_m).norm());
      if (cells_.empty()) continue;
      const SurfaceCell& cell = nth(cells_, nth(order_, i));
      ball.cells_radius_m = std::max(ball.cells_radius_m, (cell.center_T_m - ball.center_T_m).norm() + cell.radius_m);
    }
    // Rounding must not prune a sample that lies on the ball.
    ball.radius_m *= 1.0 + 1e-12;
    ball.cells_radius_m *= 1.0 + 1e-12;
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
        const Vec3 &pa = nth(points_m_, a), &pb = nth(points_m_, b);
        return pa[axis] != pb[axis] ? pa[axis] < pb[axis] : a < b;
      });
      split(begin, middle);
      split(middle, end);
    }
    tree_[self].next = static_cast<std::int32_t>(tree_.size());
  }

  const std::vector<Vec3>& points_m_;
  const std::vector<SurfaceCell>& cells_;
  std::vector<std::int32_t> order_;
  std::vector<SampleBall> tree_;
};

/// Samples before they have an order.
struct Cloud {
  std::vector<Vec3> points_m, normals;
  std::vector<double> area_m2;
  std::vector<SurfaceCell> cells;
  std::vector<double> mean_curvature_per_m;  ///< as in ToolSamples
  CellGroups groups;
  void add(const Vec3& point_m, const Vec3& normal, const SurfaceCell& cell) {
    points_m.push_back(point_m);
    normals.push_back(normal);
    area_m2.push_back(cell.curved ? band_area_m2(cell.band) : cell.area_m2);
    cells.push_back(cell);
  }
};

ToolSamples in_tree_order(Cloud&& cloud, double surface_m2) {
  TreeBuilder builder(cloud.points_m, cloud.cells);
  ToolSamples samples;
  for (const std::int32_t i : builder.order()) {
    if (!cloud.cells.empty()) samples.cell.push_back(nth(cloud.cells, i));
    if (!cloud.cells.empty()) samples.cell.back().sample = static_cast<std::int32_t>(samples.cell.size()) - 1;
    if (!cloud.mean_curvature_per_m.empty()) samples.mean_curvature_per_m.push_back(nth(cloud.mean_curvature_per_m, i));
    const Vec3 &p = nth(cloud.points_m, i), &n = nth(cloud.normals, i);
    samples.x_T_m.push_back(p.x());
    samples.y_T_m.push_back(p.y());
    samples.z_T_m.push_back(p.z());
    samples.nx_T.push_back(n.x());
    samples.ny_T.push_back(n.y());
    samples.nz_T.push_back(n.z());
    samples.area_m2.push_back(nth(cloud.area_m2, i));
  }
  samples.spacing_m = std::sqrt(surface_m2 / samples.count());
  samples.tree = builder.take();
  samples.groups = std::move(cloud.groups);
  return samples;
}

int pieces(double length_m, double spacing_m, int least) {
  return std::max(least, static_cast<int>(std::lround(length_m / spacing_m)));
}

/// Samples of equal area on a ball-shaped tool.
ToolSamples sample_sphere(const scene::Sphere& tool, int count) {
  // Rings of equal area, four points on each, each ring a golden angle (of a quarter turn) further: every point stands
  // for the same area, and a press along the axis has no side force or torque of the sampling's own making.
  // A last ring short of points is the topmost.
  constexpr int on_ring = 4;
  const int rings = (count + on_ring - 1) / on_ring;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  Cloud cloud;
  for (int i = 0; i < count; ++i) {
    const int ring = i / on_ring;
    const double z = -1.0 + (2.0 * ring + 1.0) / rings;
    const double across = std::sqrt(1.0 - z * z);
    const double turn = std::fmod(golden * ring, 1.0);
    const double x = across * std::cos(0.5 * std::numbers::pi * turn),
                 y = across * std::sin(0.5 * std::numbers::pi * turn);
    const std::array<Vec3, on_ring> quarter{Vec3(x, y, z), Vec3(-y, x, z), Vec3(-x, -y, z), Vec3(y, -x, z)};
    const Vec3& normal = nth(quarter, i % on_ring);
    cloud.points_m.push_back(tool.center_m() + tool.radius_m() * normal);
    cloud.normals.push_back(normal);
    cloud.area_m2.push_back(tool.area_m2() / count);
  }
  return in_tree_order(std::move(cloud), tool.area_m2());
}

/// The sphere as two arcs turned about z.
scene::Revolution as_revolution(const scene::Sphere& sphere) {
  const double R = sphere.radius_m();
  return scene::Revolution({{{0.0, -R}, {R, 0.0}, {0.0, R}}, {R, R}}, sphere.center_m());
}

ToolSamples sample_box(const scene::Box& box, int count) {
  const double spacing_m = std::sqrt(box.area_m2() / count);
  Cloud cloud;
  for (int face = 0; face < box.patch_count(); ++face) {
    const Vec3 corner = box.at(face, 0.0, 0.0).point_m;
    const double width_m = (box.at(face, 1.0, 0.0).point_m - corner).norm(),
                 height_m = (box.at(face, 0.0, 1.0).point_m - corner).norm();
    const int columns = pieces(width_m, spacing_m, 1), rows = pieces(height_m, spacing_m, 1);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const scene::SurfacePoint at = box.at(face, (column + 0.5) / columns, (row + 0.5) / rows);
        const auto corner_at = [&](int right, int up) {
          return box.at(face, static_cast<double>(column + right) / columns, static_cast<double>(row + up) / rows)
              .point_m;
        };
        const std::array corners{corner_at(0, 0), corner_at(1, 0), corner_at(1, 1), corner_at(0, 1)};
        cloud.add(at.point_m, at.normal, flat_cell(corners));
      }
    }
  }
  return in_tree_order(std::move(cloud), box.area_m2());
}

ToolSamples sample_revolution(const scene::Revolution& tool, int count) {
  constexpr double pi = std::numbers::pi;
  const double spacing_m = std::sqrt(tool.area_m2() / count);
  struct Ring {
    Eigen::Vector2d rz_m, normal;
    Band band;  ///< but for its azimuths
  };
  std::vector<Ring> rings;
  for (int index = 0; index < tool.piece_count(); ++index) {
    const scene::RevolutionPiece& piece = tool.piece(index);
    const int bands = pieces(piece.length_m, spacing_m, 2);
    for (int band = 0; band < bands; ++band) {
      const double from = static_cast<double>(band) / bands, to = static_cast<double>(band + 1) / bands;
      const auto middle = tool.meridian(index, 0.5 * (from + to));
      const auto start = tool.meridian(index, from), end = tool.meridian(index, to);
      Band part;
      part.axis_T_m = tool.offset_m();
      part.start_m = start.rz_m;
      part.end_m = end.rz_m;
      part.start_normal = start.normal;
      part.end_normal = end.normal;
      part.arc_center_m = piece.center_m;
      part.arc_radius_m = piece.radius_m;
      part.arc_angle = (piece.end_angle - piece.start_angle) / bands;
      rings.push_back({middle.rz_m, middle.normal, part});
    }
  }
  Cloud cloud;
  const auto total = static_cast<int>(rings.size());
  for (int i = 0; i < total; ++i) {
    const Ring& ring = nth(rings, i);
    const int on_quarter = pieces(0.5 * pi * ring.rz_m.x(), spacing_m, 1);
    // Neighbouring rings stand on gaps; counted from either end, so that a mirrored profile has mirrored rings.
    const double shift = std::min(i, total - 1 - i) % 2 == 0 ? 0.5 : 0.0;
    for (int k = 0; k < on_quarter; ++k) {
      const auto azimuth = [&](double halves) {
        const double angle = 0.5 * pi * (k + shift + 0.5 * halves) / on_quarter;
        return Eigen::Vector2d(std::cos(angle), std::sin(angle));
      };
      const auto quarter_turn = [](Eigen::Vector2d& v) { v = Eigen::Vector2d(-v.y(), v.x()); };
      Eigen::Vector2d here = azimuth(0);
      Band band = ring.band;
      band.start_azimuth = azimuth(-1);
      band.end_azimuth = azimuth(1);
      band.turn = 0.5 * pi / on_quarter;
      for (int quarter = 0; quarter < 4; ++quarter) {
        cloud.add(tool.offset_m() + Vec3(ring.rz_m.x() * here.x(), ring.rz_m.x() * here.y(), ring.rz_m.y()),
                  Vec3(ring.normal.x() * here.x(), ring.normal.x() * here.y(), ring.normal.y()), band_cell(band));
        for (Eigen::Vector2d* v : {&here, &band.start_azimuth, &band.end_azimuth}) quarter_turn(*v);
      }
    }
  }
  return in_tree_order(std::move(cloud), tool.area_m2());
}

/// Facets that meet at a wider angle are an edge of the tool, not a curved surface [rad].
constexpr double widest_facet_angle = 0.5;

/// Mean curvature of each triangle of a convex mesh, the turn at its sides spread over it; empty if the mesh has edges.
std::vector<double> mean_curvatures_per_m(const scene::TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  struct Side {
    std::int32_t from, to;
    std::size_t triangle;
  };
  std::vector<Side> sides;
  std::vector<SurfaceCell> flat;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& corner = mesh.triangles[i];
    flat.push_back(flat_cell(
        std::array<Vec3, 3>{mesh.points_m.col(corner[0]), mesh.points_m.col(corner[1]), mesh.points_m.col(corner[2])}));
    for (std::size_t k = 0; k < 3; ++k)
      sides.push_back({std::min(corner[k], corner[(k + 1) % 3]), std::max(corner[k], corner[(k + 1) % 3]), i});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.from, a.to, a.triangle) < std::tie(b.from, b.to, b.triangle);
  });
  std::vector<double> curvature_per_m(count, 0.0);
  // The mesh is closed: each side has two triangles.
  for (std::size_t k = 0; k + 1 < sides.size(); k += 2) {
    const Side &one = sides[k], &other = sides[k + 1];
    const Vec3 &n1 = flat[one.triangle].normal_T, &n2 = flat[other.triangle].normal_T;
    const double angle = std::atan2(n1.cross(n2).norm(), n1.dot(n2));
    if (angle > widest_facet_angle) return {};
    const double length_m = (mesh.points_m.col(one.from) - mesh.points_m.col(one.to)).norm();
    for (const std::size_t triangle : {one.triangle, other.triangle}) {
      if (flat[triangle].area_m2 > 0.0) curvature_per_m[triangle] += 0.25 * angle * length_m / flat[triangle].area_m2;
    }
  }
  return curvature_per_m;
}

/// @param halvings_left  an end whatever the numbers are; a tool's largest triangle needs 20 for the most samples
void halve_until(double limit_m2, const SurfaceCell& triangle, Cloud& cloud, int halvings_left = 24) {
  if (!(triangle.area_m2 > limit_m2) || halvings_left == 0) {
    cloud.add(triangle.center_T_m, triangle.normal_T, triangle);
    return;
  }
  for (const SurfaceCell& half : halves(triangle, cloud.groups)) halve_until(limit_m2, half, cloud, halvings_left - 1);
}

/// One sample for each group of neighbours that look the same way.
class Grouping {
 public:
  /// @param even  groups of nearly `area_m2`, so that their number is foreseen; otherwise of that at most, half of it
  /// for many
  Grouping(const Cloud& fine, double area_m2, bool even) : fine_(fine), limit_m2_(area_m2), even_(even) {
    // By the axis they look along first: the two sides of a thin sheet never share a sample.
    std::array<std::vector<std::size_t>, 6> looking;
    for (const SurfaceCell& cell : fine.cells)
      coarse_.groups.triangles_T_m.push_back(
          {cell.center_T_m + cell.corner_m[0], cell.center_T_m + cell.corner_m[1], cell.center_T_m + cell.corner_m[2]});
    for (std::size_t i = 0; i < fine.points_m.size(); ++i) {
      std::size_t axis = 0;
      fine.normals[i].cwiseAbs().maxCoeff(&axis);
      looking[2 * axis + (fine.normals[i][static_cast<Eigen::Index>(axis)] > 0.0)].push_back(i);
    }
    for (std::vector<std::size_t>& group : looking) {
      order_ = std::move(group);
      if (!order_.empty()) split(0, order_.size());
    }
  }
  [[nodiscard]] Cloud take() { return std::move(coarse_); }

 private:
  void split(std::size_t begin, std::size_t end) {
    Vec3 lower_m = fine_.points_m[order_[begin]], upper_m = lower_m;
    Vec3 normal_sum = Vec3::Zero(), center_sum = Vec3::Zero();
    double area_m2 = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const Vec3& p_m = fine_.points_m[order_[k]];
      const double a = fine_.area_m2[order_[k]];
      lower_m = lower_m.cwiseMin(p_m);
      upper_m = upper_m.cwiseMax(p_m);
      normal_sum += a * fine_.normals[order_[k]];
      center_sum += a * p_m;
      area_m2 += a;
    }
    // Within about 25 degrees of their mean.
    const bool same_way = normal_sum.norm() >= 0.9 * area_m2;
    const double reach_m = (upper_m - lower_m).norm();
    const int parts = parts_of(area_m2);
    const bool compact = reach_m * reach_m <= 3.0 * std::max(area_m2, limit_m2_);
    if (end - begin == 1 || (same_way && parts == 1 && compact)) {
      std::size_t nearest = order_[begin];
      for (std::size_t k = begin; k < end; ++k) {
        const auto off = [&](std::size_t i) { return (fine_.points_m[i] - center_sum / area_m2).squaredNorm(); };
        if (off(order_[k]) < off(nearest)) nearest = order_[k];
      }
      coarse_.add(fine_.points_m[nearest], normal_sum.normalized(), coarse_.groups.cell(tree_of(begin, end)));
      coarse_.area_m2.back() = area_m2;
      if (fine_.mean_curvature_per_m.empty()) return;
      double sum_m = 0.0;
      for (std::size_t k = begin; k < end; ++k)
        sum_m += fine_.area_m2[order_[k]] * fine_.mean_curvature_per_m[order_[k]];
      coarse_.mean_curvature_per_m.push_back(sum_m / area_m2);
      return;
    }
    const auto first = order_.begin();
    auto middle = begin;
    int axis = 0;
    (upper_m - lower_m).maxCoeff(&axis);
    std::sort(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end),
              [&](std::size_t a, std::size_t b) {
                const double at_a = fine_.points_m[a][axis], at_b = fine_.points_m[b][axis];
                return at_a != at_b ? at_a < at_b : a < b;
              });
    const auto lower_parts = parts / 2;
    const double share = parts == 1 ? 0.5 : static_cast<double>(lower_parts) / parts;
    double half_m2 = 0.0;
    while (middle < end && half_m2 < share * area_m2) half_m2 += fine_.area_m2[order_[middle++]];
    middle = std::clamp(middle, begin + 1, end - 1);
    split(begin, middle);
    split(middle, end);
  }

  /// Puts the triangles order_[begin, end) into the tree of groups, halved at the median of their longest side.
  std::int32_t tree_of(std::size_t begin, std::size_t end) {
    if (end - begin == 1) return ~static_cast<std::int32_t>(order_[begin]);
    std::vector<std::int32_t> members;
    Vec3 lower_m = fine_.points_m[order_[begin]], upper_m = lower_m;
    for (std::size_t k = begin; k < end; ++k) {
      members.push_back(static_cast<std::int32_t>(order_[k]));
      lower_m = lower_m.cwiseMin(fine_.points_m[order_[k]]);
      upper_m = upper_m.cwiseMax(fine_.points_m[order_[k]]);
    }
    const auto self = static_cast<std::int32_t>(coarse_.groups.nodes.size());
    coarse_.groups.nodes.push_back({coarse_.groups.around(members), {}});
    coarse_.groups.nodes.back().cell.group = self;
    int axis = 0;
    (upper_m - lower_m).maxCoeff(&axis);
    const std::size_t middle = (begin + end) / 2;
    const auto first = order_.begin();
    std::nth_element(first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(middle),
                     first + static_cast<std::ptrdiff_t>(end), [&](std::size_t a, std::size_t b) {
                       const double at_a = fine_.points_m[a][axis], at_b = fine_.points_m[b][axis];
                       return at_a != at_b ? at_a < at_b : a < b;
                     });
    const std::int32_t left = tree_of(begin, middle), right = tree_of(middle, end);
    nth(coarse_.groups.nodes, self).child = {left, right};
    return self;
  }

  /// How many groups an area should become; 2 stands for more where they need not be even.
  [[nodiscard]] int parts_of(double area_m2) const {
    if (!even_) return area_m2 <= limit_m2_ ? 1 : 2;
    return std::max(1, static_cast<int>(std::lround(area_m2 / limit_m2_)));
  }

  const Cloud& fine_;
  double limit_m2_;
  bool even_;
  std::vector<std::size_t> order_;
  Cloud coarse_;
};

/// @param even  no more samples of a convex mesh than of the shape it may stand for: put together from smaller parts
ToolSamples sample_mesh(const scene::TriangleMesh& mesh, int count, bool even) {
  const double surface_m2 = mesh.area_m2(), limit_m2 = surface_m2 / count;
  constexpr double parts_per_sample = 8.0;
  Cloud cloud;
  const std::vector<double> curvature_per_m = mesh.convex ? mean_curvatures_per_m(mesh) : std::vector<double>();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& triangle = mesh.triangles[i];
    halve_until(even && mesh.convex ? limit_m2 / parts_per_sample : limit_m2,
                flat_cell(std::array<Vec3, 3>{mesh.points_m.col(triangle[0]), mesh.points_m.col(triangle[1]),
                                              mesh.points_m.col(triangle[2])}),
                cloud);
    if (!curvature_per_m.empty()) cloud.mean_curvature_per_m.resize(cloud.points_m.size(), curvature_per_m[i]);
  }
  if (cloud.points_m.size() > 2 * static_cast<std::size_t>(count))
    cloud = Grouping(cloud, limit_m2, mesh.convex).take();
  return in_tree_order(std::move(cloud), surface_m2);
}

}  // namespace

std::size_t ToolSamples::memory_bytes() const noexcept {
  return (7 * x_T_m.size() + mean_curvature_per_m.size()) * sizeof(double) + cell.size() * sizeof(SurfaceCell) +
         tree.size() * sizeof(SampleBall) + groups.memory_bytes();
}

namespace {

ToolSamples with_curvature(ToolSamples samples) {
  for (const SurfaceCell& cell : samples.cell) {
    const Band& band = cell.band;
    samples.mean_curvature_per_m.push_back(band.arc_radius_m > 0.0 ? 1.0 / band.arc_radius_m : 0.5 / band.start_m.x());
  }
  return samples;
}

}  // namespace

ToolSamples cell_tool(const scene::Tool& tool, int count) {
  if (tool.shape == scene::ToolShape::mesh) return sample_mesh(scene::tool_mesh(tool), count, false);
  const auto shape = scene::tool_shape(tool);
  switch (tool.shape) {
    case scene::ToolShape::sphere:
      return with_curvature(sample_revolution(as_revolution(static_cast<const scene::Sphere&>(*shape)), count));
    case scene::ToolShape::capsule:
      return with_curvature(sample_revolution(static_cast<const scene::Revolution&>(*shape), count));
    case scene::ToolShape::box:
      return sample_box(static_cast<const scene::Box&>(*shape), count);
    default:
      return sample_revolution(static_cast<const scene::Revolution&>(*shape), count);
  }
}

ToolSamples sample_tool(const scene::Tool& tool, int count) {
  if (tool.shape == scene::ToolShape::sphere)
    return sample_sphere(static_cast<const scene::Sphere&>(*scene::tool_shape(tool)), count);
  ToolSamples samples =
      tool.shape == scene::ToolShape::mesh ? sample_mesh(scene::tool_mesh(tool), count, true) : cell_tool(tool, count);
  samples.cell = {};
  samples.groups = {};
  samples.mean_curvature_per_m = {};
  return samples;
}

}  // namespace touchstone::fast
