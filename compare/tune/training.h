// One stage of a tuning: the training contacts as residuals, and their fit.
#pragma once

#include "compare/model/model.h"
#include "compare/tune/tuning.h"

namespace touchstone::compare {

/// Fits what is free in a stage, with the stages of the model that were fitted before. No parameters: nothing is free.
/// @param deepest_m  of all contacts, on which the laws must have an answer
/// @throws std::runtime_error when the model has no answer at any start
[[nodiscard]] StageFit fit_stage(const Tuning& tuning, const TunedModel& model, TuningStage stage, double deepest_m);

}  // namespace touchstone::compare
