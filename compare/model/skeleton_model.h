// The paper's beam skeleton: in both formulations, with the scene's law or the area-aware law, and on surfaces of
// several sizes.
#pragma once

#include "compare/model/request.h"

#include <optional>
#include <vector>

namespace touchstone::compare {

/// The scene with the published formulation; with the corrected one.
[[nodiscard]] scene::Scene as_printed(scene::Scene scene);
[[nodiscard]] scene::Scene corrected(scene::Scene scene);

/// The scene with the area-aware law and the constants that follow from material and size, which nothing has to be
/// tuned for.
[[nodiscard]] scene::Scene with_untuned_area_law(scene::Scene scene);

/// Hertz's force of a ball on the scene's box, ball or ellipsoid top [N]: 4/3 E/(1-nu^2) sqrt(R) depth^1.5, R the
/// effective radius; nothing for other tools and bodies, and with inclusions. For small depths and small strain; an
/// order of magnitude for the scene's material, not a reference.
[[nodiscard]] std::optional<double> hertz_force_n(const scene::Scene& scene, double depth_m);

/// The model of a scene that has it, as of fast_model().
[[nodiscard]] ModelEntry skeleton_model(const scene::Scene& scene, const Say& say);

/// Both formulations with both laws.
[[nodiscard]] std::vector<ModelEntry> skeleton_models(const ModelRequest& request);

/// The corrected skeleton, tuned where there is a parameter file, on other surfaces than the scene's.
[[nodiscard]] std::vector<ModelEntry> skeleton_meshes(const ModelRequest& request);

/// Absent: no scene has a setting for anchor points.
[[nodiscard]] std::vector<ModelEntry> skeleton_anchor_sets(const ModelRequest& request);

}  // namespace touchstone::compare
