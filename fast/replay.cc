#include "fast/replay.h"

#include "fast/step.h"

namespace touchstone::fast {

Replay::Replay(const scene::Scene& scene) : model_(scene), ticks_(ticks_of(scene)) {
  for (const Tick& tick : ticks_) poses_.push_back(scene::pose_at(scene.track, tick.time_s));
}

std::vector<scene::Vec3> Replay::forces_n(const scene::Scene& scene) {
  model_.set_constants(scene);
  FastState state(model_);
  std::vector<scene::Vec3> force_n;
  regions_.clear();
  for (std::size_t k = 0; k < ticks_.size(); ++k) {
    const StepStatus status = step_force(model_, poses_[k], state);
    // Several regions meet the surface that the others have left; one never meets its own.
    if (model_.max_regions > 1 && status != StepStatus::not_finite) step_shape(model_, state);
    if (ticks_[k].instant < 0) continue;
    force_n.push_back(total_force_n(state));
    if (model_.max_regions == 1) regions_.push_back(state.regions[0]);
  }
  return force_n;
}

std::vector<Eigen::Matrix3Xd> Replay::displacements_m(const scene::Scene& scene) {
  model_.set_constants(scene);
  FastState state(model_);
  std::vector<Eigen::Matrix3Xd> displacement_m;
  if (model_.max_regions == 1) {
    for (const ContactRegion& region : regions_) {
      state.regions[0] = region;
      state.region_count = region.active ? 1 : 0;
      step_shape(model_, state);
      displacement_m.push_back(matrix_of(state.field.displacement_m));
    }
    return displacement_m;
  }
  for (std::size_t k = 0; k < ticks_.size(); ++k) {
    if (step_force(model_, poses_[k], state) != StepStatus::not_finite) step_shape(model_, state);
    if (ticks_[k].instant >= 0) displacement_m.push_back(matrix_of(state.field.displacement_m));
  }
  return displacement_m;
}

}  // namespace touchstone::fast
