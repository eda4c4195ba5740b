// Displacement of a half space under a round patch of pressure and shear, at every vertex of a surface.
//
// With G the shear modulus, z into the half space and V the potential of the pressure, total force 1,
//   u_r = -((1 - 2 nu) r dchi/dr + z r dV/dr) / (4 pi G r),   u_z = (2 (1 - nu) V - z dV/dz) / (4 pi G),
// dchi/dz = V. The pressure is that of a ball, (a^2 - r^2)^(1/2), mixed with that of a flat punch, (a^2 - r^2)^(-1/2):
// sources on the axis from z = -ia to ia of density (3/4) (a^2 - s^2) / a^3 and 1 / (2 a). Both have closed forms in
// the oblate coordinates r^2 = (a^2 + l^2) (1 - c^2), z = l c (A. E. H. Love, Q. J. Math. 10 (1939) 161-175; I. N.
// Sneddon 1965). Some radii away the second moment of the sources is enough.
//
// Shear along x with the same distributions, dpsi/dz = chi (K. L. Johnson, Contact Mechanics (1985), 3.6):
//   u_x = (2 V + 2 nu psi_xx - z chi_xx) / (4 pi G),   u_y = (2 nu psi_xy - z chi_xy) / (4 pi G),
//   u_z = ((1 - 2 nu) chi_x - z V_x) / (4 pi G).
//
// A radial double force, that is forces of Cerruti along x and y drawn apart, whose displacement on the plane is
// A / r^2:
//   u_r = A r (1 - 3 k z^2 / rho^2) / rho^3,   u_z = A k z (2 nu - 3 z^2 / rho^2) / rho^3,   k = 1 / (2 (1 - nu)).
#pragma once

#include "fast/response/finite_strain.h"
#include "fast/surface/surface_patches.h"
#include "scene/model/scene.h"

#include <cstdint>

namespace touchstone::fast {

/// The load, its patch on a plane that touches the body from outside.
struct SpreadLoad {
  scene::Vec3 center_m = scene::Vec3::Zero();
  scene::Vec3 normal = scene::Vec3::UnitZ();  ///< outward; the force on the body is against it
  double force_n = 0.0;
  double radius_m = 0.0;  ///< a
  double flat = 0.0;      ///< share of the flat punch's pressure
  // Of the pressure alone, by finite strain:
  double widening = 1.0;  ///< radius of the contact over a
  double peaked = 0.0;    ///< share of a pressure as (1 - r^2)^(3/2)
  // Friction on the body, along the surface: the parts with the ball's and the flat punch's distribution.
  scene::Vec3 ball_shear_n = scene::Vec3::Zero(), punch_shear_n = scene::Vec3::Zero();
  // Under a ball, what finite strain and the body's curvature add; without a table nothing.
  const BallField* field = nullptr;
  double field_m = 0.0;     ///< D a / R
  double body_share = 0.0;  ///< curvature of the body over that of both
  /// Far away: a radial double force with this outward displacement on the plane times r^2.
  [[nodiscard]] double apart_m3() const noexcept {
    const double a_m = widening * radius_m;
    return field == nullptr ? 0.0 : field_m * field->far(body_share) * a_m * a_m;
  }
  [[nodiscard]] scene::Vec3 shear_n() const noexcept { return ball_shear_n + punch_shear_n; }
};

/// Elastic numbers of the formulas.
struct HalfSpace {
  explicit HalfSpace(const scene::Material& material);
  double scale_m2_per_n;  ///< 1 / (4 pi G)
  double nu;
  /// Normal displacement of the surface by a point load, times the distance: (1 - nu^2) / (pi E).
  [[nodiscard]] double surface_m2_per_n() const noexcept { return 2.0 * (1.0 - nu) * scale_m2_per_n; }
  /// Strength of a radial double force by its displacement on the plane times r^2.
  [[nodiscard]] double double_force_nm(double apart_m3) const noexcept { return apart_m3 / surface_m2_per_n(); }
};

/// At one point, by the closed forms [m].
[[nodiscard]] scene::Vec3 spread_displacement_m(const SpreadLoad& load, const HalfSpace& half_space,
                                                const scene::Vec3& x_m) noexcept;

/// Shear of the patch there [Pa].
[[nodiscard]] scene::Vec3 spread_shear_pa(const SpreadLoad& load, const scene::Vec3& x_m) noexcept;

/// Pressure of the patch, along its normal, at a point as far from its axis [Pa]; 0 outside. On a flat punch's rim,
/// where it is infinite, that very near it.
[[nodiscard]] double spread_pressure_pa(const SpreadLoad& load, const scene::Vec3& x_m) noexcept;

/// Distance from the load's centre below which a vertex is near, over the radius: beyond, the second moment leaves out
/// less than 1e-3.
inline constexpr double near_radii = 3.0;

/// At all vertices: those beyond near_radii get their displacement [m], the others are listed.
/// @param near  places of vertices, room for all of them
/// @returns their number
std::int32_t spread_displacements_m(const SpreadLoad& load, const HalfSpace& half_space, const Columns3& rest_m,
                                    Columns3& out_m, std::int32_t* near) noexcept;

}  // namespace touchstone::fast
