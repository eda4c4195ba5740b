// The stages of a tick that only a tool with several contact regions has, section VI: each region is pressed, in the
// order of creation, on the body that the earlier ones have deformed.
#pragma once

#include "fast/step/stages.h"

namespace touchstone::fast {

/// Sorts the points into clusters and follows the regions from the last tick to this one; each has its points then.
StepStatus track_regions(const FastModel&, RegionPoints&, FastState&) noexcept;

/// Region i is evaluated on Shape_{i-1}: the rest-point search maps its points to the rest shape through the
/// displacement of that shape.
void meet_deformed_body(const FastModel&, ContactRegion&, FastState&) noexcept;

/// Beam skeleton of region k on Shape_{i-1}, and Shape_i for the regions after it.
StepStatus deform_body(const FastModel&, std::size_t k, FastState&) noexcept;

/// F_Si = F_ii + sum_{j > i} F_ji, F_ji from the stresses of skeleton j at region i (section VI-A).
void add_later_forces(const FastModel&, FastState&) noexcept;

}  // namespace touchstone::fast
