#include "fast/step/several_regions.h"

#include <algorithm>
#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Clusters beyond the regions are told apart before the smallest are given up.
constexpr int clusters_per_region = 2;

/// How far a region's centre may travel in a tick without sharing a sample with its last place, in units of r_th.
constexpr double reach_over_r_th = 2.0;

std::size_t capacity(const FastModel& model) { return static_cast<std::size_t>(model.max_regions); }

int smallest_free_id(const FastState& state) noexcept {
  for (int id = 0;; ++id) {
    const bool taken = std::any_of(state.regions.begin(), state.regions.end(),
                                   [&](const ContactRegion& region) { return region.active && region.id == id; });
    if (!taken) return id;
  }
}

/// Keeps the points inside the rest surface, in their order.
void keep_inside(RegionPoints& points) noexcept {
  int kept = 0;
  for (int i = 0; i < points.count; ++i) {
    if (!(points.depth_m[i] > 0.0)) continue;
    if (kept != i) points.move(i, kept);
    ++kept;
  }
  points.count = kept;
}

/// Brings state.regions to what the tracker says, each with its points.
void take_over(const RegionPoints& all, int count, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  const int before = state.region_count;
  for (int k = 0; k < before; ++k) {
    const bool goes_on = std::any_of(several.tracked.begin(), several.tracked.begin() + count,
                                     [&](const TrackedRegion& region) { return region.was == k; });
    if (!goes_on) state.regions[static_cast<std::size_t>(k)].clear();
  }
  for (int k = 0; k < count; ++k) {
    const TrackedRegion& tracked = several.tracked[static_cast<std::size_t>(k)];
    ContactRegion& region = state.regions[static_cast<std::size_t>(k)];
    // Regions that go on stand in their old order, so `was` is never before k.
    if (!tracked.created() && tracked.was != k) std::swap(region, state.regions[static_cast<std::size_t>(tracked.was)]);
    if (tracked.created()) {
      region.clear();
      region.id = smallest_free_id(state);
      region.active = true;
    }
    const PointRange range = several.clusters[static_cast<std::size_t>(tracked.cluster)].points;
    region.points = all.slice(range.begin, range.size);
  }
  state.region_count = count;
}

/// Shape_i of the regions in the stack.
class StackedSurface final : public DisplacedSurface {
 public:
  StackedSurface(const FastModel& model, const LocalConstants* local, ShapeStack& shapes) noexcept
      : model_(model), local_(local), shapes_(shapes) {}
  void displace(int patch, PointLanes& lanes) const noexcept override {
    model_.formulas.several.displacements_at(*model_.anchors, local_, patch, shapes_, lanes);
  }

 private:
  const FastModel& model_;
  const LocalConstants* local_;
  ShapeStack& shapes_;
};

