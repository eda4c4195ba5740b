// Contact law of the paper, equation (1) and appendix II: the static force of a Duffing oscillator.
#pragma once

#include "scene/scene.h"

#include <algorithm>

namespace touchstone::fast {

/// F = k1 D + k3 D^3 with k1 = m w0^2 and k3 = (3/4) m b0^2 eps, equation (1).
/// Errata E1: the 3/4 stays inside k3, since only k1 and k3 can be identified. For k3 < 0 the printed absolute
/// value would let the force fall to zero and rise again, so both formulations saturate at the peak: beyond
/// D* = sqrt(k1 / (3 |k3|)) the force stays at F* = (2/3) k1 D*.
/// All members take D >= 0 or F >= 0, pass NaN on and never throw.
class DuffingLaw {
 public:
  /// @param k1_n_per_m >= 0; @param k3_n_per_m3 any sign, > 0 where k1 = 0
  DuffingLaw(double k1_n_per_m, double k3_n_per_m3) noexcept;

  /// Force magnitude F at depth D [N].
  [[nodiscard]] double force_n(double depth_m) const noexcept {
    const double D = depth_m > peak_depth_m_ ? peak_depth_m_ : depth_m;
    return D * (k1_ + k3_ * D * D);
  }
  /// dF/dD [N/m]; zero where the force is saturated.
  [[nodiscard]] double slope_n_per_m(double depth_m) const noexcept;
  /// Work done by the tool from D = 0 [J]; its slope is the force.
  [[nodiscard]] double energy_j(double depth_m) const noexcept;
  /// The depth whose force is F, in closed form [m]; on the rising branch for k3 < 0, the peak for F above it.
  [[nodiscard]] double depth_m(double force_n) const noexcept;
  /// Depth beyond which the force is saturated [m]; infinite for k3 >= 0.
  [[nodiscard]] double peak_depth_m() const noexcept { return peak_depth_m_; }

 private:
  double k1_, k3_;
  double peak_depth_m_;
};

}  // namespace touchstone::fast
