#include "fast/step/order_spread.h"

#include "fast/step/stages.h"
#include "fast/step/step.h"
#include "scene/base/index.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace touchstone::fast {
namespace {

/// All other orders of 0 to count - 1, or some of them if there are many.
std::vector<std::vector<int>> other_orders(std::size_t count) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::vector<std::vector<int>> orders;
  if (count <= 4) {
    while (std::next_permutation(order.begin(), order.end())) orders.push_back(order);
    return orders;
  }
  orders.emplace_back(order.rbegin(), order.rend());
  for (std::size_t k = 1; k < count; ++k) {
    std::rotate(order.begin(), order.begin() + 1, order.end());
    orders.push_back(order);
  }
  return orders;
}

}  // namespace

OrderSpread order_spread(const FastModel& model, FastState& state) {
  OrderSpread spread;
  if (state.several == nullptr || state.region_count < 2) return spread;
  SeveralRegionsState& several = *state.several;
  const scene::Vec3 total_n = total_force_n(state);
  const double size_n = total_n.norm();
  if (!(size_n > 0.0)) return spread;
  spread.equilibrium_rel = (total_n - support_force_n(state)).norm() / size_n;

  const Motion motion = state.motion;
  const std::vector<ContactRegion> regions = state.regions;
  const SeveralRegionsState kept = several;
  state.motion = {motion.pose, motion.at, motion.pose, true};
  for (const std::vector<int>& order : other_orders(static_cast<std::size_t>(state.region_count))) {
    std::copy(order.begin(), order.end(), several.order.begin());
    // The points before the rest-point search, which depends on the earlier regions.
    RegionPoints all = state.store.window();
    find_points(model, motion.at, kept.bulge_m, all, state.cells);
    cluster(*model.clusters, all, several.scratch, several.clusters);
    for (std::size_t k = 0; k < order.size(); ++k) {
      const PointRange range = nth(several.clusters, several.tracked[k].cluster).points;
      state.regions[k].points = all.slice(range.begin, range.size);
    }
    step(model, motion.pose, state, Parts::press);
    spread.spread_rel = std::max(spread.spread_rel, (total_force_n(state) - total_n).norm() / size_n);
  }

  state.motion = motion;
  std::copy(regions.begin(), regions.end(), state.regions.begin());
  several = kept;
  return spread;
}

}  // namespace touchstone::fast
