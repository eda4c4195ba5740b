// A tuned model on the contacts of its study.
#pragma once

#include "compare/model/model.h"
#include "compare/tune/tuning.h"

namespace touchstone::compare {

/// @param at  of the contact in Tuning::data
[[nodiscard]] TuningOutcome outcome_of(const Tuning& tuning, const TunedModel& model, std::size_t at);

/// On one contact, as of TunedModel
[[nodiscard]] std::vector<double> shape_parts_of(const TuningData& data, const TunedModel& model);

}  // namespace touchstone::compare
