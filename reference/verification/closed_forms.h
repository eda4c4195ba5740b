// Closed forms that the solvers are compared with, each with its range and source. SI units; the tool is rigid.
#pragma once

#include "scene/model/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace touchstone::verification {

/// Modulus of contact with a rigid tool [Pa].
inline double contact_modulus_pa(double youngs_modulus_pa, double poissons_ratio) {
  return scene::Material{youngs_modulus_pa, poissons_ratio}.contact_modulus_pa();
}

/// Force of a contact and the radius of its edge.
struct Indentation {
  double force_n = 0.0;
  double contact_radius_m = 0.0;
};

/// Hertz: paraboloid of end radius R on a half space, F = 4/3 E* sqrt(R) d^(3/2), a = sqrt(R d). A ball for a << R.
/// K. L. Johnson, Contact Mechanics (1985), 4.22-4.24.
inline Indentation hertz(double E_star_pa, double R_m, double d_m) {
  return {4.0 / 3.0 * E_star_pa * std::sqrt(R_m) * std::pow(d_m, 1.5), std::sqrt(R_m * d_m)};
}

/// Largest pressure of Hertz's contact, 3 F / (2 pi a^2) [Pa].
inline double hertz_peak_pressure_pa(const Indentation& contact) {
  return 1.5 * contact.force_n / (M_PI * contact.contact_radius_m * contact.contact_radius_m);
}

/// Its pressure at a radius inside the contact [Pa]. Johnson, 4.22.
inline double hertz_pressure_pa(const Indentation& contact, double r_m) {
  return hertz_peak_pressure_pa(contact) * std::sqrt(1.0 - std::pow(r_m / contact.contact_radius_m, 2));
}

/// Stress of Hertz's contact on the axis, a depth z below the surface [Pa], tension positive: along the axis and across
/// it. Johnson, 3.45.
inline double hertz_axis_stress_zz_pa(const Indentation& contact, double z_m) {
  return -hertz_peak_pressure_pa(contact) / (1.0 + std::pow(z_m / contact.contact_radius_m, 2));
}
inline double hertz_axis_stress_rr_pa(const Indentation& contact, double poissons_ratio, double z_m) {
  const double z = z_m / contact.contact_radius_m;
  return -hertz_peak_pressure_pa(contact) *
         ((1.0 + poissons_ratio) * (1.0 - z * std::atan(1.0 / z)) - 0.5 / (1.0 + z * z));
}

/// Semi-axes of Hertz's contact of two surfaces whose curvatures add up to 1 / R' along the long axis and 1 / R'' along
/// the short one, R' > R'' [m], long one first. Johnson, 4.25-4.28.
inline std::pair<double, double> hertz_semi_axes_m(double E_star_pa, double R_long_m, double R_short_m,
                                                   double force_n) {
  // With k = b / a and complete elliptic integrals of modulus e, e^2 = 1 - k^2: R' / R'' = (E / k^2 - K) / (K - E).
  double low = 0.0, high = 1.0, k = 0.0, K = 0.0, E = 0.0, e = 0.0;
  for (int step = 0; step < 60; ++step) {
    k = 0.5 * (low + high);
    e = std::sqrt(1.0 - k * k);
    K = std::comp_ellint_1(e);
    E = std::comp_ellint_2(e);
    ((E / (k * k) - K) / (K - E) > R_long_m / R_short_m ? low : high) = k;
  }
  const double F1_cubed = 4.0 / (M_PI * e * e) * std::pow(k, 1.5) * std::sqrt((E / (k * k) - K) * (K - E));
  const double c_m = std::cbrt(0.75 * force_n * std::sqrt(R_long_m * R_short_m) / E_star_pa * F1_cubed);
  return {c_m / std::sqrt(k), c_m * std::sqrt(k)};
}

