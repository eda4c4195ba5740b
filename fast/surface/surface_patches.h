// The body's rest surface laid out for the passes over it: one array per component, vertices sorted by patch, single
// precision (a displacement of millimetres keeps a tenth of a nanometre).
#pragma once

#include "fast/skeleton/anchor_points.h"
#include "scene/shape/surface.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace touchstone::fast {

using Columns3 = std::array<std::vector<float>, 3>;

/// The same as one column per vertex.
[[nodiscard]] Eigen::Matrix3Xd matrix_of(const Columns3& columns);
[[nodiscard]] Columns3 columns_of(const Eigen::Matrix3Xd& matrix);
using Columns4 = std::array<std::vector<float>, patch_corners_max>;

inline constexpr std::int32_t block_vertices = 32;

/// Consecutive vertices of a patch, at most block_vertices, and the box around their rest points, to pass over what is
/// out of reach.
struct VertexBlock {
  std::int32_t begin = 0, end = 0;
  Eigen::Vector3f low_W_m, high_W_m;

  /// Square of a point's distance to the box.
  [[nodiscard]] float distance2_m2(const Eigen::Vector3f& p_m) const noexcept {
    return (low_W_m - p_m).cwiseMax(p_m - high_W_m).cwiseMax(0.0f).squaredNorm();
  }
};

/// One patch of the rest surface.
struct Patch {
  std::int32_t begin = 0, end = 0;  ///< its vertices
  std::size_t corners = 0;          ///< its anchor points
  std::array<int, patch_corners_max> anchor{};
  /// The rest surface's normal on this patch at each of its anchor points.
  std::array<scene::Vec3, patch_corners_max> corner_normal;
  /// A ball around its vertices.
  scene::Vec3 center_W_m;
  double radius_m = 0.0;
  VertexBlock all;                               ///< of its vertices
  std::int32_t first_block = 0, last_block = 0;  ///< its blocks, the last one not included
};

/// Everything about the rest surface that the passes read, fixed once built.
struct SurfacePatches {
  std::vector<Patch> patches;
  std::vector<VertexBlock> blocks;
  Columns3 rest_W_m;        ///< rest points
  Columns3 normal;          ///< outward unit normals of the rest shape
  Columns4 weight;          ///< PatchPlace::weight
  std::vector<float> free;  ///< PatchPlace::free

  [[nodiscard]] std::size_t vertex_count() const noexcept { return rest_W_m[0].size(); }
  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};
[[nodiscard]] SurfacePatches surface_patches(const scene::Surface& surface, const AnchorPoints& anchors);

/// The deformed surface: what the passes write. Storage is fixed at construction.
struct SurfaceField {
  explicit SurfaceField(const SurfacePatches& rest) : SurfaceField(rest.normal) {}
  explicit SurfaceField(const Columns3& rest_normal);
  Columns3 displacement_m;
  Columns3 normal;  ///< unit length, outward

  /// Back to rest.
  void reset(const Columns3& rest_normal) noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return 6 * displacement_m[0].size() * sizeof(float); }
};

}  // namespace touchstone::fast
