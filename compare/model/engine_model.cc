#include "compare/model/engine_model.h"

#include "fast/command/results.h"
#include "fast/command/stop_signals.h"
#include "fast/run/make_engine.h"
#include "fast/run/run.h"
#include "reference/run/cost.h"
#include "reference/run/options.h"
#include "scene/base/error.h"
#include "scene/base/stopwatch.h"

#include <fmt/format.h>

#include <optional>
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

}  // namespace

reference::Prepared prepare(const scene::Scene& scene, const std::filesystem::path& store,
                            const std::function<void(const std::string&, bool)>& show) {
  using Next = reference::SmoothProgress::Next;
  // Before its first column a computation cannot be stopped and has nothing to keep.
  std::optional<fast::EndSignals> ends(
      "interrupted; no new column of the body's response was finished, so the next run begins where this one did");
  std::optional<fast::StopSignals> stops;
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  scene::Stopwatch watch;
  Eigen::Index first = 0;  // column of this run
  const auto progress = [&](const reference::SmoothProgress& now) {
    const Eigen::Index done = now.first.done, all = now.first.response.own_m_per_n.cols();
    if (stops && fast::StopSignals::asked()) {
      throw reference::Interrupted(fmt::format(
          "interrupted; {} of {} columns of the body's response are kept, and the next run goes on from there", done,
          all));
    }
    if (now.next == Next::mesh) {
      show("the body's response, computed once: mesh", true);
    } else if (now.next == Next::matrix) {
      first = done + 1;
      const int unknowns = now.first.response.unknowns;
      const reference::Cost cost = reference::expected_cost({.unknowns = 1.0 * unknowns, .load_steps = 1}, 1);
      show(fmt::format("the body's response: factorisation of {} unknowns, about {} on an idle machine; then {}{} "
                       "columns",
                       unknowns, reference::duration_text(cost.seconds / cost.newton_iterations),
                       done > 0 ? fmt::format("{} of ", all - done) : "", all),
           true);
    } else if (done == first) {
      // Its time is also that of the factorisation.
      watch = {};
      ends.reset();
      stops.emplace(fast::StopSignals::Again::end_at_once);
    } else if (done < all) {
      const double left_s = watch.wall_s() * static_cast<double>(all - done) / static_cast<double>(done - first);
      show(fmt::format("the body's response: {} of {} columns, about {} left", done, all,
                       reference::duration_text(left_s)),
           done == first + 1);
    }
  };
  return reference::prepare_response(scene, surface, store, progress);
}

void prepare_missing(const scene::Scene& scene, const std::function<void(const std::string&)>& say) {
  if (scene.fast.formulation != scene::Formulation::response) return;
  const reference::Prepared prepared = prepare(scene, scene.fast.store, [&](const std::string& line, bool marked) {
    if (say && marked) say(line);
  });
  if (prepared.computed && say) {
    say(fmt::format("the body's response: {} columns in {:.3g} s: {}", prepared.response.own_m_per_n.cols(),
                    prepared.seconds, prepared.file.string()));
  }
}

std::unique_ptr<ContactModel> engine_model(scene::Scene scene, const std::function<void(const std::string&)>& say) {
  try {
    prepare_missing(scene, say);
  } catch (const scene::InputError& error) {
    throw Unavailable(error.what());
  }
  return std::make_unique<EngineModel>(std::move(scene));
}

std::string trouble_of(const fast::Run& run) {
  return run.status == 0 ? "" : "status of its steps: " + fast::status_text(run.status);
}

}  // namespace touchstone::compare
