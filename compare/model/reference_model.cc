#include "compare/model/reference_model.h"

#include "reference/run/cost.h"
#include "reference/run/model_choice.h"
#include "reference/run/uncertainty.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace touchstone::compare {
namespace {

class ReferenceModel final : public ContactModel {
 public:
  ReferenceModel(reference::Result result, int dim) : result_(std::move(result)), dim_(dim) {}

  void step(const scene::Pose&) override { throw std::logic_error("the reference solves whole tracks"); }

  void answer(scene::Answer& asked) override {
    steps_ = {};
    for (const reference::LevelRecord& level : result_.levels) steps_.total_s += level.wall_s;
    auto solved = result_.instants.begin();
    for (scene::InstantRecord& instant : asked.instants) {
      while (solved != result_.instants.end() && solved->time_s != instant.time_s) ++solved;
      if (solved == result_.instants.end()) throw std::logic_error("the reference has no such instant");
      instant = *solved;
      steps_.count += instant.depth_m > reference::grazing_depth_m ? 1 : 0;
    }
  }

  [[nodiscard]] int size() const override { return result_.levels.back().unknowns; }
  [[nodiscard]] std::optional<double> memory_bytes() const override {
    return reference::expected_memory_bytes(dim_, size());
  }
  [[nodiscard]] std::optional<KnownSteps> known_steps() const override { return steps_; }
  [[nodiscard]] std::string note() const override {
    return "mean wall time of an instant, the coarser meshes it starts from included, when it was solved; memory as "
           "predicted";
  }

 private:
  reference::Result result_;
  int dim_;
  KnownSteps steps_;
};

}  // namespace

std::vector<ModelEntry> reference_models(const ModelRequest& request) {
  std::vector<ModelEntry> models;
  const int levels = request.reference_levels ? request.reference_levels() : 0;
  for (int level = 1; level <= levels; ++level) {
    models.push_back({.name = fmt::format("reference, {} mesh{}", level, level == 1 ? "" : "es"),
                      .key = fmt::format("reference-{}", level),
                      .label = fmt::format("reference {}", level),
                      .family = ModelFamily::reference,
                      .set_up =
                          [level, solve = request.solve](const scene::Scene& scene) {
                            const scene::Surface surface =
                                scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
                            return std::make_unique<ReferenceModel>(solve(scene, surface, level),
                                                                    reference::choose_model(scene).dim);
                          },
                      .finest_reference = level == levels});
  }
  return models;
}

}  // namespace touchstone::compare
