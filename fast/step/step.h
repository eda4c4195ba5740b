// One tick of the real-time pipeline (the paper's Fig. 1): pose in, contact force and deformed surface out.
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"
#include "scene/base/frames.h"

namespace touchstone::fast {

/// Contact and force: the tool's samples against the rest shape, the region's direction, depths, mass weights and
/// force. The answer is total_force_n(state) and state.regions; a device gets it before the shape is computed.
/// A pose that is not finite leaves the state as it is.
StepStatus step_force(const FastModel& model, const scene::Pose& pose, FastState& state) noexcept;

/// Shape: beam skeleton, surface, local factor where there is one, normals. The answer is in state.field and
/// state.regions[].ends. Follows step_force.
StepStatus step_shape(const FastModel& model, FastState& state) noexcept;

/// The displacements only, where there is a single region and it presses.
void displace(const FastModel& model, FastState& state) noexcept;

/// Force and shape. No heap, lock, throw, log or file access happens below; equal poses from equal states give equal
/// bits.
StepStatus step(const FastModel& model, const scene::Pose& pose, FastState& state) noexcept;

}  // namespace touchstone::fast
