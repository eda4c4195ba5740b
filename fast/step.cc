#include "fast/step.h"

#include <cmath>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace touchstone::fast {
namespace {

using scene::Pose;
using scene::Vec3;

/// Beyond this part of the body's thickness the closest surface says little about where the tool came from, and the
/// region keeps its direction.
constexpr double direction_kept_rel = 0.25;

bool finite(const Pose& pose) noexcept {
  const double length = pose.orientation.norm();
  return pose.position_m.allFinite() && std::isfinite(length) && length > 0.0;
}

Placement placement(const Pose& pose) noexcept { return {pose.orientation.toRotationMatrix(), pose.position_m}; }

/// Takes numbers too small for full precision as zero while it lives: they cost a hundred times a normal one, and a
/// surface at rest in some direction is full of them.
class FlushTinyNumbers {
 public:
#if defined(__SSE__)
  FlushTinyNumbers() noexcept : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushTinyNumbers() { _mm_setcsr(before_); }
  FlushTinyNumbers(const FlushTinyNumbers&) = delete;
  FlushTinyNumbers& operator=(const FlushTinyNumbers&) = delete;

 private:
  unsigned before_;
#endif
};

/// Direction of deformation of a region that has just come into being. Where one tick has brought the tool further in
/// than its samples lie apart, the pose of first touch on the way is looked for, or a fast tool would be taken to have
/// come from the nearest side of the body.
Vec3 entry_direction(const FastModel& model, const Pose& pose, const InsideSummary& inside, FastState& state) noexcept {
  InsideSummary first = inside;
  if (state.placed && inside.deepest_m > model.tool.spacing_m) {
    double apart = 0.0, touching = 1.0;
    for (int halving = 0; halving < 30; ++halving) {
      const double s = 0.5 * (apart + touching);
      const Pose between{(1.0 - s) * state.pose.position_m + s * pose.position_m,
                         state.pose.orientation.slerp(s, pose.orientation)};
      RegionPoints points = state.store.window();
      const InsideSummary here =
          model.detection.find_inside(*model.body, model.tool, placement(between), 0.0, 1, points);
      if (points.count > 0) {
        touching = s;
        first = here;
      } else {
        apart = s;
      }
    }
  }
  const Vec3 otherwise = -model.body->query(pose.position_m).normal;
  return direction_from(first, otherwise);
}

/// Depths, shares, force and equivalent point contact of a region whose points and direction are known.
StepStatus press(const FastModel& model, const Placement& at, ContactRegion& region) noexcept {
  region.force = RegionForce{};
  region.displacement_m.setZero();
  region.extent = model.detection.measure_depths(*model.body, at.R_WT, region.d, region.points);
  // Only the tool's back is inside: nothing pushes, but the region lives on with its direction.
  if (region.points.count == 0) return StepStatus::ok;
  StepStatus status = StepStatus::ok;
  region.depth_rel = region.extent.deepest_m / region.extent.thickness_m;
  region.origin = deformation_origin(*model.body, model.detection.exit_distance_m, region.d, region.extent);
  if (limit_depths(depth_limit_rel * region.extent.thickness_m, region.points)) status |= StepStatus::depth_limited;

  model.formulas.distribute_mass(at.R_WT.transpose() * region.d, model.tool.spacing_m, region.points);
  region.force = region_force(model.law, at.R_WT, region.d, region.points);
  if (region.force.saturated) status |= StepStatus::law_saturated;
  region.displacement_m = model.law.depth_m(region.force.magnitude_n) * region.d;
  return status;
}

/// The whole tool in one region.
StepStatus press_one_region(const FastModel& model, const Pose& pose, const Placement& at, FastState& state) noexcept {
  const int all = model.tool.count();
  ContactRegion& region = state.regions[0];
  RegionPoints points = state.store.window();
  InsideSummary inside = model.detection.find_inside(*model.body, model.tool, at, 0.0, all, points);
  if (points.count == 0) {
    if (region.active) region.clear();
    state.region_count = 0;
    return StepStatus::ok;
  }
  if (!region.active) {
    region.active = true;
    region.id = state.regions_created++;
    state.region_count = 1;
    region.d = entry_direction(model, pose, inside, state);
    inside = model.detection.find_inside(*model.body, model.tool, at, 0.0, all, points);
  } else if (region.depth_rel < direction_kept_rel) {
    region.d = follow_direction(region.d, inside);
  }
  region.points = points;
  return press(model, at, region);
}

}  // namespace

StepStatus step_force(const FastModel& model, const Pose& pose_asked, FastState& state) noexcept {
  if (!finite(pose_asked)) return StepStatus::not_finite;
  const Pose pose{pose_asked.position_m, pose_asked.orientation.normalized()};
  const StepStatus status = press_one_region(model, pose, placement(pose), state);
  state.pose = pose;
  state.placed = true;
  return status;
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
  ContactRegion& region = state.regions[0];
  const Vec3 force_on_body_n = -region.force.force_n;
  model.formulas.split_force(model.skeleton, region.origin.p0_W_m, force_on_body_n, region.displacement_m, region.ends);

  ContactPoint contact;
  contact.patch = region.origin.patch;
  contact.place = model.anchors->at(contact.patch, region.origin.p0_W_m);
  contact.normal = region.origin.normal;
  if (!contact.place.held()) contact.displacement_m = region.displacement_m;
  model.formulas.interpolate(model.rest, region.ends.displacement_m, contact, state.field);
  if (model.formulas.apply_local_factor != nullptr) {
    model.formulas.apply_local_factor(model.rest, model.local, {region.points.count, region.extent.area_m2},
                                      region.origin.p0_W_m, state.field);
  }
  update_normals(model.normals, model.rest, state.field);
  state.deformed = true;
  return region.ends.limited ? StepStatus::anchors_limited : StepStatus::ok;
}

StepStatus step(const FastModel& model, const Pose& pose, FastState& state) noexcept {
  const StepStatus force = step_force(model, pose, state);
  if (force == StepStatus::not_finite) return force;
  return force | step_shape(model, state);
}

}  // namespace touchstone::fast
