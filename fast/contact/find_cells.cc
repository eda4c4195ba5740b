#include "fast/contact/find_cells.h"

#include "fast/contact/rest_distance.h"
#include "fast/contact/tool_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

/// Cuts a polygon, tool frame about the cell's centre, with the rest surface: with its tangent plane at the closest
/// point, which has all of a convex body on one side.
template <class Body>
void cut(const Body&, const Mat3& R_WT, const PlacedCell& at, CutPolygon& polygon) noexcept {
  polygon.keep_below(R_WT.transpose() * at.rest.normal, at.rest.signed_distance_m);
}

/// Faces that meet at edges.
void cut(const scene::Box& box, const Mat3& R_WT, const PlacedCell& at, CutPolygon& polygon) noexcept {
  const Vec3 local = at.p_W - box.center_m();
  for (int axis = 0; axis < 3; ++axis) {
    const double half_m = box.half_m()[axis];
    // Of the two faces across this axis.
    for (const double side : {1.0, -1.0}) {
      const double above_m = side * local[axis] - half_m;
      if (above_m > -at.cell->radius_m) polygon.keep_below(side * R_WT.row(axis).transpose(), above_m);
    }
  }
}

/// Straight pieces of the profile, of which several may cut a cell, and the tangent plane for an arc.
void cut(const scene::Revolution& body, const Mat3& R_WT, const PlacedCell& at, CutPolygon& polygon) noexcept {
  polygon.keep_below(R_WT.transpose() * at.rest.normal, at.rest.signed_distance_m);
  for (int index = 0; index < body.piece_count(); ++index) {
    const scene::RevolutionPiece& piece = body.piece(index);
    if (!piece.straight()) continue;
    const Eigen::Vector2d along = (piece.end_m - piece.start_m) / piece.length_m;
    const Eigen::Vector2d normal(along.y(), -along.x());
    const auto level_of = [&](const Vec3& p_W) {
      const Vec3 local = p_W - body.offset_m();
      return normal.dot(Eigen::Vector2d(std::sqrt(local.x() * local.x() + local.y() * local.y()), local.z()) -
                        piece.start_m);
    };
    if (level_of(at.p_W) <= -at.cell->radius_m) continue;
    const auto corners = polygon.corners();
    std::array<double, CutPolygon::max_corners> level{};
    bool cuts = false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      level[k] = level_of(at.p_W + R_WT * corners[k]);
      cuts = cuts || level[k] >= 0.0;
    }
    if (cuts) polygon.keep_below({level.data(), corners.size()});
  }
}

/// Mean of the rest surface's normal at the closest points of a piece of surface.
template <class Body>
Vec3 mean_normal(const Body&, const Mat3&, const Vec3&, const RestDistance& rest, const Spread&) noexcept {
  return rest.normal;
}

/// Of pieces that are nearer to one face in one part and to another in the rest.
Vec3 mean_normal(const scene::Box& box, const Mat3& R_WT, const Vec3& p_W, const RestDistance& rest,
                 const Spread& spread_T_m) noexcept {
  const Vec3 local = p_W - box.center_m(), above_m = local.cwiseAbs() - box.half_m();
  const Vec3 under_m = (Vec3::Constant(above_m.maxCoeff()) - above_m).cwiseMax(0.0);
  const double second_m = under_m.sum() - under_m.maxCoeff();
  if (second_m * second_m > 6.0 * (spread_T_m[0].squaredNorm() + spread_T_m[1].squaredNorm())) return rest.normal;
  Mat3 normal = Mat3::Zero();
  for (int axis = 0; axis < 3; ++axis) normal(axis, axis) = std::copysign(1.0, local[axis]);
  const Vec3 e1_m = normal * (R_WT * spread_T_m[0]), e2_m = normal * (R_WT * spread_T_m[1]);
  // Share of the piece that is nearer to face a than to face b.
  const auto nearer = [&](int a, int b) {
    const double half_m = std::numbers::sqrt3 * std::hypot(e1_m[a] - e1_m[b], e2_m[a] - e2_m[b]);
    const double by_m = above_m[a] - above_m[b];
    return half_m > std::abs(by_m) ? 0.5 + 0.5 * by_m / half_m : (by_m > 0.0 ? 1.0 : (by_m < 0.0 ? 0.0 : 0.5));
  };
  const double xy = nearer(0, 1), yz = nearer(1, 2), zx = nearer(2, 0);
  const Vec3 share(xy * (1.0 - zx), yz * (1.0 - xy), zx * (1.0 - yz));
  const double sum = share.sum();
  return sum > 0.0 ? Vec3(normal * share / sum) : rest.normal;
}

