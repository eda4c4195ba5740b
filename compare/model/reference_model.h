// The levels of the reference.
#pragma once

#include "compare/model/request.h"

namespace touchstone::compare {

[[nodiscard]] std::vector<ModelEntry> reference_models(const ModelRequest& request);

}  // namespace touchstone::compare