/// Sneddon: the ball itself on a half space in small strain, d = (a/2) ln((R+a)/(R-a)),
/// F = E* [ (a^2 + R^2)/2 ln((R+a)/(R-a)) - a R ]. I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47-57.
/// @param a_m  contact radius, below R
inline double sneddon_depth_m(double R_m, double a_m) { return a_m * std::atanh(a_m / R_m); }
inline double sneddon_force_n(double E_star_pa, double R_m, double a_m) {
  return E_star_pa * ((a_m * a_m + R_m * R_m) * std::atanh(a_m / R_m) - a_m * R_m);
}
/// The same by depth, a found by Newton's method.
inline Indentation sneddon(double E_star_pa, double R_m, double d_m) {
  double a_m = std::sqrt(R_m * d_m / (1.0 + d_m / R_m));  // below the root, inside the domain
  for (int k = 0; k < 50; ++k) {
    const double slope = std::atanh(a_m / R_m) + a_m * R_m / (R_m * R_m - a_m * a_m);
    double next_m = a_m - (sneddon_depth_m(R_m, a_m) - d_m) / slope;
    if (next_m >= R_m) next_m = 0.5 * (a_m + R_m);
    if (std::abs(next_m - a_m) <= 1e-15 * R_m) break;
    a_m = next_m;
  }
  return {sneddon_force_n(E_star_pa, R_m, a_m), a_m};
}

/// Flat punch of flat radius b with a fillet of radius e, contact radius a between b and b + e, in small strain:
/// Sneddon's solution for any profile f(r), d = a I[f'], F = 2 E* I[r^2 f'], I[g] = integral of g / sqrt(a^2 - r^2)
/// from 0 to a, with f' = (r - b) / sqrt(e^2 - (r - b)^2) on the fillet. By r = a sin t the integrals are smooth.
struct RoundedPunch {
  double depth_m = 0.0, force_n = 0.0;
};
inline RoundedPunch rounded_punch(double E_star_pa, double b_m, double e_m, double a_m) {
  RoundedPunch punch;
  const double begin = std::asin(b_m / a_m);
  constexpr int intervals = 2000;
  const double step = (M_PI_2 - begin) / intervals;
  for (int k = 0; k <= intervals; ++k) {  // Simpson's rule
    const double weight = (k == 0 || k == intervals ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * step / 3.0;
    const double r_m = a_m * std::sin(begin + k * step), up_m = r_m - b_m;
    const double slope = up_m / std::sqrt(e_m * e_m - up_m * up_m);
    punch.depth_m += weight * a_m * slope;
    punch.force_n += weight * 2.0 * E_star_pa * r_m * r_m * slope;
  }
  return punch;
}

/// Flat punch of radius a on a half space: F = 2 a E* d, and outside the surface settles by (2 d / pi) asin(a / r).
/// I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47-57.
inline double flat_punch_force_n(double E_star_pa, double a_m, double d_m) { return 2.0 * a_m * E_star_pa * d_m; }
inline double flat_punch_settlement_m(double a_m, double d_m, double r_m) {
  return M_2_PI * d_m * std::asin(std::min(1.0, a_m / r_m));
}

/// Pressure of the same at a radius below a: F / (2 pi a sqrt(a^2 - r^2)). Johnson, 3.34.
inline double flat_punch_pressure_pa(double E_star_pa, double a_m, double d_m, double r_m) {
  return flat_punch_force_n(E_star_pa, a_m, d_m) / (2.0 * M_PI * a_m * std::sqrt(a_m * a_m - r_m * r_m));
}

/// Cone of the given half angle from its axis: F = (2/pi) E* tan(angle) d^2, a = (2/pi) d tan(angle). Sneddon, as
/// above.
inline Indentation cone(double E_star_pa, double half_angle, double d_m) {
  return {M_2_PI * E_star_pa * std::tan(half_angle) * d_m * d_m, M_2_PI * d_m * std::tan(half_angle)};
}

/// The cone with a ball of radius rho in its tip, to which the flank is tangent at r0 = rho cos(angle): Sneddon's
/// integrals of f' = r / sqrt(rho^2 - r^2) up to r0 and cot(angle) from there to the contact radius a.
inline Indentation rounded_cone(double E_star_pa, double half_angle, double rho_m, double a_m, double& depth_m) {
  const double begin = std::asin(std::min(1.0, rho_m * std::cos(half_angle) / a_m)), flank = 1.0 / std::tan(half_angle);
  constexpr int intervals = 2000;
  double depth = 0.0, force = 0.0;
  for (const bool tip : {true, false}) {
    const double from = tip ? 0.0 : begin, to = tip ? begin : M_PI_2, step = (to - from) / intervals;
    for (int k = 0; k <= intervals; ++k) {  // Simpson's rule over r = a sin t
      const double weight = (k == 0 || k == intervals ? 1.0 : k % 2 == 1 ? 4.0 : 2.0) * step / 3.0;
      const double r_m = a_m * std::sin(from + k * step);
      const double slope = tip ? r_m / std::sqrt(rho_m * rho_m - r_m * r_m) : flank;
      depth += weight * a_m * slope;
      force += weight * 2.0 * E_star_pa * r_m * r_m * slope;
    }
  }
  depth_m = depth;
  return {force, a_m};
}

/// Incompressible neo-Hookean bar: force over rest area at stretch lam, P = mu (lam - lam^-2); negative in compression.
/// Laterally free, P = lam sigma_1 / lam with sigma_1 - sigma_2 = mu (lam^2 - 1/lam) and sigma_2 = 0.
inline double neo_hookean_bar_pa(double mu_pa, double lam) { return mu_pa * (lam - 1.0 / (lam * lam)); }

/// The same for any Poisson's ratio, W = mu/2 (J^(-2/3) I1 - 3) + kappa/2 (J - 1)^2: the lateral stretch makes the
/// lateral stress mu/3 J^(-5/3) (lat^2 - lam^2) + kappa (J - 1), J = lam lat^2, vanish, and P = sigma lat^2.
inline double neo_hookean_bar_pa(const scene::Material& material, double lam) {
  const double mu = material.shear_modulus_pa();
  if (material.poissons_ratio == 0.5) return neo_hookean_bar_pa(mu, lam);
  const double kappa = material.bulk_modulus_pa();
  const auto stresses = [&](double lat) {
    const double J = lam * lat * lat, deviator = mu * std::pow(J, -5.0 / 3.0) * (lat * lat - lam * lam) / 3.0;
    const double pressure = kappa * (J - 1.0);
    return std::pair(deviator + pressure, -2.0 * deviator + pressure);  // lateral, axial
  };
  double low = 0.1, high = 10.0;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (stresses(middle).first < 0.0 ? low : high) = middle;
  }
  return stresses(low).second * low * low;
}

