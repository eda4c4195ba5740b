// Cross-section areas of the beams, appendix IV, equations (18) and (19).
#pragma once

#include "fast/anchor_points.h"

#include <vector>

namespace touchstone::fast {

/// Gamma_i [m^2]: the area of anchor point p_i's Voronoi region, approximated on each of its patches by the triangles
/// (p_i, p_ij, p_ik), p_ij the centre of the shortest curve to anchor point j and j, k neighbours around the patch.
/// Two anchor points of one patch count as adjacent, also across a box face's diagonal, where their regions meet in a
/// point: without it a box would have no triangle at all. With it the triangles cover a box exactly. On a sphere the
/// flat triangles cover 55.3 % of the surface, the same part of every region, so the shares are exact there too.
[[nodiscard]] std::vector<double> voronoi_areas_m2(const AnchorPoints& anchors);

/// gamma_i of equation (18): Gamma_i over their sum; sums to 1.
[[nodiscard]] std::vector<double> voronoi_shares(const AnchorPoints& anchors);

}  // namespace touchstone::fast
