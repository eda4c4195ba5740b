#include "fast/step/stages.h"

#include "scene/base/range.h"

#include <algorithm>

namespace touchstone::fast {
namespace {

using scene::Pose;
using scene::Vec3;

/// At a depth above this fraction of the body's thickness the closest surface point does not tell where the tool came
/// from, and the region keeps its direction.
constexpr double direction_kept_rel = 0.25;

/// Inward normal at the surface point closest to the tool's mass centre.
Vec3 direction_to_centre(const FastModel& model, const Motion& motion) noexcept {
  return -model.body->query(motion.pose.position_m).normal;
}

/// Direction of deformation of a region that begins in this tick. If the tool moved further in than its samples are
/// apart, the pose one sample spacing after first touch is used. Otherwise a fast tool would seem to have come from the
/// nearest side of the body.
Vec3 entry_direction(const FastModel& model, const InsideSummary& inside, FastState& state) noexcept {
  const Motion& motion = state.motion;
  InsideSummary first = inside;
  if (!motion.first && inside.deepest_m > model.tool.spacing_m) {
    const auto inside_at = [&](double s, int limit, RegionPoints& points) {
      const Pose between{(1.0 - s) * motion.before.position_m + s * motion.pose.position_m,
                         motion.before.orientation.slerp(s, motion.pose.orientation)};
      return model.detection.find_inside(*model.body, model.tool, placement(between), 0.0, limit, points);
    };
    double apart = 0.0, touching = 1.0;
    for (int halving = 0; halving < 30; ++halving) {
      const double s = 0.5 * (apart + touching);
      RegionPoints points = state.probe.window();
      const InsideSummary here = inside_at(s, 1, points);
      if (points.count > 0) {
        touching = s;
        first = here;
      } else {
        apart = s;
      }
    }
    // The first sample inside sees one side of an edge or tip only. Sample again one spacing deeper, where all sides
    // are inside.
    const double travel_m =
        std::max(inside.deepest_m, (1.0 - touching) * (motion.pose.position_m - motion.before.position_m).norm());
    RegionPoints points = state.probe.window();
    const InsideSummary here =
        inside_at(touching + (1.0 - touching) * model.tool.spacing_m / travel_m, model.tool.count(), points);
    if (points.count > 0) first = here;
  }
  return direction_from(first, direction_to_centre(model, motion));
}

}  // namespace

Placement placement(const Pose& pose) noexcept { return {pose.orientation.toRotationMatrix(), pose.position_m}; }

bool move_to(const Pose& asked, FastState& state) noexcept {
  if (!asked.position_m.allFinite() || !scene::orientation_norm.contains(asked.orientation.norm())) return false;
  const Pose pose{asked.position_m, asked.orientation.normalized()};
  state.motion = {pose, placement(pose), state.placed ? state.motion.pose : pose, !state.placed};
  state.placed = true;
  return true;
}

InsideSummary find_points(const FastModel& model, const Placement& at, double margin_m, RegionPoints& points,
                          CellScratch& cells) noexcept {
  const Detection& detection = model.detection;
  if (model.cells) return detection.find_cells(*model.body, model.tool, at, model.cells->rule, margin_m, points, cells);
  return detection.find_inside(*model.body, model.tool, at, margin_m, model.tool.count(), points);
}

void keep_one_region(const RegionPoints& points, const InsideSummary& inside, FastState& state) noexcept {
  ContactRegion& region = state.regions[0];
  state.region_count = points.count > 0 ? 1 : 0;
  if (points.count == 0) {
    if (region.active) region.clear();
    return;
  }
  region.active = true;
  region.points = points;
  region.inside = inside;
}

void find_direction(const FastModel& model, ContactRegion& region, FastState& state) noexcept {
  if (region.points.count == 0) return;
  region.created = !region.met;
  region.met = true;
  if (!region.created) {
    if (region.depth_rel < direction_kept_rel) region.d = follow_direction(region.d, region.inside);
  } else if (state.region_count == 1) {
    region.d = entry_direction(model, region.inside, state);
  } else {
    region.d = direction_from(region.inside, direction_to_centre(model, state.motion));
  }
}

StepStatus measure_depths(const FastModel& model, ContactRegion& region, FastState& state) noexcept {
  if (region.points.count == 0) return StepStatus::ok;
  region.extent = model.detection.measure_depths(*model.body, state.motion.at.R_WT, region.d, region.points);
  // Only the rear of the tool is inside: no force, but the region continues with its direction.
  if (region.points.count == 0) return StepStatus::ok;
  // A tip of zero thickness touches without depth.
  region.depth_rel = region.extent.thickness_m > 0.0 ? region.extent.deepest_m / region.extent.thickness_m : 0.0;
  region.origin = deformation_origin(*model.body, model.detection.exit_distance_m, region.d, region.extent);
  const bool held = limit_depths(depth_limit_rel * region.extent.thickness_m, region.points);
  state.lap(Stage::detection);
  return held ? StepStatus::depth_limited : StepStatus::ok;
}

StepStatus contact_force(const DuffingLaw& law, ContactRegion& region, FastState& state) noexcept {
  region.force = RegionForce{};
  region.displacement_m.setZero();
  if (region.points.count == 0) return StepStatus::ok;
  region.force = region_force(law, state.motion.at.R_WT, region.d, region.points);
  state.lap(Stage::force);
  return region.force.saturated ? StepStatus::law_saturated : StepStatus::ok;
}

void friction_and_point_contact(const FastModel& model, const DuffingLaw& law, ContactRegion& region,
                                FastState& state) noexcept {
  if (region.points.count == 0) return;
  if (model.formulas.resolve_friction == nullptr) {
    region.displacement_m = law.depth_m(region.force.magnitude_n) * region.d;
    state.lap(Stage::force);
    return;
  }
  const Motion& motion = state.motion;
  const Vec3 step_m = region.created ? Vec3(Vec3::Zero())
                                     : material_step_m(placement(motion.before), motion.at, region.force.load_center_m);
  region.displacement_m = model.formulas.resolve_friction(*model.friction, law, motion.at.R_WT, region.d, region.points,
                                                          step_m, region.force, region.friction);
  // Friction has moved the contact away from where it began.
  region.origin = origin_at(*model.body, region.origin.p0_W_m - region.friction.stretch_m);
  state.lap(Stage::friction);
}

StepStatus load_beams(const FastModel& model, const SkeletonView& skeleton, const Vec3& p0_m,
                      ContactRegion& region) noexcept {
  model.formulas.split_force(skeleton, p0_m, -region.force.force_n, region.displacement_m, region.ends);
  return region.ends.limited ? StepStatus::anchors_limited : StepStatus::ok;
}

ContactPoint contact_point(const FastModel& model, const ContactRegion& region) noexcept {
  ContactPoint contact;
  contact.patch = region.origin.patch;
  contact.place = model.anchors->at(contact.patch, region.origin.p0_W_m);
  contact.normal = region.origin.normal;
  if (!contact.place.held()) contact.displacement_m = region.displacement_m;
  return contact;
}

}  // namespace touchstone::fast
