#include "fast/beam_areas.h"

#include <numeric>

namespace touchstone::fast {

using scene::Vec3;

std::vector<double> voronoi_areas_m2(const AnchorPoints& anchors) {
  std::vector<double> gamma(anchors.points_m().size(), 0.0);
  for (int patch = 0; patch < static_cast<int>(anchors.patches().size()); ++patch) {
    const std::vector<int> around = anchors.around(patch);
    const std::size_t corners = around.size();
    for (std::size_t i = 0; i < corners; ++i) {
      const int self = around[i];
      const Vec3& p_i = anchors.points_m()[static_cast<std::size_t>(self)];
      for (std::size_t step = 1; step + 1 < corners; ++step) {
        const Vec3 p_ij = anchors.halfway_m(self, around[(i + step) % corners]);
        const Vec3 p_ik = anchors.halfway_m(self, around[(i + step + 1) % corners]);
        gamma[static_cast<std::size_t>(self)] += 0.5 * (p_ij - p_i).cross(p_ik - p_i).norm();
      }
    }
  }
  return gamma;
}

std::vector<double> voronoi_shares(const AnchorPoints& anchors) {
  std::vector<double> shares = voronoi_areas_m2(anchors);
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= sum;  // (18)
  return shares;
}

}  // namespace touchstone::fast