/// Cells of the tool, one by one, and what is inside of them.
template <class Body>
class CellFinder {
 public:
  CellFinder(const Body& body, const Placement& at, const CellRule& rule, double margin_m,
             RegionPoints& points) noexcept
      : body_(body), at_(at), rule_(rule), margin_m_(margin_m), points_(points) {}

  /// Forgets what was taken.
  void begin() noexcept {
    points_.count = inside_ = 0;
    points_.spread = true;
    inside_m2_ = rim_m2_ = 0.0;
    summary_ = {};
  }

  /// Nothing if all of the cell is further out than what is looked for.
  [[nodiscard]] std::optional<PlacedCell> place(const SurfaceCell& cell) const noexcept {
    const double reach_m = std::max(cell.radius_m, margin_m_);
    const Vec3 p_W = at_.R_WT * cell.center_T_m + at_.origin_W_m;
    if (surely_beyond(body_, p_W, reach_m)) return std::nullopt;
    const RestDistance rest = rest_distance(body_, p_W);
    if (!(rest.signed_distance_m < reach_m)) return std::nullopt;
    return PlacedCell{&cell, p_W, rest, 0.0};
  }

  /// Whether some of the cell may be inside, so that its halves need a look where this round is too coarse.
  [[nodiscard]] bool is_near(PlacedCell& here) const noexcept {
    if (wholly_inside(here)) return true;
    here.lowest_m = lowest_m(here);
    return here.lowest_m < here.cell->bulge_m || (here.cell->group >= 0 && lowest_of_group_m(here, slope(here)) < 0.0);
  }

  /// Takes what is inside of a cell that is_near() has looked at.
  void add(const PlacedCell& here) noexcept {
    if (wholly_inside(here)) {
      put_inside(here);
    } else if (here.cell->group >= 0) {
      add_group(here);
    } else if (here.lowest_m < 0.0) {
      add_cut(here);
    } else {
      put_outside(here, Vec3::Zero(), here.cell->area_m2);
    }
  }

  [[nodiscard]] bool fine_enough() const noexcept {
    return inside_ >= rule_.points && rim_m2_ <= rule_.rim_share * inside_m2_;
  }
  [[nodiscard]] const InsideSummary& summary() const noexcept { return summary_; }

 private:
  [[nodiscard]] static bool wholly_inside(const PlacedCell& here) noexcept {
    return here.rest.signed_distance_m <= -here.cell->radius_m;
  }

