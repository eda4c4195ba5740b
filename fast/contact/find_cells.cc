#include "fast/contact/find_cells.h"

#include "fast/contact/body_edges.h"
#include "fast/contact/cell_batch.h"
#include "fast/contact/rest_distance.h"
#include "fast/contact/tool_samples.h"
#include "scene/base/index.h"
#include "scene/shape/solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

/// Cuts a polygon, tool frame about the cell's centre, with the rest surface: with its tangent plane at the closest
/// point, which has all of a convex body on one side.
template <class Body>
void cut(const Body&, const Mat3&, const PlacedCell& at, CutPolygon& polygon) noexcept {
  polygon.keep_below(at.normal_T, at.rest.signed_distance_m);
}
template <class Body>
bool by_one_plane(const Body&, const PlacedCell&) noexcept {
  return true;
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

/// Whether no more than the tangent plane at the closest point can cut the cell: the other faces are further away than
/// the cell is large.
bool by_one_plane(const scene::Box& box, const PlacedCell& at) noexcept {
  int within_reach = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double off_m = std::abs(at.p_W[axis] - box.center_m()[axis]), half_m = box.half_m()[axis];
    within_reach += (off_m - half_m > -at.cell->radius_m) + (-off_m - half_m > -at.cell->radius_m);
  }
  return within_reach <= 1;
}

/// Straight pieces of the profile, of which several may cut a cell, and the tangent plane for an arc.
bool by_one_plane(const scene::Revolution&, const PlacedCell&) noexcept { return false; }
void cut(const scene::Revolution& body, const Mat3& R_WT, const PlacedCell& at, CutPolygon& polygon) noexcept {
  polygon.keep_below(at.normal_T, at.rest.signed_distance_m);
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
    if (cuts) polygon.keep_below({level.data(), corners.size()}, at.normal_T);
  }
}

/// Where a direction's error moves the line through a far mass centre by more than this share of the contact's radius
/// per unit, the sum of normals is taken by steady_direction(): partly from the first on, wholly from the second.
constexpr double lever_from = 1.0, lever_to = 3.0;

/// The direction d is the mean of the rest surface's normals n, and a mean of few normals that differ has an error. The
/// tool's normals n_T say the same about a tool without edges, whose line through the mass centre moves with them: over
/// a surface of mean curvature H that ends where the depth is 0, the divergence theorem for grad(depth^2) gives
///   integral of depth n = integral of (depth n . n_T - depth^2 H) n_T.
void steady_direction(const ToolSamples& tool, const Mat3& R_WT, const RegionPoints& points,
                      InsideSummary& inside) noexcept {
  if (tool.mean_curvature_per_m.empty() || points.count == 0) return;
  const double mean = inside.normal_sum.norm() / inside.weight_sum;
  const double differ = std::sqrt(std::max(0.0, 1.0 - mean * mean)), far_m = points.p_T_m(0).norm();
  const auto count = static_cast<std::size_t>(points.count);
  double area_m2 = 0.0;
  for (std::size_t i = 0; i < count; ++i) area_m2 += points.depth_m[i] > 0.0 ? points.area_m2[i] : 0.0;
  const double lever = differ * far_m / std::sqrt(area_m2 / std::numbers::pi);
  if (!(lever > lever_from)) return;
  Vec3 sum_T = Vec3::Zero();
  for (std::size_t i = 0; i < count; ++i) {
    const double depth_m = points.depth_m[i];
    if (!(depth_m > 0.0)) continue;
    const Vec3 n_T(points.nx_T[i], points.ny_T[i], points.nz_T[i]);
    sum_T += points.area_m2[i] * depth_m *
             (points.rest_normal_W(i).dot(R_WT * n_T) - depth_m * nth(tool.mean_curvature_per_m, points.sample[i])) *
             n_T;
  }
  const double x = std::clamp((lever - lever_from) / (lever_to - lever_from), 0.0, 1.0);
  inside.normal_sum += x * x * (3.0 - 2.0 * x) * (R_WT * sum_T - inside.normal_sum);
}

