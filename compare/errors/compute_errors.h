// The errors of one model's answer against the reference.
#pragma once

#include "compare/errors/errors.h"
#include "scene/model/answer.h"
#include "scene/model/scene.h"

namespace touchstone::compare {

/// Compares one run with one reference result of the same scene.
/// @throws std::logic_error when the sides differ in instants (time to 1e-12 s, tool place to 1e-9 m) or rest points
[[nodiscard]] Errors compute_errors(const scene::Scene& scene, const scene::Answer& answer,
                                    const std::vector<scene::ReferenceInstant>& reference);

}  // namespace touchstone::compare
