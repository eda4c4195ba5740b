// Which samples of the tool lie beneath the body's rest surface, how deep along the direction of deformation d, and
// how d is chosen (sections II-B, III, appendix III: the set M).
#pragma once

#include "fast/contact/find_cells.h"
#include "fast/contact/pull_back.h"
#include "fast/contact/region_points.h"
#include "fast/contact/tool_samples.h"
#include "scene/shape/shape.h"

namespace touchstone::fast {

/// Fills `points` with the samples strictly inside the rest surface, or nearer to it from outside than margin_m: a ball
/// of the tree further out than that is passed over. Points come in the order of the tree, so equal poses give equal
/// bits. The summary speaks of the inside ones.
/// @param limit stops once this many points are found
using FindInside = InsideSummary (*)(const scene::Shape&, const ToolSamples&, const Placement&, double margin_m,
                                     int limit, RegionPoints&) noexcept;

/// The summary of points as they stand, none left out but those that are not inside.
using Summarise = InsideSummary (*)(const scene::Shape&, const RegionPoints&) noexcept;

/// Keeps the points with n_i . d >= 0 (the set M of appendix III) and gives each its depth d_i along d.
/// @param d unit direction of deformation, into the body
using MeasureDepths = RegionExtent (*)(const scene::Shape&, const scene::Mat3& R_WT, const scene::Vec3& d,
                                       RegionPoints&) noexcept;

/// Way from a point of the body along a direction to the rest surface [m].
using ExitDistance = double (*)(const scene::Shape&, const scene::Vec3& p_W_m, const scene::Vec3& direction) noexcept;

/// Detection for one shape of body.
struct Detection {
  FindInside find_inside = nullptr;
  FindCells find_cells = nullptr;
  Summarise summarise = nullptr;
  PullBack pull_back = nullptr;
  MeasureDepths measure_depths = nullptr;
  ExitDistance exit_distance_m = nullptr;
};
/// For bodies of that class, one of scene::Solids.
[[nodiscard]] Detection detection_for(const scene::Shape& shape) noexcept;

/// Direction of deformation the rest surface asks for: against the mean of its normals.
/// Falls back on `otherwise` where the normals cancel (a tool around the middle of the body).
[[nodiscard]] scene::Vec3 direction_from(const InsideSummary& inside, const scene::Vec3& otherwise) noexcept;

/// A region's direction in its next tick. The closest surface of a deep point may be a far side of the body, which
/// would turn the force around and let the tool through; so d follows the surface only while the normals agree (their
/// mean is at least half as long as they are) and the turn is below a right angle. Otherwise d stays.
[[nodiscard]] scene::Vec3 follow_direction(const scene::Vec3& d, const InsideSummary& inside) noexcept;

}  // namespace touchstone::fast
