// What acts at the contact beyond the total force: friction, its work, the onset of slip, torque, single regions,
// tractions.
#pragma once

#include "compare/errors/errors.h"
#include "scene/model/answer.h"
#include "scene/model/scene.h"

namespace touchstone::compare {

/// Fills the friction, slip, torque, region and traction figures of errors whose forces are compared already.
void compare_contacts(const scene::Scene& scene, const scene::Answer& answer,
                      const std::vector<scene::ReferenceInstant>& reference, Errors& errors);

}  // namespace touchstone::compare
