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

Tuning tune(const TuningStudy& study, const SolveReference& solve, const std::function<void(const std::string&)>& say,
            const ModelEntry& entry) {
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
    const bool response = formulation == scene::Formulation::response;
    for (const scene::ContactLaw law : study.laws) {
      if (response && law != study.laws.front()) continue;
      TunedModel model{
          .formulation = formulation, .law = law, .stages = {}, .outcomes = {}, .shape_parts = {}, .limits = {}};
      for (const TuningStage stage : {TuningStage::force, TuningStage::shape}) {
        tell(fmt::format("{}: fitting the {}", model.name(), stage == TuningStage::force ? "force" : "shape"));
        StageFit fitted = fit_stage(tuning, entry, model, stage, deepest);
        if (!fitted.parameters.empty()) model.stages.push_back(std::move(fitted));
      }
      tell(model.name() + ": errors on every contact");
      for (std::size_t k = 0; k < tuning.data.size(); ++k)
        model.outcomes.push_back(outcome_of(tuning, entry, model, k));
      if (has_skeleton(entry.family) && !response)
        model.shape_parts = shape_parts_of(tuning.data.front(), entry, model);
      model.limits = limits_of(tuning, model);
      tuning.models.push_back(std::move(model));
    }
  }
  return tuning;
}

}  // namespace touchstone::compare