/// Presses one region on the shape of those already in the stack, and adds it to the stack.
StepStatus press_next(const FastModel& model, const Motion& motion, bool alone, ContactRegion& region,
                      std::span<BeamStress> stress, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  ShapeStack& shapes = several.shapes;
  const LocalConstants* local = model.formulas.local_factor() ? &model.local : nullptr;
  InsideSummary inside;
  if (shapes.count > 0) {
    inside =
        model.detection.pull_back(*model.body, StackedSurface(model, local, shapes), region.points, several.pull_back);
  } else {
    keep_inside(region.points);
    inside = model.detection.summarise(*model.body, region.points);
  }
  state.lap(Stage::regions);
  StepStatus status = StepStatus::ok;
  region.force = RegionForce{};
  region.displacement_m.setZero();
  region.ends.clear();
  if (region.points.count > 0) {
    if (region.met) {
      region.d = next_direction(region, inside);
    } else if (alone) {
      region.d = entry_direction(model, motion, inside, state);
    } else {
      region.d = direction_from(inside, -model.body->query(motion.pose.position_m).normal);
    }
    status |= press(model, motion, !region.met, region, state);
    region.met = true;
  }
  const SkeletonView skeleton = shapes.count > 0 ? several.ends.view(model.skeleton) : SkeletonView(model.skeleton);
  if (region.pressing()) {
    const Vec3 p0_current_m =
        shapes.count > 0
            ? Vec3(region.origin.p0_W_m + model.formulas.several.displacement_at(
                                              model.rest, *model.anchors, shapes, local,
                                              {0.0, region.origin.p0_W_m, region.origin.normal, region.origin.patch}))
            : region.origin.p0_W_m;
    model.formulas.split_force(skeleton, p0_current_m, -region.force.force_n, region.displacement_m, region.ends);
    if (region.ends.limited) status |= StepStatus::anchors_limited;
  }
  // Only earlier regions feel them.
  if (shapes.count > 0) beam_stresses(skeleton, region.ends, stress);
  RegionShape shape;
  shape.anchor_displacement_m = region.ends.displacement_m;
  shape.contact = contact_point(model, region);
  shape.p0_W_m = region.origin.p0_W_m;
  shape.size = {region.points.count, region.extent.area_m2};
  model.formulas.several.add(model.rest, local, shape, shapes);
  const bool last = static_cast<int>(shapes.count) == state.region_count;
  if (!last) several.ends.update(model.skeleton, shapes.anchor_total_m);
  state.lap(Stage::skeleton);
  return status;
}

/// F_ji on region i of every region j pressed after it, section VI-A.
void add_later_forces(const FastModel& model, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  const std::span<const int> order(several.order.data(), static_cast<std::size_t>(state.region_count));
  for (std::size_t i = 0; i < order.size(); ++i) {
    ContactRegion& region = state.regions[static_cast<std::size_t>(order[i])];
    if (!region.pressing()) continue;
    const auto patch = static_cast<std::size_t>(region.origin.patch);
    const PatchPlace place = model.anchors->at(region.origin.patch, region.origin.p0_W_m);
    Vec3 later_n = Vec3::Zero();
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const auto& stress = several.stress_pa[static_cast<std::size_t>(order[j])];
      const scene::Mat3 here_pa = interpolated_stress_pa(stress, model.anchors->patches()[patch], place);
      // The stress pushes the body against the tool, which feels the opposite of what the outside does to the body.
      later_n -= stress_force_n(here_pa, region.origin.normal, region.extent.area_m2);
    }
    region.force.force_n += later_n;
    region.force.torque_nm += region.force.load_center_m.cross(later_n);
    region.force.magnitude_n = region.force.force_n.norm();
  }
}

StepStatus press_in_order(const FastModel& model, const Motion& motion, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  StepStatus status = StepStatus::ok;
  several.shapes.clear();
  for (int i = 0; i < state.region_count; ++i) {
    const auto k = static_cast<std::size_t>(several.order[static_cast<std::size_t>(i)]);
    const bool alone = state.region_count == 1;
    status |= press_next(model, motion, alone, state.regions[k], several.stress_pa[k], state);
  }
  add_later_forces(model, state);
  several.bulge_m = 0.0;
  for (const Vec3& u_m : several.shapes.anchor_total_m) several.bulge_m = std::max(several.bulge_m, u_m.norm());
  state.lap(Stage::regions);
  return status;
}

}  // namespace

SeveralRegionsState::SeveralRegionsState(const FastModel& model)
    : scratch(*model.clusters, model.max_points()),
      tracker(model.tool.count(), clusters_per_region * model.max_regions, model.max_regions),
      clusters(clusters_per_region * capacity(model)),
      tracked(capacity(model)),
      pull_back(model.max_points()),
      ends(model.skeleton),
      shapes(model.rest, *model.anchors, model.max_regions),
      stress_pa(capacity(model), std::vector<BeamStress>(model.skeleton.anchor_m.size())),
      order(capacity(model)) {}

