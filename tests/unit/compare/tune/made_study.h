// Small studies whose reference was computed by a model with known constants.
#pragma once

#include "compare/model/judge.h"
#include "compare/tune/tune.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::compare::testing {

[[nodiscard]] inline scene::Scene small(const std::vector<std::string>& more = {}) {
  std::vector<std::string> settings = {"compare.instants=9", "fast.triangles=400", "fast.rate_hz=200.0",
                                       "contact.k1_n_per_m=20000.0"};
  settings.insert(settings.end(), more.begin(), more.end());
  return scene::load_scene(source_folder() + "/meshes/scenes/sphere-on-sphere-body.toml", settings);
}

/// Results of a model with these constants, as a reference with a small uncertainty.
[[nodiscard]] inline SolveReference made_with(
    const std::map<std::string, double>& constants,
    const ModelOf& model_of = [](const scene::Scene& scene) { return fast_model(scene); }) {
  return [constants, model_of](const scene::Scene& asked, const scene::Surface& surface) {
    scene::Scene scene = asked;
    for (const auto& [key, value] : constants) set_parameter(scene, key, value);
    scene::Answer answer = unanswered(scene);
    model_of(scene).set_up(scene)->answer(answer);
    reference::Result result;
    result.levels.push_back({});
    for (const scene::InstantRecord& record : answer.instants) {
      result.levels[0].force_n.push_back(record.force_n().norm());
      scene::ReferenceInstant& instant = result.instants.emplace_back();
      static_cast<scene::InstantRecord&>(instant) = record;
      if (!record.regions.empty()) instant.region_middles_m = {scene::Vec3(0.0, 0.0, 0.06)};
      instant.displacement_uncertainty_m.setConstant(surface.points_m.cols(), 1e-6);
      instant.traction_uncertainty_pa.setZero(record.traction_pa.cols());
      instant.force_uncertainty_n = 0.01;
    }
    result.shape_uncertainty_rel = 1e-4;
    result.model = "made by a model";
    return result;
  };
}

[[nodiscard]] inline TuningParameter free(const std::string& key, double low, double high,
                                          TuningStage stage = TuningStage::force) {
  return {key, "", stage, low, high, std::sqrt(low * high), true, false};
}

[[nodiscard]] inline TuningStudy study(std::vector<TuningParameter> parameters) {
  TuningStudy out;
  out.name = "made";
  out.formulations = {scene::Formulation::corrected};
  out.laws = {scene::ContactLaw::duffing};
  out.starts = 2;
  out.shape_floor = 1e-4;
  out.training = {{"pole", "", small(), {0.0, 0.003}}};
  out.held_out = {{"deeper", "depth", small(), {0.003, 1.0}},
                  {"Larger ball", "tool", small({"tool.radius_m=0.0104"}), {0.0, 1.0}}};
  out.parameters = std::move(parameters);
  return out;
}

[[nodiscard]] inline const Determination& found(const TunedModel& model, const std::string& key) {
  for (const StageFit& stage : model.stages) {
    for (std::size_t k = 0; k < stage.parameters.size(); ++k) {
      if (stage.parameters[k].key == key) return stage.fit.parameters[k];
    }
  }
  throw std::out_of_range(key);
}

}  // namespace touchstone::compare::testing
