// The paper's beam skeleton as an engine.
#pragma once

#include "fast/step/engine.h"
#include "fast/step/model.h"
#include "fast/step/state.h"

namespace touchstone::fast {

class SkeletonEngine final : public Engine {
 public:
  /// @param scene validated; may go out of scope
  explicit SkeletonEngine(const scene::Scene& scene);

  [[nodiscard]] scene::Wrench wrench() const noexcept override;
  [[nodiscard]] bool in_contact() const noexcept override { return state_.in_contact(); }
  [[nodiscard]] int region_count() const noexcept override { return state_.region_count; }
  [[nodiscard]] const SurfaceField& field() const noexcept override { return state_.field; }
  [[nodiscard]] scene::InstantRecord record(double time_s, const scene::Pose& tool, double depth_m) const override;
  [[nodiscard]] const scene::Shape& body() const noexcept override { return *model_.body; }
  [[nodiscard]] const scene::Surface& surface() const noexcept override { return model_.surface; }
  [[nodiscard]] double tool_reach_m() const noexcept override;
  [[nodiscard]] std::size_t memory_bytes() const noexcept override {
    return model_.memory_bytes() + state_.memory_bytes();
  }

  /// Takes over constants, see FastModel::set_constants(); the state stays as it is. With another distance between
  /// regions the cells are chosen anew, and the engine begins anew.
  void set_constants(const scene::Scene& scene) override;
  /// @param max_regions as of FastState
  void restart(int max_regions);
  void restart() override { restart(model_.max_regions); }

  [[nodiscard]] const FastModel& model() const noexcept { return model_; }
  [[nodiscard]] const FastState& state() const noexcept { return state_; }
  [[nodiscard]] FastState& state() noexcept { return state_; }

 private:
  StepStatus force(const scene::Pose& pose) noexcept override;
  StepStatus shape() noexcept override;

  FastModel model_;
  FastState state_;
};

}  // namespace touchstone::fast
