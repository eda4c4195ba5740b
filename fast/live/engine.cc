#include "fast/live/engine.h"

#include "fast/step/step.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <new>

namespace touchstone::live {

void Engine::FreeHash::operator()(XXH3_state_s* hash) const noexcept { XXH3_freeState(hash); }

Engine::Engine(const scene::Scene& scene) : model_(scene), state_(model_), hash_(XXH3_createState()) {
  if (!hash_) throw std::bad_alloc();
  XXH3_64bits_reset(hash_.get());
  state_.clock = &stages_;
  const fast::ToolSamples& tool = model_.tool;
  for (std::size_t i = 0; i < tool.x_T_m.size(); ++i) {
    tool_reach_m_ = std::max(tool_reach_m_, scene::Vec3(tool.x_T_m[i], tool.y_T_m[i], tool.z_T_m[i]).norm());
  }
}

Engine::~Engine() = default;

fast::StepStatus Engine::step_force(const scene::Pose& pose) noexcept {
  stages_.start();
  const fast::StepStatus status = fast::step_force(model_, pose, state_);
  const Wrench w = wrench();
  const std::array<double, 6> numbers{w.force_n.x(),   w.force_n.y(),   w.force_n.z(),
                                      w.torque_nm.x(), w.torque_nm.y(), w.torque_nm.z()};
  XXH3_64bits_update(hash_.get(), numbers.data(), sizeof numbers);
  return status;
}

fast::StepStatus Engine::step_shape() noexcept {
  stages_.resume();
  return fast::step_shape(model_, state_);
}

Wrench Engine::wrench() const noexcept { return {fast::total_force_n(state_), fast::total_torque_nm(state_)}; }

std::uint64_t Engine::answer_hash() const {
  const std::unique_ptr<XXH3_state_s, FreeHash> copy(XXH3_createState());
  if (!copy) throw std::bad_alloc();
  XXH3_copyState(copy.get(), hash_.get());
  for (const fast::Columns3* columns : {&state_.field.displacement_m, &state_.field.normal}) {
    for (const auto& column : *columns) XXH3_64bits_update(copy.get(), column.data(), column.size() * sizeof(float));
  }
  return XXH3_64bits_digest(copy.get());
}

}  // namespace touchstone::live
