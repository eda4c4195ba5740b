// One contact region in one tick: direction, depths, mass weights, force, friction, equivalent point contact
// (sections III, IV and appendix III).
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"

namespace touchstone::fast {

[[nodiscard]] Placement placement(const scene::Pose& pose) noexcept;

/// The tool's poses around a tick.
struct Motion {
  scene::Pose pose;    ///< now, orientation of unit length
  Placement at;        ///< the same
  scene::Pose before;  ///< in the last tick; equal to `pose` in the first
  bool first = true;   ///< there is no last tick
};

/// Direction of deformation of a new region in a tick that began without contact. If the tool has entered by more than
/// the spacing of its samples, the pose one spacing behind first contact is used. Otherwise the direction of a fast
/// tool would be that of the nearest side of the body.
[[nodiscard]] scene::Vec3 entry_direction(const FastModel&, const Motion&, const InsideSummary&, FastState&) noexcept;

/// A region's direction in a later tick.
[[nodiscard]] scene::Vec3 next_direction(const ContactRegion& region, const InsideSummary& inside) noexcept;

/// The points of the tool that are inside the rest surface: samples in the published form, cells in the corrected one.
/// @param margin_m as in FindCells
InsideSummary find_points(const FastModel&, const Placement&, double margin_m, RegionPoints&, CellScratch&) noexcept;

/// Finds the points and the direction of the first region, which contains all points inside.
/// @returns whether the region is new in this tick; state.region_count is 0 where nothing is inside
bool find_one_region(const FastModel&, const Motion&, FastState&) noexcept;

/// Depths, origin and mass weights of a region whose points and direction are known. They do not depend on the
/// constants of the laws, the skeleton or the local factor, so a fit computes them once.
StepStatus measure(const FastModel&, const Motion&, ContactRegion&, FastState&) noexcept;
/// Force with friction and the equivalent point contact of a region that has been measured.
/// @param created in this tick: friction has no tangential displacement yet
StepStatus push(const FastModel&, const Motion&, bool created, ContactRegion&, FastState&) noexcept;
/// Both.
StepStatus press(const FastModel&, const Motion&, bool created, ContactRegion&, FastState&) noexcept;

/// The equivalent point contact as a point of the interpolation.
[[nodiscard]] ContactPoint contact_point(const FastModel&, const ContactRegion&) noexcept;

}  // namespace touchstone::fast
