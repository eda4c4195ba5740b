// Tuning: a model's free numbers fitted to the reference on training contacts and judged on contacts that the fit never
// saw. The force does not depend on the shape's parameters, so it is fitted first, then the shape with it.
#pragma once

#include "compare/model/registry.h"
#include "compare/tune/tuning.h"

#include <functional>

namespace touchstone::compare {

/// The model of a scene with the formulation and the law that are tuned.
using ModelOf = std::function<ModelEntry(const scene::Scene&)>;

/// @param model_of  whose numbers are fitted
/// @throws what `solve` and the model throw, std::runtime_error when the model has no answer at any start of a fit
[[nodiscard]] Tuning tune(
    const TuningStudy& study, const SolveReference& solve, const Say& say = {},
    const ModelOf& model_of = [](const scene::Scene& scene) { return fast_model(scene); });

}  // namespace touchstone::compare
