// Contact laws: the paper's, equation (1) and appendix II, the static force of a Duffing oscillator, and the same with
// its linear constant in proportion to the contact's radius.
#pragma once

#include "scene/model/scene.h"

#include <algorithm>

namespace touchstone::fast {

/// F = k1 D + k3 D^3 with k1 = m w0^2 and k3 = (3/4) m b0^2 eps, equation (1).
/// Errata E1: the 3/4 stays inside k3, since only k1 and k3 can be identified. For k3 < 0 the printed absolute
/// value would let the force fall to zero and rise again, so both formulations saturate at the peak: beyond
/// D* = sqrt(k1 / (3 |k3|)) the force stays at F* = (2/3) k1 D*.
/// All members take D >= 0 or F >= 0, pass NaN on and never throw.
class DuffingLaw {
 public:
  /// @param k1_n_per_m >= 0; @param k3_n_per_m3 any sign; where k1 = 0 and k3 <= 0 there is no force at any depth
  DuffingLaw(double k1_n_per_m, double k3_n_per_m3) noexcept;

  /// Force magnitude F at depth D [N].
  [[nodiscard]] double force_n(double depth_m) const noexcept {
    const double D = depth_m > peak_depth_m_ ? peak_depth_m_ : depth_m;
    return D * (k1_ + k3_ * D * D);
  }
  /// F / D, its limit k1 at D = 0 [N/m].
  [[nodiscard]] double secant_n_per_m(double depth_m) const noexcept {
    if (depth_m > peak_depth_m_) return force_n(peak_depth_m_) / depth_m;
    return k1_ + k3_ * depth_m * depth_m;
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

/// Radius a = sqrt(A / pi) of the disc with the contact's area [m].
/// @param area_m2 RegionExtent::area_m2, the tool's area under the rest surface projected along d
[[nodiscard]] double contact_radius_m(double area_m2) noexcept;

/// The scene's contact law. At a given size of the contact every law is a DuffingLaw, so that sums over a region's
/// points know no other.
/// - duffing: equation (1), whatever the size. A region's force is then a mean that does not grow with its area.
/// - area_aware, errata E7: F = k1_per_radius a D + k3 D^3, in the manner of a flat punch, whose force is 2 a E* D. It
///   is no part of the paper. The size is that of the tick, so the force has no potential in D alone.
class ContactLaw {
 public:
  explicit ContactLaw(const scene::Contact& contact) noexcept : contact_(contact) {}
  /// @param contact_radius_m >= 0
  [[nodiscard]] DuffingLaw at(double contact_radius_m) const noexcept;

 private:
  scene::Contact contact_;
};

}  // namespace touchstone::fast
