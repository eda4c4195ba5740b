#include "fast/step/several_regions.h"

#include "scene/base/index.h"

#include <algorithm>
#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Distance that a region's centre may move in a tick without sharing a sample with its last position, in units of
/// r_th.
constexpr double reach_over_r_th = 2.0;

int smallest_free_id(const FastState& state) noexcept {
  for (int id = 0;; ++id) {
    const bool taken = std::any_of(state.regions.begin(), state.regions.end(),
                                   [&](const ContactRegion& region) { return region.active && region.id == id; });
    if (!taken) return id;
  }
}

/// Keeps only the points inside the rest surface, in their order.
void keep_inside(RegionPoints& points) noexcept {
  int kept = 0;
  for (int i = 0; i < points.count; ++i) {
    if (!(points.depth_m[i] > 0.0)) continue;
    if (kept != i) points.move(i, kept);
    ++kept;
  }
  points.count = kept;
}

/// Updates state.regions from the tracker, each region with its points.
void take_over(const RegionPoints& all, int count, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  const int before = state.region_count;
  for (int k = 0; k < before; ++k) {
    const bool goes_on = std::any_of(several.tracked.begin(), several.tracked.begin() + count,
                                     [&](const TrackedRegion& region) { return region.was == k; });
    if (!goes_on) nth(state.regions, k).clear();
  }
  for (int k = 0; k < count; ++k) {
    const TrackedRegion& tracked = nth(several.tracked, k);
    ContactRegion& region = nth(state.regions, k);
    // Continued regions keep their order, so `was` is never before k.
    if (!tracked.created() && tracked.was != k) std::swap(region, nth(state.regions, tracked.was));
    if (tracked.created()) {
      region.clear();
      region.id = smallest_free_id(state);
      region.active = true;
    }
    const PointRange range = nth(several.clusters, tracked.cluster).points;
    region.points = all.slice(range.begin, range.size);
  }
  state.region_count = count;
}

/// The surface displaced by the regions in the stack.
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

/// Null if the scene has no local factor.
const LocalConstants* local_constants(const FastModel& model) noexcept {
  return model.formulas.local_factor() ? &model.local : nullptr;
}

/// An origin of deformation, displaced by the regions in the stack.
Vec3 displaced(const FastModel& model, const DeformationOrigin& origin, const ShapeStack& shapes) noexcept {
  if (shapes.count() == 0) return origin.p0_W_m;
  return origin.p0_W_m + model.formulas.several.displacement_at(model.rest, *model.anchors, shapes,
                                                                local_constants(model),
                                                                {0.0, origin.p0_W_m, origin.normal, origin.patch});
}

}  // namespace

StepStatus track_regions(const FastModel& model, RegionPoints& points, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  const ClusterCount found = cluster(*model.clusters, points, several.scratch, several.clusters);
  const Tracking tracking =
      several.tracker.track(points, {several.clusters.data(), static_cast<std::size_t>(found.count)},
                            reach_over_r_th * model.clusters->r_th_m, several.tracked);
  take_over(points, tracking.count, state);
  std::iota(several.order.begin(), several.order.end(), 0);
  state.lap(Stage::regions);
  return found.dropped + tracking.dropped > 0 ? StepStatus::regions_full : StepStatus::ok;
}

void meet_deformed_body(const FastModel& model, ContactRegion& region, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  if (several.shapes.count() > 0) {
    const StackedSurface surface(model, local_constants(model), several.shapes);
    region.inside = model.detection.pull_back(*model.body, surface, region.points, several.pull_back);
  } else {
    keep_inside(region.points);
    region.inside = model.detection.summarise(*model.body, region.points);
  }
  region.ends.clear();
  state.lap(Stage::regions);
}

StepStatus deform_body(const FastModel& model, std::size_t k, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  ContactRegion& region = state.regions[k];
  ShapeStack& shapes = several.shapes;
  const bool first = shapes.count() == 0;
  const SkeletonView skeleton = first ? SkeletonView(model.skeleton) : several.ends.view(model.skeleton);
  StepStatus status = StepStatus::ok;
  if (region.pressing()) status = load_beams(model, skeleton, displaced(model, region.origin, shapes), region);
  // Only earlier regions are affected by them.
  if (!first) beam_stresses(skeleton, region.ends, several.stress_pa[k]);
  RegionShape shape;
  shape.anchor_displacement_m = region.ends.displacement_m;
  shape.contact = contact_point(model, region);
  shape.p0_W_m = region.origin.p0_W_m;
  shape.size = {region.points.count, region.extent.area_m2};
  model.formulas.several.add(model.rest, local_constants(model), shape, shapes);
  const bool last = static_cast<int>(shapes.count()) == state.region_count;
  if (!last) several.ends.update(model.skeleton, shapes.anchor_total_m);
  state.lap(Stage::skeleton);
  return status;
}

void add_later_forces(const FastModel& model, FastState& state) noexcept {
  SeveralRegionsState& several = *state.several;
  const std::span<const int> order(several.order.data(), static_cast<std::size_t>(state.region_count));
  for (std::size_t i = 0; i < order.size(); ++i) {
    ContactRegion& region = nth(state.regions, order[i]);
    if (!region.pressing()) continue;
    const auto patch = static_cast<std::size_t>(region.origin.patch);
    const PatchPlace place = model.anchors->at(region.origin.patch, region.origin.p0_W_m);
    Vec3 later_n = Vec3::Zero();
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const auto& stress = nth(several.stress_pa, order[j]);
      const scene::Mat3 here_pa = interpolated_stress_pa(stress, model.anchors->patches()[patch], place);
      // The stress acts from the body on the tool: the reaction to the outside's traction on the body.
      later_n -= stress_force_n(here_pa, region.origin.normal, region.extent.area_m2);
    }
    region.force.force_n += later_n;
    region.force.torque_nm += region.force.load_center_m.cross(later_n);
    region.force.magnitude_n = region.force.force_n.norm();
  }
  several.bulge_m = 0.0;
  for (const Vec3& u_m : several.shapes.anchor_total_m) several.bulge_m = std::max(several.bulge_m, u_m.norm());
  state.lap(Stage::regions);
}

}  // namespace touchstone::fast
