// The body as a precomputed linear compliance.
#pragma once

#include "compare/model/request.h"

namespace touchstone::compare {

[[nodiscard]] std::vector<ModelEntry> compliance_models(const ModelRequest& request);

}  // namespace touchstone::compare
