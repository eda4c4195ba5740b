#include "reference/contact/regions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>

namespace touchstone::reference {

std::vector<int> region_of_points(const Eigen::Matrix3Xd& points_m, const std::vector<std::pair<int, int>>& links,
                                  double gap_m) {
  const int count = static_cast<int>(points_m.cols());
  std::vector<int> parent(count);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto join = [&](int a, int b) { parent[std::max(root(a), root(b))] = std::min(root(a), root(b)); };
  for (const auto& [a, b] : links) join(a, b);
  const auto near = [&](int a, int b) { return (points_m.col(a) - points_m.col(b)).squaredNorm() <= gap_m * gap_m; };
  // Cubes whose diagonal is the gap: the points of one are near each other, and those near them no further than two
  // cubes away.
  using Cube = std::array<std::int64_t, 3>;
  const double edge_m = std::max(gap_m / std::sqrt(3.0) * (1.0 - 1e-12), 1e-12);
  std::map<Cube, std::vector<int>> cubes;
  for (int i = 0; i < count; ++i) {
    Cube cube;
    for (int axis = 0; axis < 3; ++axis) {
      cube[axis] = static_cast<std::int64_t>(std::floor(points_m(axis, i) / edge_m));
    }
    std::vector<int>& inside = cubes[cube];
    if (!inside.empty() && near(i, inside.front())) join(i, inside.front());
    inside.push_back(i);
  }
  for (const auto& [cube, inside] : cubes) {
    for (int step = 0; step < 125; ++step) {
      const auto other = cubes.find({cube[0] + step / 25 - 2, cube[1] + step / 5 % 5 - 2, cube[2] + step % 5 - 2});
      if (other == cubes.end() || other->first <= cube) continue;
      // The points of a cube are of one region, so one pair is enough, and none where they are joined already.
      if (root(inside.front()) == root(other->second.front())) continue;
      for (const int a : inside) {
        const auto b = std::ranges::find_if(other->second, [&](int p) { return near(a, p); });
        if (b == other->second.end()) continue;
        join(a, *b);
        break;
      }
    }
  }
  std::vector<int> region(count);
  int regions = 0;
  for (int i = 0; i < count; ++i) region[i] = root(i) == i ? regions++ : region[root(i)];
  return region;
}

std::vector<RegionIds::Place> RegionIds::follow(const std::vector<ContactRegion>& regions, double reach_m) {
  std::vector<int> region_of(living_.size(), -1);
  std::vector<bool> known(regions.size(), false);
  for (;;) {
    double nearest_m = reach_m;
    int old = -1, now = -1;
    for (std::size_t l = 0; l < living_.size(); ++l) {
      for (std::size_t r = 0; r < regions.size(); ++r) {
        const double distance_m = (regions[r].center_m - living_[l].center_m).norm();
        if (region_of[l] >= 0 || known[r] || distance_m > nearest_m || (distance_m == nearest_m && old >= 0)) continue;
        nearest_m = distance_m;
        old = static_cast<int>(l);
        now = static_cast<int>(r);
      }
    }
    if (old < 0) break;
    region_of[old] = now;
    known[now] = true;
  }
  std::vector<Place> places;
  for (std::size_t l = 0; l < living_.size(); ++l) {
    if (region_of[l] >= 0) places.push_back({living_[l].id, region_of[l]});
  }
  std::vector<int> created;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (!known[r]) created.push_back(static_cast<int>(r));
  }
  std::stable_sort(created.begin(), created.end(),
                   [&](int a, int b) { return regions[a].force_n.squaredNorm() > regions[b].force_n.squaredNorm(); });
  for (const int region : created) {
    int id = 0;
    while (std::any_of(places.begin(), places.end(), [&](const Place& place) { return place.id == id; })) ++id;
    places.push_back({id, region});
  }
  living_.clear();
  for (const Place& place : places) living_.push_back({place.id, regions[place.region].center_m});
  return places;
}

}  // namespace touchstone::reference
