#include "fast/contact/contact_regions.h"

#include "scene/base/index.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Keeps the choices made from boxes on the safe side of the rounding of a distance between points.
constexpr double rounding = 1e-9;

using Box = ClusterGrid::SampleBox;

double nearest2_m2(const Vec3& lower_a, const Vec3& upper_a, const Vec3& lower_b, const Vec3& upper_b) noexcept {
  return (lower_b - upper_a).cwiseMax(lower_a - upper_b).cwiseMax(0.0).squaredNorm();
}

double farthest2_m2(const Box& a, const Box& b) noexcept {
  return (a.upper_m.cwiseMax(b.upper_m) - a.lower_m.cwiseMin(b.lower_m)).squaredNorm();
}

constexpr std::int32_t nobodys = -1;    ///< a cluster without samples of a region of the last tick
constexpr std::int32_t left_over = -2;  ///< a cluster with such samples, not taken yet

}  // namespace

std::size_t ClusterGrid::memory_bytes() const noexcept {
  return sample_T_m.size() * sizeof(Vec3) + (cell.size() + neighbour_begin.size()) * sizeof(std::int32_t) +
         neighbours.size() * sizeof(Neighbour) + box.size() * sizeof(SampleBox);
}

ClusterGrid cluster_grid(const ToolSamples& tool, double r_th_m) {
  const auto samples = static_cast<std::size_t>(tool.count());
  const auto point = [&](std::size_t i) { return Vec3(tool.x_T_m[i], tool.y_T_m[i], tool.z_T_m[i]); };
  Box all;
  for (std::size_t i = 0; i < samples; ++i) all.add(point(i));
  // The diagonal of a cell is r_th. A million cells along an edge are enough for any r_th.
  const double edge_m =
      std::max((1.0 - rounding) * r_th_m / std::sqrt(3.0), 1e-6 * (all.upper_m - all.lower_m).maxCoeff());

  using Place = std::array<std::int64_t, 3>;
  std::map<Place, std::vector<std::int32_t>> samples_at;
  for (std::size_t i = 0; i < samples; ++i) {
    const Vec3 place = (point(i) - all.lower_m) / edge_m;
    samples_at[{static_cast<std::int64_t>(place.x()), static_cast<std::int64_t>(place.y()),
                static_cast<std::int64_t>(place.z())}]
        .push_back(static_cast<std::int32_t>(i));
  }

  ClusterGrid grid;
  grid.r_th_m = r_th_m;
  for (std::size_t i = 0; i < samples; ++i) grid.sample_T_m.push_back(point(i));
  grid.cell.resize(samples);
  std::vector<Box>& boxes = grid.box;
  std::map<Place, std::pair<std::int32_t, std::int32_t>> cells_at;
  const double r2_m2 = r_th_m * r_th_m;
  for (const auto& [place, members] : samples_at) {
    Box box;
    for (const std::int32_t i : members) box.add(point(static_cast<std::size_t>(i)));
    const auto first = static_cast<std::int32_t>(boxes.size());
    const bool whole = farthest2_m2(box, box) < (1.0 - rounding) * r2_m2;
    for (const std::int32_t i : members) {
      if (!whole || boxes.size() == static_cast<std::size_t>(first)) boxes.emplace_back();
      nth(grid.cell, i) = static_cast<std::int32_t>(boxes.size()) - 1;
      boxes.back().add(point(static_cast<std::size_t>(i)));
    }
    cells_at[place] = {first, static_cast<std::int32_t>(boxes.size())};
  }

  for (const auto& [place, cells] : cells_at) {
    for (std::int32_t a = cells.first; a < cells.second; ++a) {
      grid.neighbour_begin.push_back(static_cast<std::int32_t>(grid.neighbours.size()));
      for (int k = 0; k < 125; ++k) {
        const auto there = cells_at.find({place[0] + k % 5 - 2, place[1] + k / 5 % 5 - 2, place[2] + k / 25 - 2});
        if (there == cells_at.end()) continue;
        for (std::int32_t b = std::max(there->second.first, a + 1); b < there->second.second; ++b) {
          const Box &box_a = nth(boxes, a), &box_b = nth(boxes, b);
          if (nearest2_m2(box_a.lower_m, box_a.upper_m, box_b.lower_m, box_b.upper_m) >= (1.0 + rounding) * r2_m2)
            continue;
          grid.neighbours.push_back({b, farthest2_m2(box_a, box_b) < (1.0 - rounding) * r2_m2});
        }
      }
    }
  }
  grid.neighbour_begin.push_back(static_cast<std::int32_t>(grid.neighbours.size()));
  return grid;
}

