// A tick with several contact regions, section VI: each pressed, in the order of creation, on the body that the earlier
// ones have deformed.
#pragma once

#include "fast/skeleton/beam_stress.h"
#include "fast/contact/contact_regions.h"
#include "fast/step/press.h"
#include "fast/contact/pull_back.h"
#include "fast/surface/region_shapes.h"

#include <span>
#include <vector>

namespace touchstone::fast {

/// State and scratch memory of such a tick besides the regions. Storage is fixed at construction.
struct SeveralRegionsState {
  explicit SeveralRegionsState(const FastModel& model);

  ClusterScratch scratch;
  RegionTracker tracker;
  std::vector<Cluster> clusters;
  std::vector<TrackedRegion> tracked;
  PullBackScratch pull_back;
  CurrentEnds ends;
  ShapeStack shapes;
  std::vector<std::vector<BeamStress>> stress_pa;  ///< per region
  std::vector<int> order;                          ///< of creation: places in FastState::regions
  double bulge_m = 0.0;                            ///< largest outward displacement of the last tick's surface, a bound

  [[nodiscard]] std::size_t memory_bytes() const noexcept;
};

/// Finds, tracks and presses all regions. Contact of region i with Shape_{i-1} is evaluated by a rest-point search
/// for its points (pull_back.h). F_Si = F_ii + sum_{j > i} F_ji, F_ji from the stresses of skeleton j at region i.
StepStatus press_several_regions(const FastModel&, const Motion&, FastState&) noexcept;

/// Shape_m of the regions pressed last.
StepStatus shape_several_regions(const FastModel&, FastState&) noexcept;

/// Effects of what the paper leaves undefined about several regions (errata E18), for one pose.
struct OrderSpread {
  double spread_rel = 0.0;       ///< largest change of the total force under another order of creation, over that force
  double equilibrium_rel = 0.0;  ///< |force on the tool - force of the support| over the force on the tool
};

/// Presses the regions of the last tick again in other orders: all of them for up to 4 regions, else the reverse and
/// the rotations. Leaves the state as it was. Not for a real-time step.
[[nodiscard]] OrderSpread order_spread(const FastModel&, FastState&);

}  // namespace touchstone::fast
