// Which samples of the tool lie beneath the body's rest surface, how deep along the direction of deformation d, and
// how d is chosen (sections II-B, III, appendix III: the set M).
#pragma once

#include "fast/tool_samples.h"
#include "scene/frames.h"
#include "scene/shape.h"

#include <cstddef>
#include <vector>

namespace touchstone::fast {

/// The tool's placement in the world, with the rotation written out: p_W = R_WT p_T + origin_W_m.
struct Placement {
  scene::Mat3 R_WT = scene::Mat3::Identity();
  scene::Vec3 origin_W_m = scene::Vec3::Zero();  ///< the tool's mass centre
};

/// The points p_i of one contact region. Storage is fixed at construction; `count` entries are in use.
struct RegionPoints {
  explicit RegionPoints(int capacity);

  int count = 0;
  std::vector<double> x_W_m, y_W_m, z_W_m;  ///< p_i in the world
  std::vector<double> x_T_m, y_T_m, z_T_m;  ///< p_i about the tool's mass centre
  std::vector<double> nx_T, ny_T, nz_T;     ///< outward normal n_i of the tool
  std::vector<double> area_m2;              ///< A_i
  std::vector<double> cos_theta;            ///< n_i . d, >= 0
  std::vector<double> depth_m;              ///< d_i, along d from the rest surface
  std::vector<double> share;                ///< m_i / m

  /// Copies point `from` to the place `to`, as far as detection has filled it.
  void move(int from, int to) noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return 13 * x_W_m.size() * sizeof(double); }
};

/// What the inside samples say about the rest surface above them, each weighted by its area times its distance to
/// the rest surface.
struct InsideSummary {
  scene::Vec3 normal_sum = scene::Vec3::Zero();  ///< of the rest surface's normals at the closest points
  double weight_sum = 0.0;
  double deepest_m = 0.0;  ///< largest distance to the rest surface
};

/// Fills `points` with the samples strictly inside the rest surface: a ball of the tree further out than its radius
/// is passed over. Points come in the order of the tree, so equal poses give equal bits.
/// @param limit stops once this many points are found
using FindInside = InsideSummary (*)(const scene::Shape&, const ToolSamples&, const Placement&, int limit,
                                     RegionPoints&) noexcept;

/// What the region looks like along d.
struct RegionExtent {
  double deepest_m = 0.0;                        ///< largest d_i
  double thickness_m = 0.0;                      ///< of the body, along d through the deepest point
  double area_m2 = 0.0;                          ///< sum of A_i cos(theta_i): the samples' area projected along d
  scene::Vec3 center_W_m = scene::Vec3::Zero();  ///< area-weighted centre of the points projected along d
};

/// Keeps the points with n_i . d >= 0 (the set M of appendix III) and gives each its depth d_i along d.
/// @param d unit direction of deformation, into the body
using MeasureDepths = RegionExtent (*)(const scene::Shape&, const scene::Mat3& R_WT, const scene::Vec3& d,
                                       RegionPoints&) noexcept;

/// Way from a point of the body along a direction to the rest surface [m].
using ExitDistance = double (*)(const scene::Shape&, const scene::Vec3& p_W_m, const scene::Vec3& direction) noexcept;

/// Detection for one shape of body.
struct Detection {
  FindInside find_inside = nullptr;
  MeasureDepths measure_depths = nullptr;
  ExitDistance exit_distance_m = nullptr;
};
[[nodiscard]] Detection detection_for(const scene::Box& body) noexcept;
[[nodiscard]] Detection detection_for(const scene::Sphere& body) noexcept;

/// Direction of deformation the rest surface asks for: against the mean of its normals.
/// Falls back on `otherwise` where the normals cancel (a tool around the middle of the body).
[[nodiscard]] scene::Vec3 direction_from(const InsideSummary& inside, const scene::Vec3& otherwise) noexcept;

/// A region's direction in its next tick. The closest surface of a deep point may be a far side of the body, which
/// would turn the force around and let the tool through; so d follows the surface only while the normals agree (their
/// mean is at least half as long as they are) and the turn is below a right angle. Otherwise d stays.
[[nodiscard]] scene::Vec3 follow_direction(const scene::Vec3& d, const InsideSummary& inside) noexcept;

}  // namespace touchstone::fast