ClusterScratch::ClusterScratch(const ClusterGrid& grid, int points)
    : cells_(static_cast<std::size_t>(grid.cell_count())),
      occupied_(cells_.size()),
      next_(static_cast<std::size_t>(points)),
      of_point_(next_.size()),
      order_(next_.size()),
      rank_(next_.size()),
      begin_(next_.size() + 1),
      area_m2_(next_.size()),
      column_(next_.size()) {}

std::size_t ClusterScratch::memory_bytes() const noexcept {
  return cells_.size() * (sizeof(Cell) + sizeof(std::int32_t)) +
         next_.size() * (5 * sizeof(std::int32_t) + 2 * sizeof(double));
}

std::int32_t ClusterScratch::root(std::int32_t cell) noexcept {
  for (;;) {
    Cell& here = nth(cells_, cell);
    if (here.parent == cell) return cell;
    here.parent = nth(cells_, here.parent).parent;
    cell = here.parent;
  }
}

void ClusterScratch::join(std::int32_t a, std::int32_t b) noexcept {
  const std::int32_t root_a = root(a), root_b = root(b);
  nth(cells_, std::max(root_a, root_b)).parent = std::min(root_a, root_b);
}

bool ClusterScratch::near(const ClusterGrid& grid, const RegionPoints& points, std::int32_t a,
                          std::int32_t b) const noexcept {
  const double r2_m2 = grid.r_th_m * grid.r_th_m, loose2_m2 = (1.0 + rounding) * r2_m2;
  const Box& box = nth(grid.box, b);
  const auto place = [&](std::int32_t i) -> const Vec3& { return nth(grid.sample_T_m, nth(points.sample, i)); };
  for (std::int32_t i = nth(cells_, a).first; i >= 0; i = nth(next_, i)) {
    const Vec3& p_m = place(i);
    if (nearest2_m2(p_m, p_m, box.lower_m, box.upper_m) > loose2_m2) continue;
    for (std::int32_t k = nth(cells_, b).first; k >= 0; k = nth(next_, k))
      if ((place(k) - p_m).squaredNorm() < r2_m2) return true;
  }
  return false;
}

