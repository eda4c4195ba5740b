#include "compare/tune/tune.h"

#include "compare/tune/findings.h"
#include "compare/tune/outcome.h"
#include "compare/tune/training.h"

#include <fmt/format.h>

#include <algorithm>

namespace touchstone::compare {
namespace {

double deepest_m(const TuningData& data) {
  double deepest = 0.0;
  for (const scene::InstantRecord& record : data.result.instants) deepest = std::max(deepest, record.depth_m);
  return deepest;
}

}  // namespace

Tuning tune(const TuningStudy& study, const SolveReference& solve, const Say& say, const ModelOf& model_of) {
  const auto tell = [&](const std::string& line) {
    if (say) say(line);
  };
  Tuning tuning{study, {}, {}};
  double deepest = 0.0;
  for (const auto* list : {&study.training, &study.held_out}) {
    for (const TuningContact& contact : *list) {
      tell("reference of \"" + contact.name + "\"");
      tuning.data.push_back(tuning_data(contact, solve));
      deepest = std::max(deepest, deepest_m(tuning.data.back()));
    }
  }
  for (const scene::Formulation formulation : study.formulations) {
    for (const scene::ContactLaw law : study.laws) {
      TunedModel model;
      model.formulation = formulation;
      model.law = law;
      model.entry = model_of(tuned_scene(study.training.front().scene, model));
      // A model without a law of this kind is tuned once.
      const auto same = [&](const TunedModel& other) { return other.entry.key == model.entry.key; };
      if (std::ranges::any_of(tuning.models, same)) continue;
      for (const TuningStage stage : {TuningStage::force, TuningStage::shape}) {
        tell(fmt::format("{}: fitting the {}", model.name(), stage == TuningStage::force ? "force" : "shape"));
        StageFit fitted = fit_stage(tuning, model, stage, deepest);
        if (!fitted.parameters.empty()) model.stages.push_back(std::move(fitted));
      }
      tell(model.name() + ": errors on every contact");
      for (std::size_t k = 0; k < tuning.data.size(); ++k) model.outcomes.push_back(outcome_of(tuning, model, k));
      model.shape_parts = shape_parts_of(tuning.data.front(), model);
      model.limits = limits_of(tuning, model);
      tuning.models.push_back(std::move(model));
    }
  }
  return tuning;
}

}  // namespace touchstone::compare
