// The real-time step with all that a driver needs around it.
#pragma once

#include "fast/realtime/stage_clock.h"
#include "fast/step/model.h"
#include "fast/step/state.h"
#include "scene/base/wrench.h"
#include "scene/model/answer.h"

#include <cstdint>
#include <memory>

struct XXH3_state_s;

namespace touchstone::fast {

/// A step by the wall clock.
struct TimedStep {
  StepStatus status = StepStatus::ok;
  std::int64_t force_ns = 0;  ///< pose to force
  std::int64_t step_ns = 0;   ///< pose to shape
};

/// The model with its state: what drives the step over a track, in a benchmark or a device loop. The steps use no heap.
class Engine {
 public:
  /// @param scene validated; may go out of scope
  explicit Engine(const scene::Scene& scene);
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Pose in, wrench() out. A pose that is not finite leaves everything as it is and answers not_finite.
  StepStatus step_force(const scene::Pose& pose) noexcept;
  /// Follows a step_force of a good pose.
  StepStatus step_shape() noexcept;
  /// Both.
  StepStatus step(const scene::Pose& pose) noexcept;
  [[nodiscard]] TimedStep step_timed(const scene::Pose& pose) noexcept;

  /// Of the body on the tool.
  [[nodiscard]] scene::Wrench wrench() const noexcept;
  [[nodiscard]] const SurfaceField& field() const noexcept { return state_.field; }
  /// The answer at a track instant. The step does not compute the separation, which is zero.
  /// @param tool  pose of the last step as it was asked for; @param depth_m  scene::RestDepth there
  [[nodiscard]] scene::InstantRecord record(double time_s, const scene::Pose& tool, double depth_m) const;
  /// Hash over the wrench of every step so far and the shape now: equal when a replay is. Not for the tick.
  [[nodiscard]] std::uint64_t answer_hash() const;

  /// Whether steps take the time of their stages, which costs a reading of the clock each. At first they do not.
  void time_stages(bool on) noexcept { state_.clock = on ? &stages_ : nullptr; }
  /// Time per stage of the last force and shape steps; 0 for those that did not run.
  [[nodiscard]] const StageClock& stages() const noexcept { return stages_; }

  /// Takes over constants, see FastModel::set_constants(); the state stays as it is.
  void set_constants(const scene::Scene& scene) { model_.set_constants(scene); }
  /// Back to before the first step. @param max_regions as of FastState
  void restart(int max_regions);
  void restart() { restart(model_.max_regions); }

  [[nodiscard]] const FastModel& model() const noexcept { return model_; }
  [[nodiscard]] const FastState& state() const noexcept { return state_; }
  [[nodiscard]] FastState& state() noexcept { return state_; }
  /// The farthest point of the tool from its mass centre [m].
  [[nodiscard]] double tool_reach_m() const noexcept;
  [[nodiscard]] std::size_t memory_bytes() const noexcept { return model_.memory_bytes() + state_.memory_bytes(); }

 private:
  void add_to_hash() noexcept;

  FastModel model_;
  FastState state_;
  StageClock stages_;
  std::shared_ptr<XXH3_state_s> hash_;
};

}  // namespace touchstone::fast
