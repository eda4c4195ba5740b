// The paper's beam skeleton: in both formulations, with the scene's law, the area-aware law or tuned constants, and on
// surfaces of several sizes.
#pragma once

#include "compare/model/request.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// The scene with the published formulation; with the corrected one.
[[nodiscard]] scene::Scene as_printed(scene::Scene scene);
[[nodiscard]] scene::Scene corrected(scene::Scene scene);

/// The scene with the area-aware law and the constants that follow from material and size, which nothing has to be
/// tuned for.
[[nodiscard]] scene::Scene with_untuned_area_law(scene::Scene scene);

/// The skeleton for a changed scene. The second has method and family of the changed scene, and no name.
[[nodiscard]] ModelEntry skeleton_model(ModelEntry entry, const SceneChange& change);
[[nodiscard]] ModelEntry skeleton_model(const std::string& key, const scene::Scene& given, const SceneChange& change);

/// The fast model with the scene's own constants, which `fast`, `compare`, `tune` and gates are about.
[[nodiscard]] ModelEntry fast_model();

/// Both formulations with both laws, and one model for every file of tuned constants.
[[nodiscard]] std::vector<ModelEntry> skeleton_models(const ModelRequest& request);

/// The corrected skeleton, tuned where there is a parameter file, on other surfaces than the scene's.
[[nodiscard]] std::vector<ModelEntry> skeleton_meshes(const ModelRequest& request);

/// Absent: no scene has a setting for anchor points.
[[nodiscard]] std::vector<ModelEntry> skeleton_anchor_sets(const ModelRequest& request);

}  // namespace touchstone::compare
