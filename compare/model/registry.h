// The list of models.
#pragma once

#include "compare/model/request.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// Every kind, in the order in which tables list them: `trade` judges all of them, gates and `compare` find them by
/// key. A new kind is a line here. Which of them every comparison judges: `usual_models.h`.
[[nodiscard]] const std::vector<ModelList>& registered_models();

/// The fast model of a scene, with the scene's own constants: what `fast`, `compare`, `tune` and gates are about. What
/// it needs from the reference's side is prepared when it is set up, or read from the store. A formulation is a line
/// here.
[[nodiscard]] ModelEntry fast_model(const scene::Scene& scene, const Say& say = {});

/// Prepares it. @throws as prepare() of the response model
void prepare_missing(const scene::Scene& scene, const Say& say = {});

[[nodiscard]] std::vector<ModelEntry> list_models(const ModelRequest& request, const std::vector<ModelList>& kinds);

/// The model of this key, judged on the scene's own surface.
/// @throws scene::InputError when there is none, with the keys there are, or with why it is absent
[[nodiscard]] ModelEntry find_model(const ModelRequest& request, const std::string& key,
                                    const std::vector<ModelList>& kinds = registered_models());

}  // namespace touchstone::compare
