#include "fast/step/press.h"

#include <algorithm>

namespace touchstone::fast {
namespace {

using scene::Pose;
using scene::Vec3;

/// Beyond this part of the body's thickness the closest surface says little about where the tool came from, and the
/// region keeps its direction.
constexpr double direction_kept_rel = 0.25;

}  // namespace

Placement placement(const Pose& pose) noexcept { return {pose.orientation.toRotationMatrix(), pose.position_m}; }

Vec3 entry_direction(const FastModel& model, const Motion& motion, const InsideSummary& inside,
                     FastState& state) noexcept {
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
    // The sample that is first speaks for one flank of an edge or a tip; a spacing on, all flanks have their say.
    const double way_m =
        std::max(inside.deepest_m, (1.0 - touching) * (motion.pose.position_m - motion.before.position_m).norm());
    RegionPoints points = state.probe.window();
    const InsideSummary here =
        inside_at(touching + (1.0 - touching) * model.tool.spacing_m / way_m, model.tool.count(), points);
    if (points.count > 0) first = here;
  }
  const Vec3 otherwise = -model.body->query(motion.pose.position_m).normal;
  return direction_from(first, otherwise);
}

Vec3 next_direction(const ContactRegion& region, const InsideSummary& inside) noexcept {
  return region.depth_rel < direction_kept_rel ? follow_direction(region.d, inside) : region.d;
}

InsideSummary find_points(const FastModel& model, const Placement& at, double margin_m, RegionPoints& points,
                          CellScratch& cells) noexcept {
  const Detection& detection = model.detection;
  if (model.formulas.cells)
    return detection.find_cells(*model.body, model.tool, at, *model.formulas.cells, margin_m, points, cells);
  return detection.find_inside(*model.body, model.tool, at, margin_m, model.tool.count(), points);
}

bool find_one_region(const FastModel& model, const Motion& motion, FastState& state) noexcept {
  ContactRegion& region = state.regions[0];
  RegionPoints points = state.store.window();
  const InsideSummary inside = find_points(model, motion.at, 0.0, points, state.cells);
  const bool created = points.count > 0 && !region.active;
  if (points.count == 0) {
    if (region.active) region.clear();
    state.region_count = 0;
    state.lap(Stage::detection);
    return created;
  }
  if (created) {
    region.active = true;
    state.region_count = 1;
    region.d = entry_direction(model, motion, inside, state);
  } else {
    region.d = next_direction(region, inside);
  }
  region.points = points;
  return created;
}

StepStatus measure(const FastModel& model, const Motion& motion, ContactRegion& region, FastState& state) noexcept {
  region.extent = model.detection.measure_depths(*model.body, motion.at.R_WT, region.d, region.points);
  // Only the tool's back is inside: nothing pushes, but the region lives on with its direction.
  if (region.points.count == 0) return StepStatus::ok;
  // A tip of no thickness is touched without depth.
  region.depth_rel = region.extent.thickness_m > 0.0 ? region.extent.deepest_m / region.extent.thickness_m : 0.0;
  region.origin = deformation_origin(*model.body, model.detection.exit_distance_m, region.d, region.extent);
  const bool held = limit_depths(depth_limit_rel * region.extent.thickness_m, region.points);
  state.lap(Stage::detection);
  model.formulas.distribute_mass(motion.at.R_WT.transpose() * region.d, model.tool.groups, region.points);
  return held ? StepStatus::depth_limited : StepStatus::ok;
}

StepStatus push(const FastModel& model, const Motion& motion, bool created, ContactRegion& region,
                FastState& state) noexcept {
  region.force = RegionForce{};
  region.displacement_m.setZero();
  if (region.points.count == 0) return StepStatus::ok;
  const DuffingLaw law = model.law.at(contact_radius_m(region.extent.area_m2));
  region.force = region_force(law, motion.at.R_WT, region.d, region.points);
  const StepStatus status = region.force.saturated ? StepStatus::law_saturated : StepStatus::ok;
  if (model.formulas.resolve_friction == nullptr) {
    region.displacement_m = law.depth_m(region.force.magnitude_n) * region.d;
    state.lap(Stage::force);
    return status;
  }
  state.lap(Stage::force);
  const Vec3 step_m =
      created ? Vec3(Vec3::Zero()) : material_step_m(placement(motion.before), motion.at, region.force.load_center_m);
  region.displacement_m = model.formulas.resolve_friction(*model.friction, law, motion.at.R_WT, region.d, region.points,
                                                          step_m, region.force, region.friction);
  // The contact has been dragged from where it began.
  region.origin = origin_at(*model.body, region.origin.p0_W_m - region.friction.stretch_m);
  state.lap(Stage::friction);
  return status;
}

StepStatus press(const FastModel& model, const Motion& motion, bool created, ContactRegion& region,
                 FastState& state) noexcept {
  const StepStatus measured = measure(model, motion, region, state);
  return measured | push(model, motion, created, region, state);
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
