#include "compare/model/engine_model.h"

#include "fast/command/results.h"
#include "fast/run/make_engine.h"
#include "fast/run/replay.h"
#include "fast/run/run.h"

#include <stdexcept>
#include <utility>

namespace touchstone::compare {
namespace {

class EngineModel final : public ContactModel {
 public:
  explicit EngineModel(scene::Scene scene) : scene_(std::move(scene)), engine_(fast::make_engine(scene_)) {}

  void step(const scene::Pose& pose) override { engine_->step(pose); }

  void answer(scene::Answer& asked) override {
    fast::Run run = fast::run(scene_);
    trouble_ = trouble_of(run);
    step_p50_us_ = run.step.p50_us;
    figures_ = fast::figures(run);
    auto of_run = run.instants.begin();
    for (scene::InstantRecord& instant : asked.instants) {
      while (of_run != run.instants.end() && of_run->time_s != instant.time_s) ++of_run;
      if (of_run == run.instants.end()) throw std::logic_error("the scene has no such instant");
      instant = std::move(*of_run);
    }
    asked.surface = std::move(run.surface);
  }

  [[nodiscard]] int size() const override { return engine_->surface().triangle_count(); }
  [[nodiscard]] std::optional<double> memory_bytes() const override {
    return static_cast<double>(engine_->memory_bytes());
  }
  [[nodiscard]] std::string trouble() const override { return trouble_; }
  [[nodiscard]] std::optional<double> step_p50_us() const override { return step_p50_us_; }
  [[nodiscard]] scene::Figures figures() const override { return figures_; }
  [[nodiscard]] std::optional<fast::Run> track() override { return fast::run(scene_); }

 private:
  scene::Scene scene_;
  std::unique_ptr<fast::Engine> engine_;
  std::string trouble_;
  std::optional<double> step_p50_us_;
  scene::Figures figures_;
};

class EngineReplay final : public ModelReplay {
 public:
  explicit EngineReplay(const scene::Scene& scene) : replay_(scene) {}

  std::vector<scene::Vec3> forces_n(const scene::Scene& scene) override { return replay_.forces_n(scene); }
  void displacements(const scene::Scene& scene, std::span<const std::size_t> instants, const Visit& visit) override {
    replay_.displacements(scene, instants, [&](std::size_t k, const fast::Columns3& displacement_m) {
      visit(k, fast::matrix_of(displacement_m));
    });
  }

 private:
  fast::Replay replay_;
};

}  // namespace

std::unique_ptr<ContactModel> engine_model(scene::Scene scene) {
  return std::make_unique<EngineModel>(std::move(scene));
}

std::unique_ptr<ModelReplay> engine_replay(const scene::Scene& scene) { return std::make_unique<EngineReplay>(scene); }

std::string trouble_of(const fast::Run& run) {
  return run.status == 0 ? "" : "status of its steps: " + fast::status_text(run.status);
}

}  // namespace touchstone::compare
