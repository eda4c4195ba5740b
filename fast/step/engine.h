// A contact model that is driven step by step: over a track, in a benchmark, in the device loop.
#pragma once

#include "fast/realtime/stage_clock.h"
#include "fast/step/status.h"
#include "fast/surface/surface_patches.h"
#include "scene/base/wrench.h"
#include "scene/model/answer.h"
#include "scene/model/scene.h"
#include "scene/shape/surface.h"

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

/// A model with its state and all that a driver needs around a step. The steps use no heap.
class Engine {
 public:
  Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  /// Takes over the constants that tuning may change; the state stays as it is.
  virtual void set_constants(const scene::Scene& scene) = 0;
  /// Back to before the first step.
  virtual void restart() = 0;

  /// Pose in, wrench() out. A pose that is not finite leaves everything as it is and answers not_finite.
  StepStatus step_force(const scene::Pose& pose) noexcept;
  /// Follows a step_force of a good pose.
  StepStatus step_shape() noexcept;
  /// Both.
  StepStatus step(const scene::Pose& pose) noexcept;
  [[nodiscard]] TimedStep step_timed(const scene::Pose& pose) noexcept;

  /// Of the body on the tool.
  [[nodiscard]] virtual scene::Wrench wrench() const noexcept = 0;
  /// The tool pushes on the body.
  [[nodiscard]] virtual bool in_contact() const noexcept = 0;
  [[nodiscard]] virtual int region_count() const noexcept = 0;
  [[nodiscard]] virtual const SurfaceField& field() const noexcept = 0;
  /// The answer at a track instant. The step does not compute the separation, which is zero.
  /// @param tool  pose of the last step as it was asked for; @param depth_m  scene::RestDepth there
  [[nodiscard]] virtual scene::InstantRecord record(double time_s, const scene::Pose& tool, double depth_m) const = 0;
  /// Hash over the wrench of every step so far and the shape now: equal when a replay is. Not for the tick.
  [[nodiscard]] std::uint64_t answer_hash() const;

  /// Whether steps take the time of their stages, which costs a reading of the clock each. At first they do not.
  void time_stages(bool on) noexcept { timed_ = on; }
  /// Time per stage of the last force and shape steps; 0 for those that did not run.
  [[nodiscard]] const StageClock& stages() const noexcept { return stages_; }

  [[nodiscard]] virtual const scene::Shape& body() const noexcept = 0;
  [[nodiscard]] virtual const scene::Surface& surface() const noexcept = 0;  ///< at rest
  /// The farthest point of the tool from its mass centre [m].
  [[nodiscard]] virtual double tool_reach_m() const noexcept = 0;
  [[nodiscard]] virtual std::size_t memory_bytes() const noexcept = 0;

 protected:
  virtual StepStatus force(const scene::Pose& pose) noexcept = 0;
  virtual StepStatus shape() noexcept = 0;
  /// Of the stages, null where their time is not taken.
  [[nodiscard]] StageClock* clock() noexcept { return timed_ ? &stages_ : nullptr; }
  void restart_hash() noexcept;

 private:
  void add_to_hash() noexcept;

  StageClock stages_;
  bool timed_ = false;
  std::shared_ptr<XXH3_state_s> hash_;
};

}  // namespace touchstone::fast
