#include "fast/step/step.h"

#include "fast/realtime/flush_tiny_numbers.h"
#include "fast/step/press.h"
#include "fast/step/several_regions.h"
#include "scene/base/range.h"

namespace touchstone::fast {
namespace {

using scene::Pose;
using scene::Vec3;

bool is_placement(const Pose& pose) noexcept {
  return pose.position_m.allFinite() && scene::orientation_norm.contains(pose.orientation.norm());
}

/// The whole tool in one region.
StepStatus press_one_region(const FastModel& model, const Motion& motion, FastState& state) noexcept {
  const bool created = find_one_region(model, motion, state);
  return state.region_count == 0 ? StepStatus::ok : press(model, motion, created, state.regions[0], state);
}

}  // namespace

StepStatus step_force(const FastModel& model, const Pose& pose_asked, FastState& state) noexcept {
  if (!is_placement(pose_asked)) return StepStatus::not_finite;
  const Pose pose{pose_asked.position_m, pose_asked.orientation.normalized()};
  const Motion motion{pose, placement(pose), state.placed ? state.pose : pose, !state.placed};
  const StepStatus status =
      state.several == nullptr ? press_one_region(model, motion, state) : press_several_regions(model, motion, state);
  state.pose = pose;
  state.placed = true;
  return status;
}

void displace(const FastModel& model, FastState& state) noexcept {
  ContactRegion& region = state.regions[0];
  const Vec3 force_on_body_n = -region.force.force_n;
  model.formulas.split_force(model.skeleton, region.origin.p0_W_m, force_on_body_n, region.displacement_m, region.ends);
  state.lap(Stage::skeleton);
  model.formulas.interpolate(model.rest, region.ends.displacement_m, contact_point(model, region), state.field);
  state.lap(Stage::interpolation);
  if (model.formulas.apply_local_factor != nullptr) {
    model.formulas.apply_local_factor(model.rest, model.local, {region.points.count, region.extent.area_m2},
                                      region.origin.p0_W_m, state.field);
    state.lap(Stage::local_factor);
  }
}

StepStatus step_shape(const FastModel& model, FastState& state) noexcept {
  if (!state.in_contact()) {
    if (state.deformed) {
      state.field.reset(model.rest);
      for (ContactRegion& region : state.regions) region.ends.clear();
      state.deformed = false;
    }
    return StepStatus::ok;
  }
  [[maybe_unused]] const FlushTinyNumbers flush;
  state.deformed = true;
  if (state.several != nullptr) return shape_several_regions(model, state);
  displace(model, state);
  update_normals(model.normals, state.field);
  state.lap(Stage::normals);
  return state.regions[0].ends.limited ? StepStatus::anchors_limited : StepStatus::ok;
}

StepStatus step(const FastModel& model, const Pose& pose, FastState& state) noexcept {
  const StepStatus force = step_force(model, pose, state);
  if (force == StepStatus::not_finite) return force;
  return force | step_shape(model, state);
}

}  // namespace touchstone::fast
