// How finite strain changes the contact force of a half space.
#pragma once

namespace touchstone::fast {

/// Force over the linear one: 1 - c1 x - c2 x^2, x = d_m / a, where d_m is the mean depth of the overlap at rest and a
/// the radius of a disc of its area. It is 1 as the depth goes to zero.
struct FiniteStrain {
  double c1 = 0.0, c2 = 0.0;
  [[nodiscard]] double factor(double x) const noexcept { return 1.0 - x * (c1 + c2 * x); }
};

/// The two numbers of the reference's neo-Hookean material, by Poisson's ratio alone: fitted once to its answers for a
/// ball of 10 mm pressed 6.5 mm into a block with nu = 0, 0.3 and 0.5, a parabola in between. See reports/response.md.
[[nodiscard]] FiniteStrain finite_strain(double poissons_ratio) noexcept;

}  // namespace touchstone::fast
