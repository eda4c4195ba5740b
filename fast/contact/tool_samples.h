// Points of the tool's surface where contact is evaluated, and the bounding-sphere tree that finds them (sections III,
// IV-C). The paper takes the vertices of the tool's mesh "provided that these vertex points are evenly distributed";
// sampling the surface makes that true for any tool.
#pragma once

#include "fast/contact/surface_cells.h"
#include "scene/model/scene.h"

#include <cstdint>
#include <vector>

namespace touchstone::fast {

/// Samples in a leaf of the tree, at most.
inline constexpr std::int32_t tool_leaf_size = 8;

/// Balls around the samples [begin, end) in tool coordinates, and around their cells. Nodes are in depth-first order:
/// the first child of an inner node follows it, and `next` is the node to visit after this one's samples.
struct SampleBall {
  scene::Vec3 center_T_m;
  double radius_m = 0.0;        ///< of the ball with the samples
  double cells_radius_m = 0.0;  ///< of the one with their cells
  std::int32_t begin = 0, end = 0;
  std::int32_t next = 0;
  bool leaf = true;
};

/// Evenly spread points of the tool's surface, each with outward normal and area of the surface, in the order of the
/// tree's leaves. Frame T: its origin is the tool's mass centre.
struct ToolSamples {
  std::vector<double> x_T_m, y_T_m, z_T_m;
  std::vector<double> nx_T, ny_T, nz_T;
  std::vector<double> area_m2;    ///< A_i; sums to the surface
  std::vector<SurfaceCell> cell;  ///< of each sample, together the surface; only of cell_tool()
  CellGroups groups;              ///< of a fine mesh
  /// Of each cell, half the sum of both curvatures of a tool without edges: a ball, a capsule, or a convex mesh whose
  /// neighbouring facets turn by little. Otherwise empty.
  std::vector<double> mean_curvature_per_m;
  double spacing_m = 0.0;        ///< sqrt(surface / count)
  std::vector<SampleBall> tree;  ///< root first

  [[nodiscard]] int count() const noexcept { return static_cast<int>(x_T_m.size()); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// Samples of any tool, each for nearly the same area, together for all of it. Their number is about `count` and at
/// most twice that, except for the minimum a tool needs: four in each ring, one on each separate face or triangle.
/// - sphere: of equal area
/// - capsule, cylinder: rings of evenly spaced points, at least two along each piece of the profile
/// - box: a grid on every face
/// - mesh: triangles are halved at their longest side until small enough; of a finer mesh, neighbouring triangles with
///   similar normals have one sample, on the triangle nearest to their centre. On a convex mesh they are evenly spread:
///   their number is that of a primitive shape of the same form, to some percent
/// The pattern is mirrored where the tool is, so that in a straight press sampling causes no side force or torque.
/// Samples are inside the faces, none on an edge or corner.
[[nodiscard]] ToolSamples sample_tool(const scene::Tool& tool, int count);

/// The same with their cells; of a sphere in rings, too.
[[nodiscard]] ToolSamples cell_tool(const scene::Tool& tool, int count);

}  // namespace touchstone::fast
