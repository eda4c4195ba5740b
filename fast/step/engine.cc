#include "fast/step/engine.h"

#include <xxhash.h>

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

Engine::Engine() : hash_(new_hash()) {}

StepStatus Engine::step_force(const scene::Pose& pose) noexcept {
  if (timed_) stages_.start();
  const StepStatus status = force(pose);
  add_to_hash();
  return status;
}

StepStatus Engine::step_shape() noexcept {
  if (timed_) stages_.resume();
  return shape();
}

StepStatus Engine::step(const scene::Pose& pose) noexcept {
  const StepStatus status = step_force(pose);
  return status == StepStatus::not_finite ? status : status | step_shape();
}

TimedStep Engine::step_timed(const scene::Pose& pose) noexcept {
  const Clock::time_point begin = Clock::now();
  if (timed_) stages_.start();
  StepStatus status = force(pose);
  const Clock::time_point published = Clock::now();
  if (status != StepStatus::not_finite) status |= shape();
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

std::uint64_t Engine::answer_hash() const {
  const std::shared_ptr<XXH3_state_t> copy = new_hash();
  XXH3_copyState(copy.get(), hash_.get());
  for (const Columns3* columns : {&field().displacement_m, &field().normal}) {
    for (const auto& column : *columns) XXH3_64bits_update(copy.get(), column.data(), column.size() * sizeof(float));
  }
  return XXH3_64bits_digest(copy.get());
}

void Engine::restart_hash() noexcept { XXH3_64bits_reset(hash_.get()); }

}  // namespace touchstone::fast