/// Depth and normals of the rest surface over all pieces: at their middles, or under several faces by mean_depth().
template <class Body>
InsideSummary summarise_pieces(const Body& body, const Mat3& R_WT, const RegionPoints& points) noexcept {
  InsideSummary by_middles, by_parts;
  const auto count = static_cast<std::size_t>(points.count);
  Vec3 normal = Vec3::Zero();
  bool one_face = true;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(points.depth_m[i] > 0.0)) continue;
    const Vec3 here = points.rest_normal_W(i);
    if (!(by_middles.weight_sum > 0.0)) normal = here;
    one_face = one_face && (here - normal).squaredNorm() < 1e-20;
    by_middles.add(here, points.depth_m[i], points.area_m2[i]);
  }
  // The spread takes a piece for a parallelogram, which may be wider than the piece and reach another face.
  if (one_face) return by_middles;
  by_parts.deepest_m = by_middles.deepest_m;
  for (std::size_t i = 0; i < count; ++i) {
    if (!(points.depth_m[i] > 0.0)) continue;
    const RestDistance rest{-points.depth_m[i], points.rest_normal_W(i)};
    const MeanDepth mean = mean_depth(body, R_WT, points.p_W_m(i), rest, points.spread_T_m(i));
    by_parts.normal_sum += points.area_m2[i] * mean.along_normals_m;
    by_parts.weight_sum += points.area_m2[i] * mean.depth_m;
  }
  return by_parts;
}

/// Cells of the tool, a batch at a time, and what is inside of them.
template <class Body>
class CellFinder {
 public:
  CellFinder(const Body& body, const Placement& at, double margin_m, RegionPoints& points,
             CellScratch& scratch) noexcept
      : body_(body), at_(at), margin_m_(margin_m), points_(points), scratch_(scratch), batch_(scratch.batch) {}

  /// Begins with a new round of cells.
  void begin_round() noexcept {
    scratch_.placed.clear();
    scratch_.near.clear();
    asked_ = 0;
    inside_ = 0;
  }
  /// @param index  of the cell, for CellScratch::near
  void look_at(const SurfaceCell& cell, std::int32_t index) noexcept {
    cell_[asked_] = &cell;
    index_[asked_++] = index;
    if (asked_ == CellBatch::size) place();
  }
  /// After the last cell of a round: places what is left. Those within reach are then in CellScratch::placed, and the
  /// indices of those of which some may be inside, so that their halves need a look where this round is too coarse, in
  /// CellScratch::near.
  void end_round() noexcept { place(); }

  /// Cells of the round of which some is inside.
  [[nodiscard]] int inside() const noexcept { return inside_; }

  /// Makes points of what is inside of the cells of the last round.
  void take() noexcept {
    points_.count = 0;
    points_.spread = true;
    const std::vector<PlacedCell>& placed = scratch_.placed;
    for (std::size_t begin = 0; begin < placed.size(); begin += CellBatch::size) {
      const std::size_t end = std::min(placed.size(), begin + CellBatch::size);
      cut_by_planes({placed.data() + begin, end - begin});
      rims_ = 0;
      for (std::size_t k = begin, lane = 0; k < end; ++k) part_[k - begin] = measure(placed[k], cut_[k - begin], lane);
      place_rims();
      // In the order of the cells, so that sums over the points do not change with what else is near, in any bit.
      for (std::size_t k = begin, rim = 0; k < end; ++k) {
        if (part_[k - begin] == Part::all) put_whole(placed[k]);
        if (part_[k - begin] == Part::some) put_rim(rim++);
        if (part_[k - begin] == Part::none) put_outside(placed[k], Vec3::Zero(), placed[k].cell->area_m2);
      }
    }
  }