  /// Signed distance of the cell's lowest corner from the tangent plane of the rest surface.
  [[nodiscard]] double lowest_m(const PlacedCell& here) const noexcept {
    const Vec3 normal_T = at_.R_WT.transpose() * here.rest.normal;
    double lowest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < here.cell->corners; ++k)
      lowest = std::min(lowest, normal_T.dot(here.cell->corner_m[static_cast<std::size_t>(k)]));
    return here.rest.signed_distance_m + lowest;
  }

  /// A cell's spread in two vectors, of which one is level and the other shows how the surface rises.
  struct Slope {
    double rise_m;  ///< over the tangent plane of the rest surface, along `up_m`
    Vec3 up_m, level_m;
  };
  [[nodiscard]] Slope slope(const PlacedCell& here) const noexcept {
    const Spread& spread_m = here.cell->spread_m;
    const Vec3 normal_T = at_.R_WT.transpose() * here.rest.normal;
    const double rise1_m = normal_T.dot(spread_m[0]), rise2_m = normal_T.dot(spread_m[1]);
    const double rise_m = std::sqrt(rise1_m * rise1_m + rise2_m * rise2_m);
    if (!(rise_m > 0.0)) return {0.0, spread_m[0], spread_m[1]};
    return {rise_m, (rise1_m * spread_m[0] + rise2_m * spread_m[1]) / rise_m,
            (rise1_m * spread_m[1] - rise2_m * spread_m[0]) / rise_m};
  }

  [[nodiscard]] static double lowest_of_group_m(const PlacedCell& here, const Slope& slope) noexcept {
    return here.rest.signed_distance_m - std::numbers::sqrt3 * slope.rise_m;
  }

  /// The cut of a surface whose shape is not known: that of a rectangle with two level sides, of the same area, middle
  /// and spread.
  void add_group(const PlacedCell& here) noexcept {
    const SurfaceCell& cell = *here.cell;
    const Slope slope = this->slope(here);
    const double half_m = std::numbers::sqrt3 * slope.rise_m, middle_m = here.rest.signed_distance_m;
    const double lowest_m = lowest_of_group_m(here, slope);
    if (lowest_m >= 0.0) return put_outside(here, Vec3::Zero(), cell.area_m2);
    if (middle_m + half_m <= 0.0) return put_inside(here);
    put_rim(here, slope, -lowest_m / (2.0 * half_m), (0.5 * lowest_m - middle_m) / slope.rise_m * slope.up_m);
  }

  void put_inside(const PlacedCell& here) noexcept {
    const SurfaceCell& cell = *here.cell;
    put(here.p_W, cell.center_T_m, cell, cell.area_m2, here.rest, cell.spread_m, &cell);
  }

  /// @param off_m  from the cell's centre to the middle of the share that is inside, tool frame
  void put_rim(const PlacedCell& here, const Slope& slope, double share, const Vec3& off_m) noexcept {
    const SurfaceCell& cell = *here.cell;
    const double area_m2 = share * cell.area_m2;
    const Vec3 p_W = here.p_W + at_.R_WT * off_m;
    RestDistance rest = rest_distance(body_, p_W);
    // A curved surface may pass beneath the middle of the part under its tangent plane.
    rest.signed_distance_m = std::min(rest.signed_distance_m, -std::numeric_limits<double>::min());
    rim_m2_ += area_m2;
    put(p_W, cell.center_T_m + off_m, cell, area_m2, rest, {share * slope.up_m, slope.level_m}, nullptr);
    if (share < 1.0) put_outside(here, -share / (1.0 - share) * off_m, (1.0 - share) * cell.area_m2);
  }

  /// @param whole  the cell, if all of it is the point
  void put(const Vec3& p_W, const Vec3& p_T, const SurfaceCell& cell, double area_m2, const RestDistance& rest,
           const Spread& spread_m, const SurfaceCell* whole) noexcept {
    summary_.add(mean_normal(body_, at_.R_WT, p_W, rest, spread_m), -rest.signed_distance_m, area_m2);
    ++inside_;
    inside_m2_ += area_m2;
    if (points_.count == points_.capacity) return;
    points_.set(points_.count, p_W, p_T, cell.normal_T, area_m2, rest.signed_distance_m, cell.sample);
    points_.set_spread(points_.count++, rest.normal, spread_m, whole);
  }

  void put_outside(const PlacedCell& here, const Vec3& off_m, double area_m2) noexcept {
    if (!(margin_m_ > 0.0) || points_.count == points_.capacity) return;
    const Vec3 p_W = here.p_W + at_.R_WT * off_m;
    const RestDistance rest = rest_distance(body_, p_W);
    if (!(rest.signed_distance_m < margin_m_)) return;
    points_.set(points_.count, p_W, here.cell->center_T_m + off_m, here.cell->normal_T, area_m2,
                std::max(0.0, rest.signed_distance_m), here.cell->sample);
    points_.set_spread(points_.count++, rest.normal, here.cell->spread_m, nullptr);
  }

  void add_cut(const PlacedCell& here) noexcept {
    const SurfaceCell& cell = *here.cell;
    CutPolygon polygon({cell.corner_m.data(), static_cast<std::size_t>(cell.corners)});
    cut(body_, at_.R_WT, here, polygon);
    if (!polygon.is_cut() && here.rest.signed_distance_m < 0.0) return put_inside(here);
    const CutPolygon::Moments part = polygon.moments();
    const double share = cell.polygon_m2 > 0.0 ? std::min(1.0, part.area_m2 / cell.polygon_m2) : 0.0;
    if (!(share > 0.0)) return put_outside(here, Vec3::Zero(), cell.area_m2);
    // The polygon's, moved to the surface that bulges from it.
    put_rim(here, slope(here), share, part.center_m - cell.polygon_center_m);
  }

  const Body& body_;
  const Placement& at_;
  const CellRule& rule_;
  double margin_m_;
  RegionPoints& points_;
  InsideSummary summary_;
  int inside_ = 0;
  double inside_m2_ = 0.0, rim_m2_ = 0.0;
};

}  // namespace

