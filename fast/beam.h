// One Bernoulli-Euler beam with one end fixed, sections V-C and V-D, equations (2), (3), (10) to (14).
// x runs along the beam from the fixed end (the anchor point) to the loaded end (the contact).
#pragma once

#include <span>

namespace touchstone::fast {

/// A stretch of a beam of one material.
struct BeamSegment {
  double length_m = 0.0;
  double youngs_modulus_pa = 0.0;  ///< E
  double area_m2 = 0.0;            ///< s
  double second_moment_m4 = 0.0;   ///< I_z
};

/// I_z = s^2 / (4 pi): a disc of area s, whatever the axis (errata E7, E17: the paper never says).
[[nodiscard]] double second_moment_m4(double area_m2) noexcept;

/// y' / F_y of the loaded end [m/N]: the sum over the segments of the integral of (l - x)^2 / (E I_z).
/// One segment gives equation (2), l^3 / (3 E I_z). Errata E12: equation (10) as printed has the wrong moment arm and
/// halves this. Errata E13: for a core between l_a and l_b this is equation (11) with
/// k = ((l - l_a)^3 - (l - l_b)^3) / 3 in place of the printed k.
/// @param segments from the fixed end to the loaded end
[[nodiscard]] double bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept;

/// Delta x / F_x of the loaded end [m/N]: springs in series, the sum of l_k / (E_k s_k). One segment gives equation
/// (3). Errata E14: equations (12) and (13) need the segments' own shortenings; this does not.
[[nodiscard]] double axial_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept;

}  // namespace touchstone::fast
