// The stages of a tick: the formulas of fast/contact, fast/skeleton and fast/surface on the state. Those of a region do
// nothing where it has no points.
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"

namespace touchstone::fast {

[[nodiscard]] Placement placement(const scene::Pose& pose) noexcept;

/// Takes a pose over into state.motion. @returns false where it is no finite placement, and changes nothing then
[[nodiscard]] bool move_to(const scene::Pose& asked, FastState& state) noexcept;

/// The points of the tool that are inside the rest surface: samples in the published form, cells in the corrected one.
/// @param margin_m as in FindCells
InsideSummary find_points(const FastModel&, const Placement&, double margin_m, RegionPoints&, CellScratch&) noexcept;

/// All points are one region, if there are any.
void keep_one_region(const RegionPoints& points, const InsideSummary& inside, FastState&) noexcept;

/// Direction of deformation d (section III).
void find_direction(const FastModel&, ContactRegion&, FastState&) noexcept;

/// Depths along d, limited to a part of the body's thickness, and the origin of deformation p_0.
StepStatus measure_depths(const FastModel&, ContactRegion&, FastState&) noexcept;

/// Contact force along d (section IV-A). @param law at the region's size
StepStatus contact_force(const DuffingLaw& law, ContactRegion&, FastState&) noexcept;

/// Displacement D of the equivalent point contact: the depth along d whose force is the region's or, with friction
/// (sections IV-B and IV-C), what its return mapping gives. Friction adds its force and drags the deformation origin.
void friction_and_point_contact(const FastModel&, const DuffingLaw& law, ContactRegion&, FastState&) noexcept;

/// Beam skeleton: splits the region's force over the beams, which moves the anchor points (section V).
/// @param p0_m deformation origin on the surface that the region meets
StepStatus load_beams(const FastModel&, const SkeletonView&, const scene::Vec3& p0_m, ContactRegion&) noexcept;

/// The equivalent point contact as a point of the interpolation.
[[nodiscard]] ContactPoint contact_point(const FastModel&, const ContactRegion&) noexcept;

}  // namespace touchstone::fast