template <class Body>
InsideSummary find_cells(const scene::Shape& shape, const ToolSamples& tool, const Placement& at, const CellRule& rule,
                         double margin_m, RegionPoints& points, CellScratch& scratch) noexcept {
  const Body& body = static_cast<const Body&>(shape);
  // Cells of a round that are inside or near, with those that a finer round would halve.
  std::vector<PlacedCell>& placed = scratch.placed;
  std::vector<std::int32_t>& near = scratch.near;
  placed.clear();
  near.clear();
  CellFinder<Body> found(body, at, rule, margin_m, points);
  const auto look_at = [&](const SurfaceCell& cell, std::int32_t index) {
    std::optional<PlacedCell> here = found.place(cell);
    if (!here) return;
    if (found.is_near(*here)) near.push_back(index);
    placed.push_back(*here);
  };
  const auto nodes = static_cast<std::int32_t>(tool.tree.size());
  for (std::int32_t node = 0; node < nodes;) {
    const SampleBall& ball = tool.tree[static_cast<std::size_t>(node)];
    if (!may_touch(body, at.R_WT * ball.center_T_m + at.origin_W_m,
                   std::max(ball.cells_radius_m, ball.radius_m + margin_m))) {
      node = ball.next;
      continue;
    }
    ++node;
    if (!ball.leaf) continue;
    for (std::int32_t i = ball.begin; i < ball.end; ++i) look_at(tool.cell[static_cast<std::size_t>(i)], i);
  }
  bool of_tool = true, room = 4 * near.size() <= max_cells;
  std::size_t looked_at = 0;
  while (true) {
    // Fewer cells than points are asked for cannot be fine enough.
    if (near.empty() || !room || near.size() >= static_cast<std::size_t>(rule.points)) {
      found.begin();
      for (const PlacedCell& here : placed) found.add(here);
      if (near.empty() || !room || found.fine_enough()) return found.summary();
    }
    if (of_tool) scratch.begin();
    scratch.now.clear();
    for (const std::int32_t k : near) {
      const std::int32_t first = of_tool ? scratch.halves_of_sample(tool, k) : scratch.halves_of_half(tool, k);
      scratch.now.insert(scratch.now.end(), {first, first + 1});
    }
    placed.clear();
    near.clear();
    for (const std::int32_t k : scratch.now) look_at(scratch.half(k), k);
    looked_at += scratch.now.size();
    room = looked_at + 2 * scratch.now.size() <= max_cells;
    of_tool = false;
  }
}

template InsideSummary find_cells<scene::Box>(const scene::Shape&, const ToolSamples&, const Placement&,
                                              const CellRule&, double, RegionPoints&, CellScratch&) noexcept;
template InsideSummary find_cells<scene::Sphere>(const scene::Shape&, const ToolSamples&, const Placement&,
                                                 const CellRule&, double, RegionPoints&, CellScratch&) noexcept;
template InsideSummary find_cells<scene::Ellipsoid>(const scene::Shape&, const ToolSamples&, const Placement&,
                                                    const CellRule&, double, RegionPoints&, CellScratch&) noexcept;
template InsideSummary find_cells<scene::Revolution>(const scene::Shape&, const ToolSamples&, const Placement&,
                                                     const CellRule&, double, RegionPoints&, CellScratch&) noexcept;

CellScratch::CellScratch(int samples)
    : halves_(samples > 0 ? 2 * max_cells : 0),
      of_half_(halves_.size(), -1),
      of_sample_(static_cast<std::size_t>(samples), -1) {
  if (samples == 0) return;
  now.reserve(max_cells);
  near.reserve(static_cast<std::size_t>(std::max(samples, max_cells)));
  placed.reserve(near.capacity());
}

void CellScratch::begin() noexcept {
  if (used_ + max_cells <= halves_.size()) return;
  std::fill(of_sample_.begin(), of_sample_.end(), -1);
  used_ = 0;
}

std::int32_t CellScratch::halves_of(const ToolSamples& tool, const SurfaceCell& cell, std::int32_t& first) noexcept {
  if (first < 0) {
    first = static_cast<std::int32_t>(used_);
    for (const SurfaceCell& half : fast::halves(cell, tool.groups)) {
      of_half_[used_] = -1;
      halves_[used_++] = half;
    }
  }
  return first;
}

std::int32_t CellScratch::halves_of_sample(const ToolSamples& tool, std::int32_t sample) noexcept {
  const auto i = static_cast<std::size_t>(sample);
  return halves_of(tool, tool.cell[i], of_sample_[i]);
}

std::int32_t CellScratch::halves_of_half(const ToolSamples& tool, std::int32_t half) noexcept {
  const auto i = static_cast<std::size_t>(half);
  return halves_of(tool, halves_[i], of_half_[i]);
}

std::size_t CellScratch::memory_bytes() const noexcept {
  return halves_.size() * (sizeof(SurfaceCell) + sizeof(std::int32_t)) +
         (of_sample_.size() + now.capacity() + near.capacity()) * sizeof(std::int32_t) +
         placed.capacity() * sizeof(PlacedCell);
}

}  // namespace touchstone::fast
