// The fast model of a scene, of whichever formulation.
#pragma once

#include "compare/model/model.h"
#include "reference/response/prepare.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace touchstone::compare {

/// The response of the scene's body, from the store or computed, with progress.
/// @param show  a line, the most important first, and whether it also belongs in a log
/// Ctrl-C, SIGTERM or SIGHUP ends the process before the first column, later the computation after a column.
/// @throws reference::Interrupted then, with what is kept; as of reference::prepare_response()
[[nodiscard]] reference::Prepared prepare(const scene::Scene& scene, const std::filesystem::path& store,
                                          const std::function<void(const std::string&, bool)>& show);

/// Computes what the scene's formulation reads from the store where it is not there: the body's response.
/// @param say  one line about what takes long; may be empty
/// @throws as prepare()
void prepare_missing(const scene::Scene& scene, const std::function<void(const std::string&)>& say = {});

/// The engine of the scene's formulation as a model, with what it needs prepared.
/// @throws Unavailable with the reason where it cannot be
[[nodiscard]] std::unique_ptr<ContactModel> engine_model(scene::Scene scene,
                                                         const std::function<void(const std::string&)>& say = {});

/// What was reported in the steps of a run; empty where nothing was.
[[nodiscard]] std::string trouble_of(const fast::Run& run);

}  // namespace touchstone::compare
