// The material law with pressure as its own unknown, from W = mu/2 (J^(-2/3) I1 - 3) + p (J - 1) - p^2 / (2 kappa).
// Eliminating p gives kappa/2 (J - 1)^2; kappa is infinite at nu = 0.5 and the last term is absent. Everything is
// written with H = F - 1, so that nothing cancels at small strain.
// Source: J. C. Simo, R. L. Taylor, K. S. Pister, Comput. Methods Appl. Mech. Eng. 51 (1985) 177-208.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

#include <cmath>

namespace touchstone::reference {

/// Stress and tangent of one point in the form the element needs, all traces over three directions. With l = grad v
/// the virtual work is tau : l, tau = tau_iso + pJ 1, and its linearisation at fixed p is
///   mu_bar (l_a : l_b) + S (l_a : l_b^T) + l_a : (l_b tau_0) + V tr l_a tr l_b
///     - 2/3 ((tau_0 : l_a) tr l_b + tr l_a (tau_0 : l_b)).
struct PointLaw {
  Eigen::Matrix3d tau_iso_pa;  ///< deviatoric Kirchhoff stress
  Eigen::Matrix3d tau_0_pa;    ///< tau_iso in finite strain, zero in small strain
  double pJ_pa = 0.0;
  double mu_bar_pa = 0.0;
  double S_pa = 0.0;
  double V_pa = 0.0;
  double J = 1.0;             ///< 1 in small strain, where the volume ratio stays out of the tangent
  double J_minus_1 = 0.0;     ///< volume change
  Eigen::Matrix3d F_inverse;  ///< identity in small strain
};

/// det(1 + H) - 1 without cancellation.
[[nodiscard]] inline double volume_change(const Eigen::Matrix3d& H) {
  const double trace = H.trace();
  const double second = 0.5 * (trace * trace - (H * H).trace());
  return trace + second + H.determinant();
}

/// Finite strain: tau_iso = mu J^(-2/3) dev b, mu_bar = mu J^(-2/3) tr b / 3, S = mu_bar - pJ, V = pJ - 2/3 mu_bar.
/// @param H displacement gradient; @param p_pa pressure unknown, tension positive
[[nodiscard]] inline PointLaw neo_hookean(const Eigen::Matrix3d& H, double mu_pa, double p_pa) {
  PointLaw law;
  law.J_minus_1 = volume_change(H);
  law.J = 1.0 + law.J_minus_1;
  law.F_inverse = (Eigen::Matrix3d::Identity() + H).inverse();
  const Eigen::Matrix3d b_minus_1 = H + H.transpose() + H * H.transpose();
  const double third = b_minus_1.trace() / 3.0;
  const double mu_J = mu_pa * std::pow(law.J, -2.0 / 3.0);
  law.tau_iso_pa = mu_J * (b_minus_1 - third * Eigen::Matrix3d::Identity());
  law.tau_0_pa = law.tau_iso_pa;
  law.mu_bar_pa = mu_J * (1.0 + third);
  law.pJ_pa = p_pa * law.J;
  law.S_pa = law.mu_bar_pa - law.pJ_pa;
  law.V_pa = law.pJ_pa - 2.0 / 3.0 * law.mu_bar_pa;
  return law;
}

/// Small strain, the same law's linearisation at rest: sigma = 2 mu dev(eps) + p 1, volume change tr(eps).
[[nodiscard]] inline PointLaw linear_elastic(const Eigen::Matrix3d& H, double mu_pa, double p_pa) {
  PointLaw law;
  law.J_minus_1 = H.trace();
  law.F_inverse.setIdentity();
  law.tau_iso_pa = mu_pa * (H + H.transpose() - 2.0 / 3.0 * H.trace() * Eigen::Matrix3d::Identity());
  law.tau_0_pa.setZero();
  law.mu_bar_pa = law.S_pa = mu_pa;
  law.V_pa = -2.0 / 3.0 * mu_pa;
  law.pJ_pa = p_pa;
  return law;
}

/// Strain energy per rest volume without the pressure terms: mu/2 (J^(-2/3) I1 - 3) [J/m^3].
[[nodiscard]] inline double isochoric_energy_per_m3(const Eigen::Matrix3d& H, double mu_pa) {
  const Eigen::Matrix3d F = Eigen::Matrix3d::Identity() + H;
  return 0.5 * mu_pa * (std::pow(F.determinant(), -2.0 / 3.0) * F.squaredNorm() - 3.0);
}

}  // namespace touchstone::reference
