// The comparison in plain words, every number and every reason taken from the figures themselves.
#pragma once

#include "compare/errors.h"

#include <optional>
#include <string>
#include <vector>

namespace touchstone::compare {

/// Hertz's force of a ball on the scene's box, ball or ellipsoid top [N]: 4/3 E/(1-nu^2) sqrt(R) depth^1.5, R the
/// effective radius; nothing for other tools and bodies, and with inclusions. For small depths and small strain; an
/// order of magnitude for the scene's material, not a reference.
[[nodiscard]] std::optional<double> hertz_force_n(const scene::Scene& scene, double depth_m);

/// Paragraphs for a reader who knows neither model, the most important first: force, why, shape, cost. An error
/// within the reference's uncertainty is called not distinguishable.
[[nodiscard]] std::vector<std::string> verdict(const scene::Scene& scene, const fast::Run& run,
                                               const reference::Result& result, const Errors& errors);

}  // namespace touchstone::compare