std::size_t SeveralRegionsState::memory_bytes() const noexcept {
  return sizeof(SeveralRegionsState) + scratch.memory_bytes() + tracker.memory_bytes() + pull_back.memory_bytes() +
         shapes.memory_bytes() + clusters.size() * sizeof(Cluster) +
         stress_pa.size() * stress_pa[0].size() * sizeof(BeamStress);
}

StepStatus press_several_regions(const FastModel& model, const Motion& motion, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  RegionPoints all = state.store.window();
  find_points(model, motion.at, several.bulge_m, all, state.cells);
  state.lap(Stage::detection);
  const ClusterCount found = cluster(*model.clusters, all, several.scratch, several.clusters);
  const Tracking tracking = several.tracker.track(all, {several.clusters.data(), static_cast<std::size_t>(found.count)},
                                                  reach_over_r_th * model.clusters->r_th_m, several.tracked);
  take_over(all, tracking.count, state);
  std::iota(several.order.begin(), several.order.end(), 0);
  state.lap(Stage::regions);
  StepStatus status = press_in_order(model, motion, state);
  if (found.dropped + tracking.dropped > 0) status |= StepStatus::regions_full;
  return status;
}

StepStatus shape_several_regions(const FastModel& model, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  model.formulas.several.interpolate(model.rest, several.shapes, state.field);
  state.lap(Stage::interpolation);
  if (model.formulas.local_factor()) {
    model.formulas.several.apply_local_factors(model.rest, model.local, several.shapes, state.field);
    state.lap(Stage::local_factor);
  }
  update_normals(model.normals, state.field);
  state.lap(Stage::normals);
  return StepStatus::ok;
}

OrderSpread order_spread(const FastModel& model, FastState& state) {
  OrderSpread spread;
  if (state.several == nullptr || state.region_count < 2) return spread;
  SeveralRegionsState& several = *state.several;
  const Vec3 total_n = total_force_n(state);
  const double size_n = total_n.norm();
  if (!(size_n > 0.0)) return spread;
  spread.equilibrium_rel = (total_n - support_force_n(state)).norm() / size_n;

  // Everything is put back afterwards.
  const std::vector<ContactRegion> regions = state.regions;
  const ShapeStack shapes = several.shapes;
  const std::vector<std::vector<BeamStress>> stress_pa = several.stress_pa;
  const Motion still{state.pose, placement(state.pose), state.pose, true};
  const auto count = static_cast<std::size_t>(state.region_count);
  // No region is new any more: directions and friction stay as they are.
  for (TrackedRegion& region : several.tracked) region.was = 0;
  const auto press_again = [&] {
    RegionPoints all = state.store.window();
    find_points(model, still.at, several.bulge_m, all, state.cells);
    cluster(*model.clusters, all, several.scratch, several.clusters);
    for (std::size_t k = 0; k < count; ++k) {
      const PointRange range = several.clusters[static_cast<std::size_t>(several.tracked[k].cluster)].points;
      state.regions[k].points = all.slice(range.begin, range.size);
    }
    press_in_order(model, still, state);
    return total_force_n(state);
  };
  const double bulge_m = several.bulge_m;
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  const std::vector<int> created = order;
  std::vector<std::vector<int>> orders;
  if (count <= 4) {
    while (std::next_permutation(order.begin(), order.end())) orders.push_back(order);
  } else {
    orders.emplace_back(created.rbegin(), created.rend());
    for (std::size_t k = 1; k < count; ++k) {
      std::rotate(order.begin(), order.begin() + 1, order.end());
      orders.push_back(order);
    }
  }
  for (const std::vector<int>& other : orders) {
    several.bulge_m = bulge_m;
    std::copy(other.begin(), other.end(), several.order.begin());
    spread.spread_rel = std::max(spread.spread_rel, (press_again() - total_n).norm() / size_n);
  }
  several.bulge_m = bulge_m;
  std::copy(created.begin(), created.end(), several.order.begin());
  std::copy(regions.begin(), regions.end(), state.regions.begin());
  several.shapes = shapes;
  several.stress_pa = stress_pa;
  return spread;
}

}  // namespace touchstone::fast
