// A rigid flat punch or ball pressed upright on a half space with Coulomb's friction: sticks inside, slips outside.
#pragma once

namespace touchstone::verification {

/// Ratios that hold at every load, since the problem is similar to itself; no units.
struct PressedWithFriction {
  double stick_radius = 1.0;     ///< over the contact's, the same for punch and ball
  double punch_stiffness = 1.0;  ///< force at a depth over that without friction, and its slope for the ball
  double ball_depth = 1.0;       ///< depth at a contact radius, over a^2 / R
  double ball_force = 1.0;       ///< force at a depth over Hertz's
};

/// D. A. Spence, Proc. R. Soc. Lond. A 305 (1968) 55-80 and J. Elasticity 5 (1975) 297-319: while it is pressed, a
/// ball's increments are those of flat punches of the present contact radius, so that both stick inside the same part.
/// In units of the punch's radius and depth and of E / (2 (1 - nu^2)), its pressure p and outward shear q satisfy
///   N p - g int_r^1 q ds = 1 for r < 1,   T q - (g / r) int_0^r p s ds = 0 for r < c,   q = mu p for c < r < 1,
/// g = (1 - 2 nu) / (2 (1 - nu)), N and T the displacements of normal and radial ring loads (Johnson, Contact
/// Mechanics, 3.8 and 7.1), and c leaves q without a singularity. Solved by collocation on rings that are finer towards
/// c and the rim.
/// @param rings  in each of four parts of the radius; at 24 the ratios are within 1.5e-4 of those at 40, the stick
/// radius
///               within 0.001
/// @throws std::domain_error where mu is not above 0, or c not between 0.1 and 0.998; at nu = 0.5 nothing slips or
///         sticks, and all ratios are 1
[[nodiscard]] PressedWithFriction pressed_with_friction(double poissons_ratio, double friction, int rings = 24);

}  // namespace touchstone::verification
