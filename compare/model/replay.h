// A model's forces and shapes for a fit, by its own replay or by a new set-up in every call.
#pragma once

#include "compare/model/model.h"

namespace touchstone::compare {

/// The entry's own replay; without one it is set up for every call. @throws Unavailable
[[nodiscard]] std::unique_ptr<ModelReplay> replay_of(const ModelEntry& entry, const scene::Scene& scene);

}  // namespace touchstone::compare
