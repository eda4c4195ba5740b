// One step of the response model: pose in, force and shape out.
#pragma once

#include "fast/response/response_model.h"
#include "fast/step/status.h"

namespace touchstone::fast {

/// No heap, lock, throw, log or file access happens below. Equal poses give equal bits; with friction, equal ways do,
/// from the tick in which the tool touches on.
StepStatus response_step(const ResponseModel& model, const scene::Pose& pose, ResponseState& state) noexcept;

/// Its parts: the force, which a device waits for, then the shape.
StepStatus response_force(const ResponseModel& model, const scene::Pose& pose, ResponseState& state) noexcept;
/// Of the last force.
void response_shape(const ResponseModel& model, ResponseState& state) noexcept;

/// What a contact of the last step has of the checked range.
[[nodiscard]] ContactRange contact_range(const ResponseModel& model, const ResponseState& state,
                                         const ResponseContact& contact, const scene::ToolTip& tip) noexcept;

}  // namespace touchstone::fast
