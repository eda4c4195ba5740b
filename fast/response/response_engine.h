// The response model as an engine.
#pragma once

#include "fast/response/response_model.h"
#include "fast/step/engine.h"

#include <algorithm>
#include <span>

namespace touchstone::fast {

/// Reads the response's file in the scene's store. @throws scene::InputError where it is not there, or not as it should
/// be, with the command that writes it
[[nodiscard]] scene::Response stored_response(const scene::Scene& scene, const scene::Surface& surface);

class ResponseEngine final : public Engine {
 public:
  /// @param scene  validated, one of which scene::response_needs() nothing; may go out of scope
  ResponseEngine(const scene::Scene& scene, scene::Surface surface, scene::Response response);

  void set_constants(const scene::Scene& scene) override { model_.falloff_per_m = scene.fast.body_falloff_per_m; }
  void restart() override;
  [[nodiscard]] scene::Wrench wrench() const noexcept override { return state_.wrench; }
  [[nodiscard]] bool in_contact() const noexcept override { return region_count() > 0; }
  [[nodiscard]] int region_count() const noexcept override {
    return static_cast<int>(std::ranges::count_if(state_.contacts, &ResponseContact::touches));
  }
  [[nodiscard]] const SurfaceField& field() const noexcept override { return state_.field; }
  /// With the traction on the deformed surface: the loads' pressure, along the tool's normal. A region's
  /// number is its tip's.
  [[nodiscard]] scene::InstantRecord record(double time_s, const scene::Pose& tool, double depth_m) const override;
  [[nodiscard]] const scene::Shape& body() const noexcept override { return *model_.body; }
  [[nodiscard]] const scene::Surface& surface() const noexcept override { return model_.surface; }
  [[nodiscard]] double tool_reach_m() const noexcept override { return tool_reach_m_; }
  [[nodiscard]] std::size_t memory_bytes() const noexcept override {
    return model_.memory_bytes() + state_.memory_bytes();
  }

  [[nodiscard]] const ResponseModel& model() const noexcept { return model_; }
  /// Of the tips.
  [[nodiscard]] std::span<const ResponseContact> contacts() const noexcept { return state_.contacts; }

 private:
  StepStatus force(const scene::Pose& pose) noexcept override;
  StepStatus shape() noexcept override;

  ResponseModel model_;
  ResponseState state_;
  double tool_reach_m_;
};

}  // namespace touchstone::fast