 private:
  /// Places the cells asked for.
  void place() noexcept {
    const auto keep = [&](std::size_t from, std::size_t to) {
      cell_[to] = cell_[from];
      index_[to] = index_[from];
      batch_.move(from, to);
    };
    if (asked_ == 0) return;
    for (std::size_t i = 0; i < asked_; ++i)
      batch_.set(i, cell_[i]->center_T_m, std::max(cell_[i]->radius_m, margin_m_));
    batch_.count = asked_;
    asked_ = 0;
    batch_.pad();
    place_batch(at_, batch_);
    if constexpr (knows_beyond<Body>) {
      beyond_batch(body_, batch_);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < batch_.count; ++i) {
        if (batch_.beyond[i] > 0.0) continue;
        if (kept != i) keep(i, kept);
        ++kept;
      }
      batch_.count = kept;
      if (kept == 0) return;
      batch_.pad();
    }
    rest_batch(body_, batch_);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < batch_.count; ++i) {
      if (!(batch_.distance_m[i] < batch_.reach_m[i])) continue;
      if (kept != i) {
        keep(i, kept);
        for (CellBatch::Column* column : {&batch_.distance_m, &batch_.nx, &batch_.ny, &batch_.nz})
          (*column)[kept] = (*column)[i];
      }
      const SurfaceCell& cell = *cell_[kept];
      // Nobody asks for the corners of a cell that is wholly inside.
      if (!(batch_.distance_m[kept] <= -cell.radius_m)) batch_.set_corners(kept, cell);
      ++kept;
    }
    batch_.count = kept;
    level_batch(at_.R_WT, batch_);
    for (std::size_t i = 0; i < kept; ++i) {
      const SurfaceCell& cell = *cell_[i];
      const bool may_be_inside = batch_.lowest_m[i] < (cell.group < 0 ? batch_.dip_m[i] : cell.bulge_m);
      // Only the ball around the cell reaches the body.
      if (margin_m_ == 0.0 && cell.group < 0 && batch_.distance_m[i] > -cell.radius_m && !may_be_inside) continue;
      const PlacedCell here{&cell,
                            Vec3(batch_.x_m[i], batch_.y_m[i], batch_.z_m[i]),
                            {batch_.distance_m[i], Vec3(batch_.nx[i], batch_.ny[i], batch_.nz[i])},
                            Vec3(batch_.nx_T[i], batch_.ny_T[i], batch_.nz_T[i]),
                            batch_.lowest_m[i],
                            batch_.highest_m[i]};
      const bool inside = some_inside(here);
      inside_ += inside;
      if (inside || may_be_inside) scratch_.near.push_back(index_[i]);
      scratch_.placed.push_back(here);
    }
  }

  /// Whether measure() finds some of the cell inside.
  [[nodiscard]] static bool some_inside(const PlacedCell& here) noexcept {
    return here.wholly_inside() || (here.cell->group >= 0 ? lowest_of_group_m(here, slope(here)) : here.lowest_m) < 0.0;
  }
  /// A cell's spread in two vectors, of which one is level and the other shows how the surface rises.
  struct Slope {
    double rise_m;    ///< over the tangent plane of the rest surface, along `up_m`
    double up1, up2;  ///< `up_m` is up1 and up2 times the cell's two
    Vec3 up_m, level_m;
  };
  [[nodiscard]] static Slope slope(const PlacedCell& here) noexcept {
    const Spread& spread_m = here.cell->spread_m;
    const double rise1_m = here.normal_T.dot(spread_m[0]), rise2_m = here.normal_T.dot(spread_m[1]);
    const double rise_m = std::sqrt(rise1_m * rise1_m + rise2_m * rise2_m);
    if (!(rise_m > 0.0)) return {0.0, 1.0, 0.0, spread_m[0], spread_m[1]};
    const double up1 = rise1_m / rise_m, up2 = rise2_m / rise_m;
    return {rise_m, up1, up2, up1 * spread_m[0] + up2 * spread_m[1], up1 * spread_m[1] - up2 * spread_m[0]};
  }

  [[nodiscard]] static double lowest_of_group_m(const PlacedCell& here, const Slope& slope) noexcept {
    return here.rest.signed_distance_m - std::numbers::sqrt3 * slope.rise_m;
  }

  /// What of a placed cell is inside.
  enum class Part : std::int8_t { none, some, all };
  /// Where only some is.
  struct Rim {
    const PlacedCell* at;
    double share;  ///< of its area
    Vec3 off_m;    ///< from its centre to the middle of that share, tool frame
  };

  /// The cut of a surface whose shape is not known: that of a rectangle with two level sides, of the same area, middle
  /// and spread.
  [[nodiscard]] Part measure_group(const PlacedCell& here) noexcept {
    const Slope slope = CellFinder::slope(here);
    const double half_m = std::numbers::sqrt3 * slope.rise_m, middle_m = here.rest.signed_distance_m;
    const double lowest_m = lowest_of_group_m(here, slope);
    if (lowest_m >= 0.0) return Part::none;
    if (middle_m + half_m <= 0.0) return Part::all;
    rim_[rims_++] = {&here, -lowest_m / (2.0 * half_m), (0.5 * lowest_m - middle_m) / slope.rise_m * slope.up_m};
    return Part::some;
  }

  /// How a cell is cut.
  enum class Cut : std::int8_t { no, by_plane, by_faces };
  [[nodiscard]] Cut cut_of(const PlacedCell& here) const noexcept {
    if (here.wholly_inside() || here.cell->group >= 0 || !(here.lowest_m < 0.0)) return Cut::no;
    if (!by_one_plane(body_, here)) return Cut::by_faces;
    return here.highest_m < 0.0 && here.rest.signed_distance_m < 0.0 ? Cut::no : Cut::by_plane;
  }

  /// Says of up to a batch of cells how they are cut, and cuts those that one plane cuts.
  void cut_by_planes(std::span<const PlacedCell> placed) noexcept {
    batch_.count = 0;
    for (std::size_t k = 0; k < placed.size(); ++k) {
      const PlacedCell& here = placed[k];
      cut_[k] = cut_of(here);
      if (cut_[k] != Cut::by_plane) continue;
      const std::size_t lane = batch_.count++;
      batch_.set_corners(lane, *here.cell);
      batch_.set_sag(lane, *here.cell);
      batch_.distance_m[lane] = here.rest.signed_distance_m;
      batch_.nx_T[lane] = here.normal_T.x();
      batch_.ny_T[lane] = here.normal_T.y();
      batch_.nz_T[lane] = here.normal_T.z();
    }
    if (batch_.count > 0) cut_batch(batch_);
  }

  /// @param lane  of the batch, for the next cell that a plane cuts
  [[nodiscard]] Part measure(const PlacedCell& here, Cut cut, std::size_t& lane) noexcept {
    if (here.wholly_inside()) return Part::all;
    if (here.cell->group >= 0) return measure_group(here);
    if (!(here.lowest_m < 0.0)) return Part::none;
    if (cut == Cut::no) return Part::all;
    if (cut == Cut::by_faces) return measure_cut(here);
    const Vec3 center_m(batch_.x_m[lane], batch_.y_m[lane], batch_.z_m[lane]);
    return measure_part(here, batch_.area_m2[lane++], center_m);
  }

  [[nodiscard]] Part measure_cut(const PlacedCell& here) noexcept {
    CutPolygon polygon(*here.cell);
    fast::cut(body_, at_.R_WT, here, polygon);
    if (!polygon.is_cut() && here.rest.signed_distance_m < 0.0) return Part::all;
    const CutPolygon::Moments part = polygon.moments();
    return measure_part(here, part.area_m2, part.center_m);
  }

  /// @param area_m2  that is left of the polygon of the cell's corners; @param center_m  its middle
  [[nodiscard]] Part measure_part(const PlacedCell& here, double area_m2, const Vec3& center_m) noexcept {
    const SurfaceCell& cell = *here.cell;
    const double share = cell.polygon_m2 > 0.0 ? std::min(1.0, area_m2 / cell.polygon_m2) : 0.0;
    if (!(share > 0.0)) return Part::none;
    // The polygon's, moved to the surface that bulges from it.
    rim_[rims_++] = {&here, share, center_m - cell.polygon_center_m};
    return Part::some;
  }

  void place_rims() noexcept {
    if (rims_ == 0) return;
    for (std::size_t i = 0; i < rims_; ++i) batch_.set(i, rim_[i].at->p_W + at_.R_WT * rim_[i].off_m, 0.0);
    batch_.count = rims_;
    batch_.pad();
    rest_batch(body_, batch_);
  }

  /// @param lane  of rim_ and of the batch, which has the middle of the part
  void put_rim(std::size_t lane) noexcept {
    const Rim& part = rim_[lane];
    const PlacedCell& here = *part.at;
    const SurfaceCell& cell = *here.cell;
    const Slope slope = CellFinder::slope(here);
    // A curved surface may pass beneath the middle of the part under its tangent plane.
    const double depth_m = std::max(-batch_.distance_m[lane], std::numeric_limits<double>::min());
    const Vec3 area_m2 = part_area_m2(cell, part.share, part.off_m);
    const double projected_m2 = area_m2.norm();
    put({{Vec3(batch_.x_m[lane], batch_.y_m[lane], batch_.z_m[lane]), cell.center_T_m + part.off_m,
          projected_m2 > 0.0 ? Vec3(area_m2 / projected_m2) : cell.normal_T, projected_m2, depth_m, cell.sample},
         Vec3(batch_.nx[lane], batch_.ny[lane], batch_.nz[lane]),
         {part.share * slope.up_m, slope.level_m},
         {part.share * (slope.up1 * cell.turn[0] + slope.up2 * cell.turn[1]),
          slope.up1 * cell.turn[1] - slope.up2 * cell.turn[0]},
         nullptr});
    if (part.share < 1.0)
      put_outside(here, -part.share / (1.0 - part.share) * part.off_m, (1.0 - part.share) * cell.area_m2);
  }

  TOUCHSTONE_INLINE void put(const FoundPiece& piece) noexcept {
    if (points_.count < points_.capacity) points_.set(points_.count++, piece);
  }

  void put_whole(const PlacedCell& here) noexcept {
    const SurfaceCell& cell = *here.cell;
    put({{here.p_W, cell.center_T_m, cell.normal_T, cell.area_m2, -here.rest.signed_distance_m, cell.sample},
         here.rest.normal,
         cell.spread_m,
         cell.turn,
         &cell});
  }

  void put_outside(const PlacedCell& here, const Vec3& off_m, double area_m2) noexcept {
    if (!(margin_m_ > 0.0)) return;
    const SurfaceCell& cell = *here.cell;
    const Vec3 p_W = here.p_W + at_.R_WT * off_m;
    const RestDistance rest = rest_distance(body_, p_W);
    if (!(rest.signed_distance_m < margin_m_)) return;
    const double depth_m = std::min(0.0, -rest.signed_distance_m);
    put({{p_W, cell.center_T_m + off_m, cell.normal_T, area_m2, depth_m, cell.sample},
         rest.normal,
         cell.spread_m,
         cell.turn,
         nullptr});
  }

  const Body& body_;
  const Placement& at_;
  double margin_m_;
  RegionPoints& points_;
  CellScratch& scratch_;
  CellBatch& batch_;
  std::array<const SurfaceCell*, CellBatch::size> cell_;  ///< asked for, not yet placed
  std::array<std::int32_t, CellBatch::size> index_;
  std::size_t asked_ = 0;
  int inside_ = 0;
  std::array<Cut, CellBatch::size> cut_;  ///< of a batch of placed cells
  std::array<Part, CellBatch::size> part_;
  std::array<Rim, CellBatch::size> rim_;
  std::size_t rims_ = 0;
};

