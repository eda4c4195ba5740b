#include "fast/run/replay.h"

#include "fast/run/make_engine.h"
#include "fast/run/ticks.h"
#include "fast/step/step.h"

namespace touchstone::fast {

Replay::Replay(const scene::Scene& scene, std::size_t bytes_max)
    : engine_(make_engine(scene)),
      skeleton_(dynamic_cast<SkeletonEngine*>(engine_.get())),
      r_th_m_(scene.contact.r_th_m) {
  if (skeleton_ != nullptr) recorded_ = record_one_region(skeleton_->model(), scene, bytes_max);
  if (recorded_) skeleton_->restart(1);
}

std::vector<scene::Vec3> Replay::forces_n(const scene::Scene& scene) {
  engine_->set_constants(scene);
  std::vector<scene::Vec3> force_n;
  // The grouping of samples depends on r_th.
  if (recorded_ && scene.contact.r_th_m != r_th_m_) recorded_.reset();
  if (!recorded_) {
    engine_->restart();
    Ticks ticks(scene);
    while (const std::optional<Tick> tick = ticks.next()) {
      engine_->step_force(scene::pose_at(scene.track, tick->time_s));
      if (tick->instant >= 0) force_n.push_back(engine_->wrench().force_n);
    }
    return force_n;
  }
  FastState& state = skeleton_->state();
  state.regions[0].clear();
  regions_.clear();
  for (const RecordedTick& tick : *recorded_) {
    recall(tick, state);
    step(skeleton_->model(), tick.motion.pose, state, Parts::load);
    if (tick.instant < 0) continue;
    force_n.push_back(engine_->wrench().force_n);
    regions_.push_back(state.regions[0]);
  }
  return force_n;
}

void Replay::displacements(const scene::Scene& scene, std::span<const std::size_t> instants,
                           const std::function<void(std::size_t, const Columns3&)>& visit) {
  engine_->set_constants(scene);
  if (!recorded_) {
    engine_->restart();
    std::size_t next = 0;
    Ticks ticks(scene);
    for (std::optional<Tick> tick; next < instants.size() && (tick = ticks.next());) {
      engine_->step_force(scene::pose_at(scene.track, tick->time_s));
      if (tick->instant != static_cast<int>(instants[next])) continue;
      engine_->step_shape();
      visit(next++, engine_->field().displacement_m);
    }
    return;
  }
  FastState& state = skeleton_->state();
  state.region_count = 1;
  for (std::size_t k = 0; k < instants.size(); ++k) {
    state.regions[0] = regions_[instants[k]];
    step(skeleton_->model(), state.motion.pose, state, Parts::displace);
    visit(k, engine_->field().displacement_m);
  }
}

}  // namespace touchstone::fast
