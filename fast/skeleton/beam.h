// One Bernoulli-Euler beam with one end fixed, sections V-C and V-D, equations (2), (3), (10) to (14).
// x runs along the beam from its anchor point to the contact. "Fixed" is the end that cannot move, "loaded" the other.
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

/// I_z = s^2 / (4 pi): a disc of area s, whatever the axis (errata E17: the paper does not give it).
[[nodiscard]] double second_moment_m4(double area_m2) noexcept;

/// y' / F_y of the contact end [m/N], fixed at the anchor point: the sum over the segments of the integral of
/// (l - x)^2 / (E I_z). One segment gives equation (2), l^3 / (3 E I_z). Errata E12: equation (10) as printed has the
/// wrong moment arm and halves this. Errata E13: for a core between l_a and l_b this is equation (11) with
/// k = ((l - l_a)^3 - (l - l_b)^3) / 3 in place of the printed k.
/// @param segments from the anchor point to the contact
[[nodiscard]] double bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept;

/// The same of the anchor end, released there and fixed at the contact (errata E10): the integral of x^2 / (E I_z). One
/// segment gives equation (2) again. Where materials differ the two differ: a soft stretch counts by its distance from
/// the end that moves.
/// @param segments from the anchor point to the contact
[[nodiscard]] double released_bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept;

/// Equations (11) and (14) as printed, k = (l_b^2 - l_a^2) l / 2 - (l_b^3 - l_a^3) / 6 for a core between l_a and l_b,
/// which is the integral of l x - x^2 / 2; of several cores each adds its own (errata E12, E13). Summed over all
/// segments in terms that are all positive, so that no core makes the compliance vanish or turn negative.
/// @param segments from the anchor point to the contact
[[nodiscard]] double printed_bending_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept;

/// Delta x / F_x of the loaded end [m/N]: springs in series, the sum of l_k / (E_k s_k), whichever end is loaded. One
/// segment gives equation (3).
[[nodiscard]] double axial_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept;

/// Equations (12) and (13) as printed need the segments' own shortenings, which nothing gives (errata E14). They are
/// closed here by equal strain along the beam, Delta x_k = Delta x l_k / l: F_x = s / l (sum of E_k l_k / l) Delta x.
[[nodiscard]] double printed_axial_compliance_m_per_n(std::span<const BeamSegment> segments) noexcept;

}  // namespace touchstone::fast
