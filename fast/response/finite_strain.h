// How finite strain changes the contact force, pressure and shape of a half space, and a body's curvature the shape.
#pragma once

#include <array>
#include <cstddef>

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

/// What the linear displacement of the surface under and beside a ball lacks, over D a / R: D the indentation, a the
/// contact's radius, 1 / R the sum of the curvatures of ball and body. It is of second order in a / R, and where the
/// body is curved, of first order in the body's share of 1 / R. Far away it is that of a radial double force, which
/// falls off as 1 / r^2.
class BallField {
 public:
  /// Tables of the same answers of the reference, a parabola in between. See reports/response.md.
  explicit BallField(double poissons_ratio) noexcept;

  struct Value {
    double outward;  ///< along the surface, away from the axis
    double up;       ///< along the normal; under the ball it is not used
  };
  /// @param rho  distance from the axis over a
  /// @param body_share  curvature of the body over that of both
  [[nodiscard]] Value at(double rho, double body_share) const noexcept;
  /// Beyond: outward along a plane, times rho^2.
  [[nodiscard]] double far(double body_share) const noexcept { return reach * reach * at(reach, body_share).outward; }

  static constexpr double reach = 3.0;  ///< of the tables

 private:
  static constexpr std::size_t steps = 15;
  using Table = std::array<double, steps + 1>;
  Table outward_{}, up_{};
};

}  // namespace touchstone::fast