ClusterCount cluster(const ClusterGrid& grid, RegionPoints& all, ClusterScratch& scratch,
                     std::span<Cluster> out) noexcept {
  const auto points = static_cast<std::size_t>(all.count);
  auto& cells = scratch.cells_;
  std::size_t occupied = 0;
  for (std::size_t i = 0; i < points; ++i) {
    const std::int32_t number = nth(grid.cell, all.sample[i]);
    ClusterScratch::Cell& cell = nth(cells, number);
    if (cell.first < 0) {
      cell = {number, -1, -1};
      scratch.occupied_[occupied++] = number;
    }
    scratch.next_[i] = cell.first;
    cell.first = static_cast<std::int32_t>(i);
  }

  // The certain pairs first: they leave few of the others to look at.
  for (const bool certain : {true, false}) {
    for (std::size_t o = 0; o < occupied; ++o) {
      const std::int32_t a = scratch.occupied_[o];
      const auto begin = static_cast<std::size_t>(nth(grid.neighbour_begin, a)),
                 end = static_cast<std::size_t>(nth(grid.neighbour_begin, a + 1));
      for (std::size_t n = begin; n < end; ++n) {
        const ClusterGrid::Neighbour& neighbour = grid.neighbours[n];
        const ClusterScratch::Cell& b = nth(cells, neighbour.cell);
        if (neighbour.certain != certain || b.first < 0) continue;
        if (certain ||
            (scratch.root(a) != scratch.root(neighbour.cell) && scratch.near(grid, all, a, neighbour.cell))) {
          scratch.join(a, neighbour.cell);
        }
      }
    }
  }

  // Cells stand in the order of their first points.
  std::size_t clusters = 0;
  for (std::size_t o = 0; o < occupied; ++o) {
    const std::int32_t cell = scratch.occupied_[o];
    std::int32_t& number = nth(cells, scratch.root(cell)).cluster;
    if (number < 0) {
      number = static_cast<std::int32_t>(clusters);
      scratch.area_m2_[clusters++] = 0.0;
    }
    nth(cells, cell).cluster = number;
  }
  for (std::size_t i = 0; i < points; ++i) {
    const auto cell = static_cast<std::size_t>(nth(grid.cell, all.sample[i]));
    const std::int32_t number = cells[cell].cluster;
    scratch.of_point_[i] = number;
    nth(scratch.area_m2_, number) += all.area_m2[i];
  }
  for (std::size_t o = 0; o < occupied; ++o) nth(cells, scratch.occupied_[o]).first = -1;

  // rank_: a cluster's place among those kept, -1 for one that is not.
  const std::size_t kept = std::min(clusters, out.size());
  const auto order = scratch.order_.begin();
  std::iota(order, order + static_cast<std::ptrdiff_t>(clusters), 0);
  if (kept < clusters) {
    std::nth_element(order, order + static_cast<std::ptrdiff_t>(kept), order + static_cast<std::ptrdiff_t>(clusters),
                     [&](std::int32_t a, std::int32_t b) {
                       const double area_a = nth(scratch.area_m2_, a), area_b = nth(scratch.area_m2_, b);
                       return area_a != area_b ? area_a > area_b : a < b;
                     });
    std::sort(order, order + static_cast<std::ptrdiff_t>(kept));
  }
  std::fill_n(scratch.rank_.begin(), clusters, -1);
  for (std::size_t k = 0; k < kept; ++k) {
    nth(scratch.rank_, scratch.order_[k]) = static_cast<std::int32_t>(k);
    out[k] = Cluster{};
    out[k].deepest_m = -std::numeric_limits<double>::infinity();
  }

  for (std::size_t i = 0; i < points; ++i) {
    std::int32_t& rank = scratch.of_point_[i];
    rank = nth(scratch.rank_, rank);
    if (rank >= 0) ++nth(out, rank).points.size;
  }
  int begin = 0;
  for (std::size_t k = 0; k < kept; ++k) {
    out[k].points.begin = begin;
    scratch.begin_[k] = begin;
    begin += out[k].points.size;
  }
  for (std::size_t i = 0; i < points; ++i) {
    const std::int32_t rank = scratch.of_point_[i];
    if (rank < 0) continue;
    auto& place = nth(scratch.begin_, rank);
    nth(scratch.order_, place++) = static_cast<std::int32_t>(i);
  }
  const std::span<const std::int32_t> by_cluster(scratch.order_.data(), static_cast<std::size_t>(begin));
  if (by_cluster.size() < points || !std::is_sorted(by_cluster.begin(), by_cluster.end()))
    all.reorder(by_cluster, scratch.column_.data());

  for (std::size_t k = 0; k < kept; ++k) {
    Cluster& here = out[k];
    Vec3 plain_sum = Vec3::Zero();
    const auto first = static_cast<std::size_t>(here.points.begin), size = static_cast<std::size_t>(here.points.size);
    for (std::size_t i = first; i < first + size; ++i) {
      here.area_m2 += all.area_m2[i];
      here.center_W_m += all.area_m2[i] * all.p_W_m(i);
      plain_sum += all.p_W_m(i);
      here.deepest_m = std::max(here.deepest_m, all.depth_m[i]);
    }
    here.center_W_m = here.area_m2 > 0.0 ? Vec3(here.center_W_m / here.area_m2) : Vec3(plain_sum / here.points.size);
  }
  return {static_cast<int>(kept), static_cast<int>(clusters - kept)};
}

RegionTracker::RegionTracker(int samples, int max_clusters, int max_regions)
    : label_(static_cast<std::size_t>(samples), -1),
      labelled_(static_cast<std::size_t>(samples)),
      centers_W_m_(static_cast<std::size_t>(max_regions), Vec3::Zero()),
      votes_m2_(static_cast<std::size_t>(max_clusters) * static_cast<std::size_t>(max_regions)),
      of_region_(static_cast<std::size_t>(max_regions)),
      of_cluster_(static_cast<std::size_t>(max_clusters)) {}

