// The response model: a half space in closed form and the body's computed response.
#pragma once

#include "compare/model/request.h"

namespace touchstone::compare {

/// The scene with the response model.
[[nodiscard]] scene::Scene with_response(scene::Scene scene);

/// One model; what it needs from the reference's side is prepared when it is set up, or read from the store.
[[nodiscard]] std::vector<ModelEntry> response_models(const ModelRequest& request);

}  // namespace touchstone::compare
