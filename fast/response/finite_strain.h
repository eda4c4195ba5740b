// How finite strain changes the contact force and pressure of a half space.
#pragma once

namespace touchstone::fast {

/// x = d_m / a, where d_m is the mean depth of the overlap at rest and a the radius of a disc of its area. With no
/// depth everything is linear.
struct FiniteStrain {
  double c1 = 0.0, c2 = 0.0;  ///< of the force
  double k1 = 0.0;            ///< of the contact's radius
  double p1 = 0.0, p2 = 0.0;  ///< of the pressure
  /// Force over the linear one.
  [[nodiscard]] double factor(double x) const noexcept { return 1.0 - x * (c1 + c2 * x); }
  /// Radius of a ball's contact, seen along the load, over the linear one.
  [[nodiscard]] double widening(double x) const noexcept { return 1.0 + k1 * x; }
  /// Pressure in the middle of a ball's contact over the force per linear contact area: 3/2 in Hertz's.
  [[nodiscard]] double peak(double x) const noexcept { return 1.5 + x * (p1 + p2 * x); }
};

/// Those of the reference's neo-Hookean material, by Poisson's ratio alone: fitted once to its answers for a ball of
/// 10 mm on a cylinder and a block with nu = 0, 0.3 and 0.5, a parabola in between. See reports/response.md.
[[nodiscard]] FiniteStrain finite_strain(double poissons_ratio) noexcept;

}  // namespace touchstone::fast
