#include "fast/step/state.h"

#include "scene/base/index.h"

#include <algorithm>

namespace touchstone::fast {

using scene::Vec3;

void ContactRegion::clear() noexcept {
  active = met = created = false;
  id = 0;
  d = -Vec3::UnitZ();
  depth_rel = 0.0;
  points.count = 0;
  inside = {};
  extent = {};
  origin = {};
  force = {};
  friction = {};
  displacement_m.setZero();
  ends.clear();
}

/// More clusters than regions are distinguished before the smallest are dropped.
constexpr int clusters_per_region = 2;

SeveralRegionsState::SeveralRegionsState(const FastModel& model)
    : scratch(*model.clusters, model.max_points()),
      tracker(model.tool.count(), clusters_per_region * model.max_regions, model.max_regions),
      clusters(clusters_per_region * static_cast<std::size_t>(model.max_regions)),
      tracked(static_cast<std::size_t>(model.max_regions)),
      pull_back(model.max_points()),
      ends(model.skeleton),
      shapes(model.rest, *model.anchors, model.max_regions),
      stress_pa(static_cast<std::size_t>(model.max_regions), std::vector<BeamStress>(model.skeleton.anchor_m.size())),
      order(static_cast<std::size_t>(model.max_regions)) {}

std::size_t SeveralRegionsState::memory_bytes() const noexcept {
  return sizeof(SeveralRegionsState) + scratch.memory_bytes() + tracker.memory_bytes() + pull_back.memory_bytes() +
         shapes.memory_bytes() + clusters.size() * sizeof(Cluster) +
         stress_pa.size() * stress_pa[0].size() * sizeof(BeamStress);
}

FastState::FastState(const FastModel& model, int max_regions)
    : store(model.max_points()),
      cells(model.cell_scratch()),
      probe(model.max_points()),
      regions(static_cast<std::size_t>(max_regions), ContactRegion(model.skeleton.anchor_m.size())),
      field(model.rest),
      several(max_regions > 1 ? std::make_unique<SeveralRegionsState>(model) : nullptr) {}

bool FastState::in_contact() const noexcept {
  return std::any_of(regions.begin(), regions.begin() + region_count,
                     [](const ContactRegion& region) { return region.pressing(); });
}

std::size_t FastState::memory_bytes() const noexcept {
  return sizeof(FastState) + (several ? several->memory_bytes() : 0) + store.memory_bytes() + cells.memory_bytes() +
         probe.memory_bytes() + field.memory_bytes() +
         regions.size() * (sizeof(ContactRegion) + 2 * regions[0].ends.force_n.size() * sizeof(Vec3));
}

Vec3 total_force_n(const FastState& state) noexcept {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < state.region_count; ++i) sum += nth(state.regions, i).force.force_n;
  return sum;
}

Vec3 total_torque_nm(const FastState& state) noexcept {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < state.region_count; ++i) sum += nth(state.regions, i).force.torque_nm;
  return sum;
}

Vec3 support_force_n(const FastState& state) noexcept {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < state.region_count; ++i) sum += support_force_n(nth(state.regions, i).ends);
  return sum;
}

}  // namespace touchstone::fast