/// How often all of `cells` are halved until they are so many.
int halvings_to(int points, std::size_t cells) noexcept {
  int times = 0;
  for (; cells < static_cast<std::size_t>(points); cells *= 2) ++times;
  return times;
}

/// Cells made on the way.
std::size_t made_by(int times, std::size_t cells) noexcept { return cells * ((std::size_t{2} << times) - 2); }

template <class Body>
InsideSummary find_cells(const scene::Shape& shape, const ToolSamples& tool, const Placement& at, const CellRule& rule,
                         double margin_m, RegionPoints& points, CellScratch& scratch) noexcept {
  const Body& body = static_cast<const Body&>(shape);
  CellFinder<Body> found(body, at, margin_m, points, scratch);
  const std::vector<std::int32_t>& near = scratch.near;
  found.begin_round();
  const auto nodes = static_cast<std::int32_t>(tool.tree.size());
  for (std::int32_t node = 0; node < nodes;) {
    const SampleBall& ball = nth(tool.tree, node);
    if (!may_touch(body, at.R_WT * ball.center_T_m + at.origin_W_m,
                   std::max(ball.cells_radius_m, ball.radius_m + margin_m))) {
      node = ball.next;
      continue;
    }
    ++node;
    if (!ball.leaf) continue;
    for (std::int32_t i = ball.begin; i < ball.end; ++i) found.look_at(nth(tool.cell, i), i);
  }
  found.end_round();
  // Halved as often as it takes, in as few rounds as possible, while there is room.
  std::size_t room = static_cast<std::size_t>(rule.room);
  bool of_tool = true;
  int beyond = rule.halvings;
  while (!near.empty()) {
    int times =
        found.inside() < rule.points ? std::max(1, halvings_to(rule.points, near.size())) : std::exchange(beyond, 0);
    while (times > 0 && made_by(times, near.size()) > room) --times;
    if (times == 0) break;
    room -= made_by(times, near.size());
    if (of_tool) scratch.halves.begin();
    scratch.now.assign(near.begin(), near.end());
    for (; times > 0; --times, of_tool = false) scratch.halves.halve(tool, of_tool, scratch.now);
    found.begin_round();
    for (const std::int32_t k : scratch.now) found.look_at(scratch.halves.half(k), k);
    found.end_round();
  }
  found.take();
  InsideSummary inside = summarise_pieces(body, at.R_WT, points);
  steady_direction(tool, at.R_WT, points, inside);
  return inside;
}

}  // namespace

