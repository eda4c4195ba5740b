// The engine of a scene, of whichever formulation, as a model.
#pragma once

#include "compare/model/model.h"

#include <memory>
#include <string>

namespace touchstone::compare {

/// What a formulation reads from the store must be there.
[[nodiscard]] std::unique_ptr<ContactModel> engine_model(scene::Scene scene);
[[nodiscard]] std::unique_ptr<ModelReplay> engine_replay(const scene::Scene& scene);

/// What was reported in the steps of a run; empty where nothing was.
[[nodiscard]] std::string trouble_of(const fast::Run& run);

}  // namespace touchstone::compare
