#include "fast/step/step.h"

#include "fast/realtime/flush_tiny_numbers.h"
#include "fast/step/several_regions.h"
#include "fast/step/stages.h"

namespace touchstone::fast {
namespace {

/// No contact: the body returns to its rest shape.
void return_to_rest(const FastModel& model, FastState& state) noexcept {
  if (!state.deformed) return;
  state.field.reset(model.rest.normal);
  for (ContactRegion& region : state.regions) region.ends.clear();
  state.deformed = false;
}

}  // namespace

StepStatus step(const FastModel& model, const scene::Pose& pose, FastState& state, Parts parts) noexcept {
  const Formulas& formulas = model.formulas;
  SeveralRegionsState* const several = state.several.get();
  StepStatus status = StepStatus::ok;

  if (has(parts, Parts::find)) {
    // Pose check: for an invalid pose the last valid result is kept.
    if (!move_to(pose, state)) return StepStatus::not_finite;

    // Contact detection: the points of the tool inside the rest shape or, with several regions, near it.
    RegionPoints points = state.store.window();
    const double margin_m = several != nullptr ? several->bulge_m : 0.0;
    const InsideSummary inside = find_points(model, state.motion.at, margin_m, points, state.cells);
    state.lap(Stage::detection);

    // Contact regions: one, or clusters of points that are tracked from tick to tick.
    if (several == nullptr) {
      keep_one_region(points, inside, state);
    } else {
      status |= track_regions(model, points, state);
    }
  }

  if (has(parts, Parts::press)) {
    if (several != nullptr) several->shapes.clear();
    for (std::size_t i = 0; i < static_cast<std::size_t>(state.region_count); ++i) {
      const std::size_t k = several != nullptr ? static_cast<std::size_t>(several->order[i]) : i;
      ContactRegion& region = state.regions[k];
      if (has(parts, Parts::measure)) {
        // Section VI: each region is evaluated on the body deformed by the earlier ones.
        if (several != nullptr) meet_deformed_body(model, region, state);

        // Direction of deformation, and depths along it from the origin of deformation.
        find_direction(model, region, state);
        status |= measure_depths(model, region, state);

        // Mass weights of the points.
        if (region.pressing())
          formulas.distribute_mass(state.motion.at.R_WT.transpose() * region.d, model.tool.groups, state.integrals,
                                   region.points);
      }
      if (has(parts, Parts::load)) {
        // Contact force by the law at the region's size.
        const DuffingLaw law = model.law.at(contact_radius_m(region.extent.area_m2));
        status |= contact_force(law, region, state);

        // Friction if the scene has it, and the equivalent point contact that represents the region.
        friction_and_point_contact(model, law, region, state);

        // Section VI: beam skeleton and deformed shape for the later regions.
        if (several != nullptr) status |= deform_body(model, k, state);
      }
    }
    if (several != nullptr) add_later_forces(model, state);
  }

  if (has(parts, Parts::shape)) {
    if (!state.in_contact()) {
      return_to_rest(model, state);
      return status;
    }
    [[maybe_unused]] const FlushTinyNumbers flush;
    state.deformed = true;
    ContactRegion& region = state.regions[0];

    // Beam skeleton: the force splits over the beams and moves the anchor points.
    if (several == nullptr) {
      status |= load_beams(model, model.skeleton, region.origin.p0_W_m, region);
      state.lap(Stage::skeleton);
    }

    // Interpolation of the surface between anchor points and contact.
    if (several == nullptr) {
      formulas.interpolate(model.rest, region.ends.displacement_m, contact_point(model, region), state.field);
    } else {
      formulas.several.interpolate(model.rest, several->shapes, state.field);
    }
    state.lap(Stage::interpolation);

    // Local factor around the contact, if the scene has it.
    if (formulas.local_factor()) {
      if (several == nullptr) {
        formulas.apply_local_factor(model.rest, model.local, {region.points.count, region.extent.area_m2},
                                    region.origin.p0_W_m, state.field);
      } else {
        formulas.several.apply_local_factors(model.rest, model.local, several->shapes, state.field);
      }
      state.lap(Stage::local_factor);
    }

    // Normals of the deformed surface.
    if (has(parts, Parts::normals)) {
      update_normals(model.normals, state.field);
      state.lap(Stage::normals);
    }
  }
  return status;
}

}  // namespace touchstone::fast