FindCells find_cells_for(const scene::Shape& shape) noexcept {
  return scene::as_solid<FindCells>(shape, []<class Body>() -> FindCells { return &find_cells<Body>; });
}

/// Halves. The track of a shipped scene with one contact region asks for fewer.
constexpr std::size_t least_space = 4096;

CellHalves::CellHalves(int samples, int room)
    : room_(static_cast<std::size_t>(room)),
      halves_(std::max(2 * room_, least_space)),
      of_half_(halves_.size(), -1),
      of_sample_(static_cast<std::size_t>(samples), -1) {}

void CellHalves::begin() noexcept {
  if (used_ + room_ <= halves_.size()) return;
  std::fill(of_sample_.begin(), of_sample_.end(), -1);
  used_ = 0;
}

std::int32_t CellHalves::halves_of(const ToolSamples& tool, const SurfaceCell& cell, std::int32_t& first) noexcept {
  if (first < 0) {
    first = static_cast<std::int32_t>(used_);
    for (const SurfaceCell& half : fast::halves(cell, tool.groups)) {
      of_half_[used_] = -1;
      halves_[used_++] = half;
    }
  }
  return first;
}

std::int32_t CellHalves::halves_of_sample(const ToolSamples& tool, std::int32_t sample) noexcept {
  const auto i = static_cast<std::size_t>(sample);
  return halves_of(tool, tool.cell[i], of_sample_[i]);
}

