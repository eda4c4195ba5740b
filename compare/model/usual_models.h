// The models in the table of every comparison.
#pragma once

#include "compare/model/request.h"

#include <vector>

namespace touchstone::compare {

/// The paper's model as printed, the area-aware law and the response model, which need no tuning, the scene's own, and
/// the first file of tuned constants. A model that is the same as another is listed once, but for the tuned one.
/// A further one is a call of `add` here.
[[nodiscard]] std::vector<ModelEntry> usual_models(const ModelRequest& request);

}  // namespace touchstone::compare
