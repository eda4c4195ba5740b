// The response model: a half space in closed form and the body's computed response.
#pragma once

#include "compare/model/request.h"
#include "reference/response/prepare.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// The response of the scene's body, from the store or computed, with progress.
/// @param show  a line, the most important first, and whether it also belongs in a log
/// Ctrl-C, SIGTERM or SIGHUP ends the process before the first column, later the computation after a column.
/// @throws reference::Interrupted then, with what is kept; as of reference::prepare_response()
[[nodiscard]] reference::Prepared prepare(const scene::Scene& scene, const std::filesystem::path& store,
                                          const std::function<void(const std::string&, bool)>& show);

/// The scene with the response model.
[[nodiscard]] scene::Scene with_response(scene::Scene scene);

/// The model of a scene that has it, as of fast_model().
[[nodiscard]] ModelEntry response_model(const scene::Scene& scene, const Say& say);

/// One model, untuned but for what the scene has.
[[nodiscard]] std::vector<ModelEntry> response_models(const ModelRequest& request);

}  // namespace touchstone::compare
