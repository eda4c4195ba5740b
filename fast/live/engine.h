// The contact model's interface to the device loop. No other file of the loop uses the model's state.
#pragma once

#include "fast/live/device.h"
#include "fast/step/model.h"
#include "fast/step/state.h"

#include <cstdint>
#include <memory>

struct XXH3_state_s;

namespace touchstone::live {

/// The real-time model with its state. Built before the loop; the steps use no heap.
class Engine {
 public:
  /// @param scene validated; may go out of scope
  explicit Engine(const scene::Scene& scene);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// Pose in, wrench() out. A pose that is not finite leaves everything as it is and answers not_finite.
  fast::StepStatus step_force(const scene::Pose& pose) noexcept;
  /// Follows a step_force of a finite pose.
  fast::StepStatus step_shape() noexcept;

  /// Of the body on the tool.
  [[nodiscard]] Wrench wrench() const noexcept;
  [[nodiscard]] const fast::SurfaceField& field() const noexcept { return state_.field; }
  /// Time per stage of the last force and shape steps; 0 for those that did not run.
  [[nodiscard]] const fast::StageClock& stages() const noexcept { return stages_; }
  /// The farthest point of the tool from its mass centre [m].
  [[nodiscard]] double tool_reach_m() const noexcept { return tool_reach_m_; }
  /// Hash over the wrench of every step so far and the shape now: equal when a replay is. Not for the tick.
  [[nodiscard]] std::uint64_t answer_hash() const;

 private:
  struct FreeHash {
    void operator()(XXH3_state_s* hash) const noexcept;
  };
  fast::FastModel model_;
  fast::FastState state_;
  fast::StageClock stages_;
  double tool_reach_m_ = 0.0;
  std::unique_ptr<XXH3_state_s, FreeHash> hash_;
};

}  // namespace touchstone::live
