// Clusters the contact points into regions and tracks the regions from tick to tick (sections II-B, III, appendix I).
// The paper divides its meshes to follow several contacts; here the points are clustered.
#pragma once

#include "fast/contact/contact_detection.h"
#include "fast/contact/tool_samples.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace touchstone::fast {

/// Points [begin, begin + size) of a window.
struct PointRange {
  int begin = 0, size = 0;
};

/// Points connected by steps shorter than r_th (section II-B).
struct Cluster {
  PointRange points;
  double area_m2 = 0.0;                          ///< sum of A_i
  double deepest_m = 0.0;                        ///< largest depth_m
  scene::Vec3 center_W_m = scene::Vec3::Zero();  ///< area-weighted centre
};

/// The tool's samples in cells that are smaller than r_th, and which cells are near each other. The samples are rigid
/// in the tool frame, so all of it is constant; a tick visits only the cells with contact points.
struct ClusterGrid {
  /// Another cell that may have samples nearer than r_th. Each pair is listed once, at its cell of lower number.
  struct Neighbour {
    std::int32_t cell = 0;
    bool certain = false;  ///< every sample of one is nearer than r_th to every sample of the other
  };
  /// Around the samples of a cell, tool frame.
  struct SampleBox {
    scene::Vec3 lower_m = scene::Vec3::Constant(std::numeric_limits<double>::infinity());
    scene::Vec3 upper_m = -lower_m;
    void add(const scene::Vec3& p_m) noexcept {
      lower_m = lower_m.cwiseMin(p_m);
      upper_m = upper_m.cwiseMax(p_m);
    }
  };
  double r_th_m = 0.0;
  std::vector<scene::Vec3> sample_T_m;        ///< places of the samples
  std::vector<std::int32_t> cell;             ///< per sample
  std::vector<SampleBox> box;                 ///< per cell
  std::vector<std::int32_t> neighbour_begin;  ///< size cells + 1
  std::vector<Neighbour> neighbours;

  [[nodiscard]] int cell_count() const noexcept { return static_cast<int>(neighbour_begin.size()) - 1; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};
/// @param r_th_m > 0
[[nodiscard]] ClusterGrid cluster_grid(const ToolSamples& tool, double r_th_m);

/// Scratch memory of cluster(), valid during a call only.
class ClusterScratch {
 public:
  /// @param points at most
  ClusterScratch(const ClusterGrid& grid, int points);
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  struct Cell {
    std::int32_t parent = 0;  ///< of the union, over all cells
    std::int32_t first = -1;  ///< point, -1 for a cell without points
    std::int32_t cluster = -1;
  };
  friend struct ClusterCount cluster(const ClusterGrid& grid, RegionPoints& all, ClusterScratch& scratch,
                                     std::span<Cluster> out) noexcept;
  [[nodiscard]] std::int32_t root(std::int32_t cell) noexcept;
  void join(std::int32_t a, std::int32_t b) noexcept;
  /// Whether a point's sample of cell a is nearer than r_th to one of cell b.
  [[nodiscard]] bool near(const ClusterGrid& grid, const RegionPoints& points, std::int32_t a,
                          std::int32_t b) const noexcept;

  std::vector<Cell> cells_;
  std::vector<std::int32_t> occupied_;  ///< cells with points
  std::vector<std::int32_t> next_;      ///< per point, the next one in its cell
  std::vector<std::int32_t> of_point_;  ///< per point, its cluster
  std::vector<std::int32_t> order_, rank_, begin_;
  std::vector<double> area_m2_;  ///< per cluster
  std::vector<double> column_;
};

struct ClusterCount {
  int count = 0;
  int dropped = 0;  ///< clusters beyond the capacity, those of least area; their points are gone
};

/// Sorts the points by cluster, the order within each kept, and describes the clusters, which come in the order of
/// their first points. Two points are in one cluster exactly if a chain of samples with points leads from one to the
/// other in steps shorter than r_th, in the tool frame, whatever has been done to the points' world coordinates.
/// @param all at most as many points as the scratch has room for, with depth_m; points of one sample are together
/// @param out as many clusters as it holds are kept
ClusterCount cluster(const ClusterGrid& grid, RegionPoints& all, ClusterScratch& scratch,
                     std::span<Cluster> out) noexcept;

/// A region of this tick.
struct TrackedRegion {
  int was = -1;     ///< its place in the last tick's list; -1 for a new one
  int cluster = 0;  ///< of this tick
  [[nodiscard]] bool created() const noexcept { return was < 0; }
};

struct Tracking {
  int count = 0;
  int dropped = 0;  ///< new regions beyond the capacity, the shallowest; their clusters have no force
};

/// Follows regions from tick to tick: stores the region of every sample.
class RegionTracker {
 public:
  /// @param max_regions at most 32767
  RegionTracker(int samples, int max_clusters, int max_regions);

  /// The regions of this tick in order of creation: the continuing ones, in the last tick's order, then the new ones.
  /// - Regions choose in the order of their creation. Each takes, of the clusters not yet taken, the one in which
  ///   most of its last samples lie, by area. So when a region splits, its larger part continues it and the other part
  ///   is a new one; when regions merge, the oldest continues and the others end.
  /// - A region none of whose samples is in contact any more takes the nearest cluster that is free and without any
  ///   region's samples, if the centres are nearer than reach_m: a tool that rolls fast.
  /// - Of the remaining clusters, the new regions, the deepest comes first. (The paper has one new region per tick.)
  /// @param clusters of `points`, at most max_clusters
  /// @param out at least max_regions
  Tracking track(const RegionPoints& points, std::span<const Cluster> clusters, double reach_m,
                 std::span<TrackedRegion> out) noexcept;
  /// Back to no contact.
  void forget() noexcept;
  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;

 private:
  [[nodiscard]] double& votes(std::size_t cluster, std::size_t region) noexcept {
    return votes_m2_[cluster * centers_W_m_.size() + region];
  }

  int count_ = 0;                       ///< regions of the last tick
  std::vector<std::int16_t> label_;     ///< per sample, its region's place in the last tick's list, -1 for none
  std::vector<std::int32_t> labelled_;  ///< samples with a label
  std::size_t labelled_count_ = 0;
  std::vector<scene::Vec3> centers_W_m_;  ///< per region of the last tick
  std::vector<double> votes_m2_;          ///< clusters x regions
  std::vector<std::int32_t> of_region_;   ///< per region of the last tick, its cluster, -1 for none
  std::vector<std::int32_t> of_cluster_;  ///< per cluster, its region, free or voted
};

}  // namespace touchstone::fast
