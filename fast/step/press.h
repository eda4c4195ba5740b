// What one contact region does in a tick: direction, depths, shares, force, friction, equivalent point contact
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
  bool first = true;   ///< nothing is known of the last tick
};

/// Direction of deformation of a region that has just come into being in a tick that began apart. Where one tick has
/// brought the tool further in than its samples lie apart, the pose a spacing behind first touch is looked for, or a
/// fast tool would be taken to have come from the nearest side of the body.
[[nodiscard]] scene::Vec3 entry_direction(const FastModel&, const Motion&, const InsideSummary&, FastState&) noexcept;

/// A region's direction in a further tick.
[[nodiscard]] scene::Vec3 next_direction(const ContactRegion& region, const InsideSummary& inside) noexcept;

/// The points of the tool that are inside the rest surface: samples in the published form, cells in the corrected one.
/// @param margin_m as in FindCells
InsideSummary find_points(const FastModel&, const Placement&, double margin_m, RegionPoints&, CellScratch&) noexcept;

/// Finds the points and the direction of the first region, which has all of the tool that is inside.
/// @returns whether the region has come into being in this tick; state.region_count is 0 where nothing is inside
bool find_one_region(const FastModel&, const Motion&, FastState&) noexcept;

/// Depths, origin and shares of a region whose points and direction are known: what no constant of the laws, the
/// skeleton or the local factor has a part in.
StepStatus measure(const FastModel&, const Motion&, ContactRegion&, FastState&) noexcept;
/// Force with friction and the equivalent point contact of a region that has been measured.
/// @param created in this tick: friction has no way behind it
StepStatus push(const FastModel&, const Motion&, bool created, ContactRegion&, FastState&) noexcept;
/// Both.
StepStatus press(const FastModel&, const Motion&, bool created, ContactRegion&, FastState&) noexcept;

/// The equivalent point contact as a point of the interpolation.
[[nodiscard]] ContactPoint contact_point(const FastModel&, const ContactRegion&) noexcept;

}  // namespace touchstone::fast
