// The response model: a half space in closed form and the body's computed response.
#pragma once

#include "compare/model/request.h"

namespace touchstone::compare {

/// The scene with the response model.
[[nodiscard]] scene::Scene with_response(scene::Scene scene);

/// For a changed scene; what it needs from the reference's side is prepared when it is set up, or read from the store.
/// @param entry  its name, key and label
[[nodiscard]] ModelEntry response_model(ModelEntry entry, const SceneChange& change, const ModelRequest& request);

/// One model, untuned but for what the scene has.
[[nodiscard]] std::vector<ModelEntry> response_models(const ModelRequest& request);

}  // namespace touchstone::compare