std::size_t RegionTracker::memory_bytes() const noexcept {
  return label_.size() * (sizeof(std::int16_t) + sizeof(std::int32_t)) + votes_m2_.size() * sizeof(double) +
         centers_W_m_.size() * (sizeof(Vec3) + sizeof(std::int32_t)) + of_cluster_.size() * sizeof(std::int32_t);
}

void RegionTracker::forget() noexcept {
  for (std::size_t k = 0; k < labelled_count_; ++k) nth(label_, labelled_[k]) = -1;
  labelled_count_ = 0;
  count_ = 0;
}

Tracking RegionTracker::track(const RegionPoints& points, std::span<const Cluster> clusters, double reach_m,
                              std::span<TrackedRegion> out) noexcept {
  const auto regions = static_cast<std::size_t>(count_);
  const std::size_t capacity = std::min(centers_W_m_.size(), out.size());
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    of_cluster_[c] = nobodys;
    for (std::size_t r = 0; r < regions; ++r) votes(c, r) = 0.0;
    const PointRange& range = clusters[c].points;
    for (int i = range.begin; i < range.begin + range.size; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const std::int16_t label = nth(label_, points.sample[k]);
      if (label < 0) continue;
      // A sample without area still is one.
      votes(c, static_cast<std::size_t>(label)) += points.area_m2[k] + std::numeric_limits<double>::min();
      of_cluster_[c] = left_over;
    }
  }

  for (std::size_t r = 0; r < regions; ++r) {
    std::int32_t best = -1;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      if (of_cluster_[c] != left_over || !(votes(c, r) > 0.0)) continue;
      if (best < 0 || votes(c, r) > votes(static_cast<std::size_t>(best), r)) best = static_cast<std::int32_t>(c);
    }
    of_region_[r] = best;
    if (best >= 0) nth(of_cluster_, best) = static_cast<std::int32_t>(r);
  }
  for (std::size_t r = 0; r < regions; ++r) {
    if (of_region_[r] >= 0) continue;
    bool overlaps = false;
    for (std::size_t c = 0; c < clusters.size(); ++c) overlaps = overlaps || votes(c, r) > 0.0;
    if (overlaps) continue;  // merged into an older one
    double nearest_m = reach_m;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      const double distance_m = (clusters[c].center_W_m - centers_W_m_[r]).norm();
      if (of_cluster_[c] != nobodys || !(distance_m < nearest_m)) continue;
      nearest_m = distance_m;
      of_region_[r] = static_cast<std::int32_t>(c);
    }
    if (of_region_[r] >= 0) nth(of_cluster_, of_region_[r]) = static_cast<std::int32_t>(r);
  }

  Tracking tracking;
  std::size_t count = 0;
  for (std::size_t r = 0; r < regions && count < capacity; ++r)
    if (of_region_[r] >= 0) out[count++] = {static_cast<int>(r), static_cast<int>(of_region_[r])};
  for (;;) {
    std::int32_t deepest = -1;
    for (std::size_t c = 0; c < clusters.size(); ++c) {
      if (of_cluster_[c] >= 0) continue;
      if (deepest < 0 || clusters[c].deepest_m > nth(clusters, deepest).deepest_m)
        deepest = static_cast<std::int32_t>(c);
    }
    if (deepest < 0) break;
    nth(of_cluster_, deepest) = 0;
    if (count < capacity) {
      out[count++] = {-1, static_cast<int>(deepest)};
    } else {
      ++tracking.dropped;
    }
  }

  forget();
  for (std::size_t r = 0; r < count; ++r) {
    const Cluster& taken = nth(clusters, out[r].cluster);
    centers_W_m_[r] = taken.center_W_m;
    for (int i = taken.points.begin; i < taken.points.begin + taken.points.size; ++i) {
      const std::int32_t sample = nth(points.sample, i);
      std::int16_t& label = nth(label_, sample);
      if (label < 0) labelled_[labelled_count_++] = sample;
      label = static_cast<std::int16_t>(r);
    }
  }
  count_ = static_cast<int>(count);
  tracking.count = count_;
  return tracking;
}

}  // namespace touchstone::fast
