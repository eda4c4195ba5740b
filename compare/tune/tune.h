// Tuning: a model's free numbers fitted to the reference on training contacts and judged on contacts that the fit never
// saw. The force does not depend on the shape's parameters, so it is fitted first, then the shape with it.
#pragma once

#include "compare/model/skeleton_model.h"
#include "compare/tune/tuning.h"

#include <functional>
#include <string>

namespace touchstone::compare {

/// @param say    called with one line about what begins; may be empty
/// @param model  whose numbers are fitted
/// @throws what `solve` and the model throw, std::runtime_error when the model has no answer at any start of a fit
[[nodiscard]] Tuning tune(const TuningStudy& study, const SolveReference& solve,
                          const std::function<void(const std::string&)>& say = {},
                          const ModelEntry& model = fast_model());

}  // namespace touchstone::compare
