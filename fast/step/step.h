// One tick of the real-time pipeline (the paper's Fig. 1): pose in, contact force and deformed surface out.
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"
#include "scene/base/frames.h"

namespace touchstone::fast {

/// The parts of a tick, bits. Each begins where the one before has left the state; a fit keeps what its constants have
/// no part in and repeats the rest. Apart, `measure` and `load` are for a state with one region.
enum class Parts : unsigned {
  find = 1u << 0,      ///< pose check, contact detection, contact regions
  measure = 1u << 1,   ///< per region: direction, depths, mass shares
  load = 1u << 2,      ///< per region: contact force, friction, equivalent point contact
  displace = 1u << 3,  ///< beam skeleton, interpolation, local factor
  normals = 1u << 4,
  press = measure | load,
  force = find | press,        ///< the result for a device, before the shape is updated
  shape = displace | normals,  ///< follows a force part whose pose was good
  all = force | shape
};
[[nodiscard]] constexpr bool has(Parts parts, Parts part) noexcept {
  return (static_cast<unsigned>(parts) & static_cast<unsigned>(part)) != 0;
}

/// Force and shape, or parts of them. The force is total_force_n(state) and state.regions, the shape state.field and
/// state.regions[].ends. A pose that is not finite leaves the state as it is. No heap, lock, throw, log or file access
/// happens below; equal poses from equal states give equal bits.
/// @param pose  only read by Parts::find
StepStatus step(const FastModel& model, const scene::Pose& pose, FastState& state, Parts parts = Parts::all) noexcept;

inline StepStatus step_force(const FastModel& model, const scene::Pose& pose, FastState& state) noexcept {
  return step(model, pose, state, Parts::force);
}
inline StepStatus step_shape(const FastModel& model, FastState& state) noexcept {
  return step(model, state.motion.pose, state, Parts::shape);
}

}  // namespace touchstone::fast