/// Incompressible neo-Hookean block in plane strain, free on the other sides: stretch under a force over rest area
/// P = mu (lam - lam^-3), found by Newton's method. Code_Aster SSNV187 with mu = 2 C10.
inline double plane_strain_stretch(double mu_pa, double P_pa) {
  double lam = 1.0;
  for (int k = 0; k < 50; ++k) {
    lam -= (lam - std::pow(lam, -3) - P_pa / mu_pa) / (1.0 + 3.0 * std::pow(lam, -4));
  }
  return lam;
}

/// A ball of radius b with a concentric one of radius a inside, in small strain; its surface is moved out by strain *
/// b: the radial stress there. In the outer part u = B r + C / r^2, inside u = A r; displacement and stress 3 K A and
/// 3 K B - 4 mu C / r^3 are continuous. R. M. Christensen, Mechanics of Composite Materials (1979), 2.3.
inline double two_ball_stress_pa(const scene::Material& outer, const scene::Material& inner, double a_m, double b_m,
                                 double strain) {
  const double K = outer.bulk_modulus_pa(), mu = outer.shear_modulus_pa(), K_inner = inner.bulk_modulus_pa();
  const double share = std::pow(a_m / b_m, 3);
  // C = c a^3 with 3 K_inner (B + c) = 3 K B - 4 mu c, and B + c share = strain.
  const double c_over_B = 3.0 * (K - K_inner) / (3.0 * K_inner + 4.0 * mu);
  const double B = strain / (1.0 + c_over_B * share);
  return 3.0 * K * B - 4.0 * mu * c_over_B * B * share;
}

