#include "fast/run/replay.h"

#include "fast/realtime/flush_tiny_numbers.h"
#include "fast/step/step.h"

namespace touchstone::fast {

Replay::Replay(const scene::Scene& scene, std::size_t bytes_max)
    : model_(scene),
      state_(model_),
      r_th_m_(scene.fast.r_th_m),
      recorded_(record_one_region(model_, scene, bytes_max)) {}

std::vector<scene::Vec3> Replay::forces_n(const scene::Scene& scene) {
  model_.set_constants(scene);
  std::vector<scene::Vec3> force_n;
  // Which samples belong together hangs on r_th.
  if (recorded_ && scene.fast.r_th_m != r_th_m_) recorded_.reset();
  if (!recorded_) {
    FastState state(model_);
    Ticks ticks(scene);
    while (const std::optional<Tick> tick = ticks.next()) {
      step_force(model_, scene::pose_at(scene.track, tick->time_s), state);
      if (tick->instant >= 0) force_n.push_back(total_force_n(state));
    }
    return force_n;
  }
  state_.regions[0].clear();
  regions_.clear();
  for (const RecordedTick& tick : *recorded_) {
    recall(tick, state_);
    ContactRegion& region = state_.regions[0];
    if (tick.in_region) push(model_, tick.motion, tick.created, region, state_);
    if (tick.instant < 0) continue;
    force_n.push_back(total_force_n(state_));
    regions_.push_back(region);
  }
  return force_n;
}

void Replay::displacements(const scene::Scene& scene, std::span<const std::size_t> instants,
                           const std::function<void(std::size_t, const Columns3&)>& visit) {
  model_.set_constants(scene);
  if (!recorded_) {
    FastState state(model_);
    std::size_t next = 0;
    Ticks ticks(scene);
    for (std::optional<Tick> tick; next < instants.size() && (tick = ticks.next());) {
      step_force(model_, scene::pose_at(scene.track, tick->time_s), state);
      if (tick->instant != static_cast<int>(instants[next])) continue;
      step_shape(model_, state);
      visit(next++, state.field.displacement_m);
    }
    return;
  }
  for (std::size_t k = 0; k < instants.size(); ++k) {
    state_.regions[0] = regions_[instants[k]];
    if (state_.regions[0].pressing()) {
      const FlushTinyNumbers flush;
      displace(model_, state_);
    } else {
      state_.field.reset(model_.rest);
    }
    visit(k, state_.field.displacement_m);
  }
}

}  // namespace touchstone::fast
