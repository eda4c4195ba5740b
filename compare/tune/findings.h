// The findings of a tuning, as sentences.
#pragma once

#include "compare/tune/tuning.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// What the data do not determine in a stage, a sentence each.
[[nodiscard]] std::vector<std::string> notes_of(const StageFit& stage);

/// What limits a tuned model on its held-out contacts, a sentence each.
[[nodiscard]] std::vector<std::string> limits_of(const Tuning& tuning, const TunedModel& model);

}  // namespace touchstone::compare