std::int32_t CellHalves::halves_of_half(const ToolSamples& tool, std::int32_t half) noexcept {
  const auto i = static_cast<std::size_t>(half);
  return halves_of(tool, halves_[i], of_half_[i]);
}

void CellHalves::halve(const ToolSamples& tool, bool of_tool, std::vector<std::int32_t>& cells) noexcept {
  const std::size_t count = cells.size();
  cells.resize(2 * count);
  for (std::size_t i = count; i-- > 0;) {
    const std::int32_t first = of_tool ? halves_of_sample(tool, cells[i]) : halves_of_half(tool, cells[i]);
    cells[2 * i] = first;
    cells[2 * i + 1] = first + 1;
  }
}

std::size_t CellHalves::memory_bytes() const noexcept {
  return halves_.size() * (sizeof(SurfaceCell) + sizeof(std::int32_t)) + of_sample_.size() * sizeof(std::int32_t);
}

CellScratch::CellScratch(CellHalves begin_with) : halves(std::move(begin_with)) {
  now.reserve(halves.room());
  near.reserve(std::max(halves.samples(), halves.room()));
  placed.reserve(near.capacity());
}

std::size_t CellScratch::memory_bytes() const noexcept {
  return halves.memory_bytes() + (now.capacity() + near.capacity()) * sizeof(std::int32_t) +
         placed.capacity() * sizeof(PlacedCell);
}

}  // namespace touchstone::fast
