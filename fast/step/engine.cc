#include "fast/step/engine.h"

#include "fast/step/step.h"
#include "scene/base/index.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <new>

namespace touchstone::fast {
namespace {

using Clock = std::chrono::steady_clock;

std::int64_t nanoseconds(Clock::duration duration) noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(duration).count();
}

std::shared_ptr<XXH3_state_t> new_hash() {
  std::shared_ptr<XXH3_state_t> hash(XXH3_createState(), XXH3_freeState);
  if (!hash) throw std::bad_alloc();
  XXH3_64bits_reset(hash.get());
  return hash;
}

}  // namespace

Engine::Engine(const scene::Scene& scene) : model_(scene), state_(model_), hash_(new_hash()) {}

StepStatus Engine::step_force(const scene::Pose& pose) noexcept {
  if (state_.clock != nullptr) stages_.start();
  const StepStatus status = fast::step_force(model_, pose, state_);
  add_to_hash();
  return status;
}

StepStatus Engine::step_shape() noexcept {
  if (state_.clock != nullptr) stages_.resume();
  return fast::step_shape(model_, state_);
}

StepStatus Engine::step(const scene::Pose& pose) noexcept {
  const StepStatus force = step_force(pose);
  return force == StepStatus::not_finite ? force : force | step_shape();
}

TimedStep Engine::step_timed(const scene::Pose& pose) noexcept {
  const Clock::time_point begin = Clock::now();
  if (state_.clock != nullptr) stages_.start();
  StepStatus status = fast::step_force(model_, pose, state_);
  const Clock::time_point published = Clock::now();
  if (status != StepStatus::not_finite) status |= fast::step_shape(model_, state_);
  const Clock::time_point end = Clock::now();
  add_to_hash();
  return {status, nanoseconds(published - begin), nanoseconds(end - begin)};
}

void Engine::add_to_hash() noexcept {
  const scene::Wrench w = wrench();
  const std::array<double, 6> numbers{w.force_n.x(),   w.force_n.y(),   w.force_n.z(),
                                      w.torque_nm.x(), w.torque_nm.y(), w.torque_nm.z()};
  XXH3_64bits_update(hash_.get(), numbers.data(), sizeof numbers);
}

scene::Wrench Engine::wrench() const noexcept { return {total_force_n(state_), total_torque_nm(state_)}; }

std::uint64_t Engine::answer_hash() const {
  const std::shared_ptr<XXH3_state_t> copy = new_hash();
  XXH3_copyState(copy.get(), hash_.get());
  for (const Columns3* columns : {&state_.field.displacement_m, &state_.field.normal}) {
    for (const auto& column : *columns) XXH3_64bits_update(copy.get(), column.data(), column.size() * sizeof(float));
  }
  return XXH3_64bits_digest(copy.get());
}

scene::InstantRecord Engine::record(double time_s, const scene::Pose& tool, double depth_m) const {
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

void Engine::restart(int max_regions) {
  StageClock* const clock = state_.clock;
  state_ = FastState(model_, max_regions);
  state_.clock = clock;
  XXH3_64bits_reset(hash_.get());
}

double Engine::tool_reach_m() const noexcept {
  const ToolSamples& tool = model_.tool;
  double reach_m = 0.0;
  for (std::size_t i = 0; i < tool.x_T_m.size(); ++i)
    reach_m = std::max(reach_m, scene::Vec3(tool.x_T_m[i], tool.y_T_m[i], tool.z_T_m[i]).norm());
  return reach_m;
}

}  // namespace touchstone::fast
