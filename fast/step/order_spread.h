// Effect of the order of several contact regions, which the paper leaves open (errata E18).
#pragma once

#include "fast/step/model.h"
#include "fast/step/state.h"

namespace touchstone::fast {

/// Of one pose.
struct OrderSpread {
  double spread_rel = 0.0;       ///< largest change of the total force under another order of creation, over that force
  double equilibrium_rel = 0.0;  ///< |force on the tool - force of the support| over the force on the tool
};

/// Presses the regions of the last tick again in other orders: all of them for up to 4 regions, else the reverse and
/// the rotations. Leaves the state as it was. Not for a real-time step.
[[nodiscard]] OrderSpread order_spread(const FastModel&, FastState&);

}  // namespace touchstone::fast
