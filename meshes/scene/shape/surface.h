// Triangulated surfaces: the rest points at which both solvers give the body's shape.
#pragma once

#include "scene/mesh/triangle_mesh.h"
#include "scene/shape/shape.h"

#include <array>
#include <cstdint>
#include <vector>

namespace touchstone::scene {

/// Indexed triangles on a shape. Vertices are sorted by patch and never shared between patches, so
/// that a sharp edge keeps one normal per side; every vertex lies exactly on the shape.
struct Surface {
  Eigen::Matrix3Xd points_m;                           ///< rest points, one column per vertex
  Eigen::Matrix3Xd normals;                            ///< outward unit normals of the shape there
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<std::int32_t> patch_begin;               ///< size patch_count + 1: first vertex of each patch
  std::vector<double> vertex_area_m2;                  ///< a third of the adjacent triangles, sums to the mesh's area

  [[nodiscard]] int vertex_count() const noexcept { return static_cast<int>(points_m.cols()); }
  [[nodiscard]] int triangle_count() const noexcept { return static_cast<int>(triangles.size()); }
};

/// Triangles of nearly equal size; the count is the nearest the shape's regular pattern allows
/// (box: two per cell of a grid on each face; sphere and ellipsoid: n^2 per octant; revolution: bands between rings of
/// vertices, whose number follows the radius). Where patches meet, their vertices coincide. Vertices run row by row, so
/// that along a row the neighbours have equal distances in the order.
/// @param triangles requested number, at least 8
[[nodiscard]] Surface tessellate(const Shape& shape, int triangles);

/// A mesh as a surface of one patch, for drawing: every triangle has three vertices of its own with the triangle's
/// normal, so edges stay sharp.
[[nodiscard]] Surface surface_of(const TriangleMesh& mesh);

}  // namespace touchstone::scene
