// Stresses and strains at the beam ends, section V-C, equations (8) and (9), and the force they make on another contact
// region, section VI-A.
#pragma once

#include "fast/skeleton/beam_skeleton.h"

#include <array>
#include <span>

namespace touchstone::fast {

/// Components in the order of equation (7): x, y, z, xy, yz, zx.
using SixComponents = std::array<double, 6>;

/// Stress and strain on the centre line of a beam at its anchor point.
struct BeamStress {
  SixComponents stress_pa{};  ///< sigma_x, sigma_y, sigma_z, tau_xy, tau_yz, tau_zx in the beam's frame
  SixComponents strain{};     ///< epsilon_x, epsilon_y, epsilon_z, gamma_xy, gamma_yz, gamma_zx in the beam's frame
  scene::Mat3 axes = scene::Mat3::Identity();     ///< columns x_i, y_i, z_i in the world frame
  scene::Mat3 stress_W_pa = scene::Mat3::Zero();  ///< the stress in the world frame; tension is positive
  scene::Mat3 strain_W = scene::Mat3::Zero();     ///< the strain tensor in the world frame, gamma / 2 off its diagonal
};

/// Shear stress on the centre line of a beam of circular section over the mean one, F_y / s:
/// (3 + 2 nu) / (2 (1 + nu)).
///
/// The paper leaves the bending function phi_1 of tau_yx = F_y / (2 (1 + nu) I_z) (d phi_1 / d y + nu z^2 -
/// (1 + nu) y^2) open. Equilibrium makes it harmonic, and a disc of radius R whose rim is free of shear gives
/// phi_1 = (3 + 2 nu) R^2 y / 4 + (1 + 2 nu) (y^3 - 3 y z^2) / 12. On the centre line that leaves (3 + 2 nu) R^2 / 4,
/// and R^2 / I_z = 4 / s.
[[nodiscard]] double centre_shear_factor(double poissons_ratio) noexcept;

/// Equation (9), D^-1. It is never inverted and has no trouble with nu = 0.5 (errata E11).
[[nodiscard]] Eigen::Matrix<double, 6, 6> inverse_elasticity_per_pa(double youngs_modulus_pa,
                                                                    double poissons_ratio) noexcept;

/// Stress at the anchor end of every beam under the forces of the last split, and its strain by equation (8).
/// sigma_x = F_x / s: bending adds none on the centre line (errata E10). tau_xy = centre_shear_factor F_y / s, y_i on
/// the side of F_i's part across the beam. The anchor point lies outside the inclusions, in the body's own material.
/// @param stress one per beam; all zero where the contact has no force
void beam_stresses(const SkeletonView&, const BeamEnds&, std::span<BeamStress> stress) noexcept;

/// Stress at a surface point [Pa], world frame: the anchor points' of its patch, by the weights that also interpolate
/// the displacements (sections V-E and VI-A).
/// @param patch_anchor the patch's entry of AnchorPoints::patches(); @param place the point's place in it
[[nodiscard]] scene::Mat3 interpolated_stress_pa(std::span<const BeamStress>,
                                                 const std::array<int, patch_corners_max>& patch_anchor,
                                                 const PatchPlace& place) noexcept;

/// The stress integrated over a contact region that is small against the body, sigma n A [N]: the force of the outside
/// on the body there. The tool is subject to the opposite.
/// @param normal outward, unit length; @param area_m2 of the region
[[nodiscard]] scene::Vec3 stress_force_n(const scene::Mat3& stress_W_pa, const scene::Vec3& normal,
                                         double area_m2) noexcept;

}  // namespace touchstone::fast
