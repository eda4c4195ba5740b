#include "fast/skeleton/beam_areas.h"

#include "scene/base/index.h"

#include <algorithm>
#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr double least_share_rel = 1e-6;

/// (18), in place: normalises the weights to a sum of 1.
void to_shares(std::span<double> gamma) noexcept {
  const double sum = std::accumulate(gamma.begin(), gamma.end(), 0.0);
  const double mean_m2 = sum / static_cast<double>(gamma.size());
  if (!(mean_m2 > 0.0)) {
    std::fill(gamma.begin(), gamma.end(), 1.0 / static_cast<double>(gamma.size()));
    return;
  }
  const double least_m2 = least_share_rel * mean_m2;
  if (std::all_of(gamma.begin(), gamma.end(), [&](double area_m2) { return area_m2 >= least_m2; })) {
    for (double& share : gamma) share /= sum;
    return;
  }
  for (double& area_m2 : gamma) area_m2 = std::max(area_m2, least_m2);
  const double raised = std::accumulate(gamma.begin(), gamma.end(), 0.0);
  for (double& share : gamma) share /= raised;
}

}  // namespace

AreaTriangles area_triangles(const AnchorPoints& anchors) {
  AreaTriangles triangles;
  triangles.anchors = anchors.points_m().size();
  for (int patch = 0; patch < static_cast<int>(anchors.patches().size()); ++patch) {
    if (!anchors.first_between_its_anchors(patch)) continue;
    const std::vector<int> around = anchors.around(patch);
    const std::size_t corners = around.size();
    for (std::size_t i = 0; i < corners; ++i) {
      const int self = around[i];
      const Vec3& p_i = nth(anchors.points_m(), self);
      for (std::size_t step = 1; step + 1 < corners; ++step) {
        const int j = around[(i + step) % corners], k = around[(i + step + 1) % corners];
        triangles.triangle.push_back(
            {{self, j, k}, anchors.halfway_m(patch, self, j) - p_i, anchors.halfway_m(patch, self, k) - p_i});
      }
    }
  }
  return triangles;
}

std::vector<double> voronoi_areas_m2(const AreaTriangles& triangles) {
  std::vector<double> gamma(triangles.anchors, 0.0);
  for (const AreaTriangles::Triangle& t : triangles.triangle) {
    nth(gamma, t.anchor[0]) += 0.5 * t.to_ij_m.cross(t.to_ik_m).norm();
  }
  return gamma;
}

std::vector<double> voronoi_shares(const AreaTriangles& triangles) {
  std::vector<double> shares = voronoi_areas_m2(triangles);
  to_shares(shares);
  return shares;
}

void voronoi_shares(const AreaTriangles& triangles, std::span<const Vec3> anchor_displacement_m,
                    std::span<double> shares) noexcept {
  std::fill(shares.begin(), shares.end(), 0.0);
  for (const AreaTriangles::Triangle& t : triangles.triangle) {
    const Vec3& u_i = nth(anchor_displacement_m, t.anchor[0]);
    const Vec3& u_j = nth(anchor_displacement_m, t.anchor[1]);
    const Vec3& u_k = nth(anchor_displacement_m, t.anchor[2]);
    const Vec3 to_ij_m = t.to_ij_m + 0.5 * (u_j - u_i), to_ik_m = t.to_ik_m + 0.5 * (u_k - u_i);
    nth(shares, t.anchor[0]) += 0.5 * to_ij_m.cross(to_ik_m).norm();
  }
  to_shares(shares);
}

}  // namespace touchstone::fast
