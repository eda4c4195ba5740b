// Cross-section areas of the beams, appendix IV, equations (18) and (19).
#pragma once

#include "fast/skeleton/anchor_points.h"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace touchstone::fast {

/// The triangles (p_i, p_ij, p_ik) that approximate the anchor points' Voronoi regions: p_ij is the centre of the
/// shortest curve to anchor point j, and j, k are neighbours around a patch. Two anchor points of one patch count as
/// adjacent, also across a box face's diagonal, where their regions meet in a point: without it a box would have no
/// triangle at all. With it the triangles cover a box exactly. On a sphere the flat triangles cover 55.3 % of the
/// surface, the same fraction of every region, so the fractions are exact there too.
struct AreaTriangles {
  struct Triangle {
    std::array<int, 3> anchor{};   ///< i, j, k
    scene::Vec3 to_ij_m, to_ik_m;  ///< p_ij - p_i and p_ik - p_i at rest
  };
  std::vector<Triangle> triangle;
  std::size_t anchors = 0;
};
[[nodiscard]] AreaTriangles area_triangles(const AnchorPoints& anchors);

/// Gamma_i [m^2] at rest: the area of anchor point p_i's triangles.
[[nodiscard]] std::vector<double> voronoi_areas_m2(const AreaTriangles& triangles);

/// gamma_i of equation (18) at rest: Gamma_i over their sum; sums to 1.
[[nodiscard]] std::vector<double> voronoi_shares(const AreaTriangles& triangles);

/// The same on the body that earlier regions have deformed (appendix IV). p_ij
/// follows by the mean of the displacements of i and j, as given by the anchor points alone. No fraction is less than a
/// millionth of the mean one, so that no beam has a zero section; where the anchor points coincide all are equal.
/// @param anchor_displacement_m per anchor point, from its place at rest; @param shares gamma_i per anchor point
void voronoi_shares(const AreaTriangles& triangles, std::span<const scene::Vec3> anchor_displacement_m,
                    std::span<double> shares) noexcept;

}  // namespace touchstone::fast