/// A ball of radius a in an infinite body that is stretched far away by a strain E without change of volume: inside,
/// the strain is `inside` E; outside, u = (1 + f) E x + g x (x . E x), with f and g of the distance r. J. D. Eshelby,
/// Proc. R. Soc. A 241 (1957) 376-396; the field outside is that of a couple of forces and of its second derivatives.
struct BallInStretch {
  double a_m, inside, f_a, mu_pa, mu_inner_pa, nu;
  BallInStretch(const scene::Material& outer, const scene::Material& inner, double radius_m)
      : a_m(radius_m),
        mu_pa(outer.shear_modulus_pa()),
        mu_inner_pa(inner.shear_modulus_pa()),
        nu(outer.poissons_ratio) {
    const double beta = 2.0 * (4.0 - 5.0 * nu) / (15.0 * (1.0 - nu));
    inside = 1.0 / (1.0 + beta * (mu_inner_pa / mu_pa - 1.0));
    f_a = (inside - 1.0) / (3.2 - 4.0 * nu);
  }
  [[nodiscard]] double f(double r_m) const {
    const double t = a_m / r_m;
    return f_a * (2.0 * (1.0 - 2.0 * nu) * std::pow(t, 3) + 1.2 * std::pow(t, 5));
  }
  [[nodiscard]] double g_per_m2(double r_m) const {
    const double t = a_m / r_m;
    return 3.0 * f_a * (std::pow(t, 3) - std::pow(t, 5)) / (r_m * r_m);
  }
  /// Work of the forces on a ball's surface of radius r > a with the displacement E x, over E : E [N m]; by Betti's
  /// theorem with the body without a ball inside.
  [[nodiscard]] double work_nm(double r_m) const {
    const double sum = (1.0 + f(r_m)) / 3.0 + 2.0 / 15.0 * g_per_m2(r_m) * r_m * r_m;
    return 2.0 * mu_pa * 4.0 * M_PI * std::pow(r_m, 3) * sum +
           2.0 * (mu_inner_pa - mu_pa) * inside * 4.0 / 3.0 * M_PI * std::pow(a_m, 3);
  }
};

/// Inflation of a thick incompressible neo-Hookean sphere, inner radius A, outer B, outside free: inner pressure at
/// inner stretch la, p = 2 mu [1/lb - 1/la + (lb^-4 - la^-4) / 4], lb^3 = 1 + (la^3 - 1)(A/B)^3. A. E. Green, W. Zerna,
/// Theoretical Elasticity (1968), 3.10; from dp/dlam = 2 mu (lam^-2 + lam^-5) between la and lb.
inline double thick_sphere_pressure_pa(double mu_pa, double A_m, double B_m, double la) {
  const double lb = std::cbrt(1.0 + (la * la * la - 1.0) * std::pow(A_m / B_m, 3));
  return 2.0 * mu_pa * (1.0 / lb - 1.0 / la + 0.25 * (std::pow(lb, -4) - std::pow(la, -4)));
}

/// Where the incompressible sphere's material radius R goes, r^3 = R^3 + (la^3 - 1) A^3.
inline double thick_sphere_radius_m(double A_m, double la, double R_m) {
  return std::cbrt(R_m * R_m * R_m + (la * la * la - 1.0) * A_m * A_m * A_m);
}

/// Tip deflection of a cantilever of length l under a tip force F, stiffness E2 I2 on la < x < lb and E1 I1 elsewhere,
/// x from the fixed end: F [ (l^3/3 - k) / (E1 I1) + k / (E2 I2) ], k = ((l - la)^3 - (l - lb)^3) / 3, because the
/// bending moment F (l - x) works once more along the same line (unit load). S. Timoshenko, Strength of Materials I.
inline double cantilever_tip_m(double F_n, double l_m, double E1I1_nm2, double E2I2_nm2 = 1.0, double la_m = 0.0,
                               double lb_m = 0.0) {
  const double k = (std::pow(l_m - la_m, 3) - std::pow(l_m - lb_m, 3)) / 3.0;
  return F_n * ((l_m * l_m * l_m / 3.0 - k) / E1I1_nm2 + k / E2I2_nm2);
}

}  // namespace touchstone::verification
