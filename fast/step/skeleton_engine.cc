#include "fast/step/skeleton_engine.h"

#include "fast/step/cell_rule.h"
#include "fast/step/step.h"
#include "scene/base/index.h"

#include <algorithm>

namespace touchstone::fast {

SkeletonEngine::SkeletonEngine(const scene::Scene& scene) : model_(model_of(scene)), state_(model_) {}

StepStatus SkeletonEngine::force(const scene::Pose& pose) noexcept {
  state_.clock = clock();
  return fast::step_force(model_, pose, state_);
}

StepStatus SkeletonEngine::shape() noexcept {
  state_.clock = clock();
  return fast::step_shape(model_, state_);
}

scene::Wrench SkeletonEngine::wrench() const noexcept { return {total_force_n(state_), total_torque_nm(state_)}; }

scene::InstantRecord SkeletonEngine::record(double time_s, const scene::Pose& tool, double depth_m) const {
  scene::InstantRecord record;
  record.time_s = time_s;
  record.tool = tool;
  record.depth_m = depth_m;
  record.displacement_m = matrix_of(state_.field.displacement_m);
  record.support_force_n = support_force_n(state_);
  for (int i = 0; i < state_.region_count; ++i) {
    const ContactRegion& region = nth(state_.regions, i);
    if (!region.pressing()) continue;
    record.regions.push_back({.depth_m = model_.max_regions == 1 ? depth_m : region.extent.deepest_m,
                              .force_n = region.force.force_n,
                              .torque_nm = region.force.torque_nm,
                              .area_m2 = region.extent.area_m2,
                              .id = region.id,
                              .friction_n = region.force.tangential_n,
                              .sliding = region.friction.sliding});
  }
  return record;
}

double SkeletonEngine::tool_reach_m() const noexcept {
  const ToolSamples& tool = model_.tool;
  double reach_m = 0.0;
  for (std::size_t i = 0; i < tool.x_T_m.size(); ++i)
    reach_m = std::max(reach_m, scene::Vec3(tool.x_T_m[i], tool.y_T_m[i], tool.z_T_m[i]).norm());
  return reach_m;
}

void SkeletonEngine::set_constants(const scene::Scene& scene) {
  const bool other_regions = model_.clusters && model_.clusters->r_th_m != scene.contact.r_th_m;
  model_.set_constants(scene);
  if (!other_regions || !model_.cells) return;
  model_.cells = choose_cells(scene.track, model_);
  restart();
}

void SkeletonEngine::restart(int max_regions) {
  state_ = FastState(model_, max_regions);
  restart_hash();
}

}  // namespace touchstone::fast
