// Friction of a contact region: whether it sticks or slips, and the skewed deformation and
// force that follow (sections IV-B and IV-C).
#pragma once

#include "fast/contact/region_force.h"

namespace touchstone::fast {

/// The scene's friction: at most f_max = K F_n^beta while sticking, mu_D F_n while slipping.
class FrictionLaw {
 public:
  explicit FrictionLaw(const scene::Friction& friction) noexcept;
  /// f_max under the normal force F_n >= 0 [N].
  [[nodiscard]] double limit_n(double normal_n) const noexcept;
  [[nodiscard]] double K() const noexcept { return K_; }  ///< [N^(1 - beta)]
  [[nodiscard]] double beta() const noexcept { return beta_; }
  [[nodiscard]] double mu_D() const noexcept { return mu_D_; }
  /// F_n* = (K / mu_D)^(1 / (1 - beta)), above which mu_D F_n would be more than f_max (errata E5) [N]. Infinite where
  /// that never happens, zero for beta = 1 and mu_D > K.
  [[nodiscard]] double bound_n() const noexcept { return bound_n_; }
  /// sqrt(kappa), kappa = (F_t / D_t) / (F_n / D_n) of the sticking contact; 1 in the paper.
  [[nodiscard]] double stiffness_root() const noexcept { return stiffness_root_; }

 private:
  double K_, beta_, mu_D_;
  double bound_n_;
  double stiffness_root_;
};

/// The friction history of a region, kept from tick to tick. The initial value is that of a new region.
struct FrictionState {
  /// D_t, from the origin of deformation to the contact's centre along the rest surface, perpendicular to d [m],
  /// world. The origin is below the contact's centre minus D_t.
  scene::Vec3 stretch_m = scene::Vec3::Zero();
  scene::Vec3 motion = scene::Vec3::Zero();  ///< published: unit direction of the last tangential step; zero before it
  scene::Vec3 d = scene::Vec3::Zero();       ///< to which the others are perpendicular; zero before the first tick
  bool sliding = false;                      ///< slipping, not sticking
};

/// Displacement of the tool's material point at p from one placement to the next [m], world: the step that drives the
/// friction, with p at the centre of pressure. The force acts there, so that its work over this displacement is the
/// tool's work, rotation included, and a rolling ball does not slip.
/// @param arm_m p about the tool's mass centre in its placement `now`, world axes
[[nodiscard]] scene::Vec3 material_step_m(const Placement& before, const Placement& now,
                                          const scene::Vec3& arm_m) noexcept;

/// Friction of one tick, as a stage between region_force and the equivalent point contact.
/// @param law the contact law at the region's size
/// @param R_WT rotation from tool to world
/// @param d unit direction of deformation without skew, against the rest surface's normal, world
/// @param step_m material_step_m at the centre of pressure since the last tick; zero in the tick the region comes into
///   being. Only its part perpendicular to d is used; the depths contain the rest
/// @param force in: region_force of these points; out: with friction
/// @returns D of the equivalent point contact, world
using ResolveFriction = scene::Vec3 (*)(const FrictionLaw&, const DuffingLaw& law, const scene::Mat3& R_WT,
                                        const scene::Vec3& d, const RegionPoints&, const scene::Vec3& step_m,
                                        RegionForce& force, FrictionState&) noexcept;

/// C1 to C4 as printed. A single point has equation (1) for each component (IV-B); a region has it along the skewed
/// direction, its depths longer by |D| / D_n, and is decomposed then (IV-C).
///
/// What is wrong with it (errata E4, E5): the two readings differ by a factor of 2 in the cubic part at 45 degrees; a
/// tool that has slipped sticks again only where mu_D F_n >= f_max, so that a tool at rest keeps its friction against
/// the last motion, and a reversal changes the sign of the friction at once; the stretch while slipping is the one at
/// the onset, which does not give mu_D F_n by (1); in the "impossible case" F_n = f_max / mu_D uses f_max of the F_n
/// that it replaces, so that the result exceeds the limit.
///
/// Choices where the paper gives none: a step of zero keeps the last direction of motion, and F_cn of a slipping region
/// is that of the deformation after p0 has moved.
[[nodiscard]] scene::Vec3 resolve_friction_published(const FrictionLaw&, const DuffingLaw& law, const scene::Mat3& R_WT,
                                                     const scene::Vec3& d, const RegionPoints&,
                                                     const scene::Vec3& step_m, RegionForce& force,
                                                     FrictionState&) noexcept;

/// Errata E4 and E5. One potential U(|D|) with |D|^2 = D_n^2 + kappa D_t^2 and D_n the equivalent depth of the force
/// without friction, so that F_t / F_n = kappa D_t / D_n. The paper's kappa is 1. A half-space under a ball has
/// 3 (1 - nu) / (2 - nu), which is 1 for nu = 0.5 (Mindlin); a body that deflects sideways on its support has less. The
/// tangential step stretches the contact. While sticking F_t may rise to f_max; beyond it the tool slips: D_t is
/// shortened, keeping its direction, to F_t = min(mu_D F_n, f_max) with the resulting F_n, and p0 follows. A slipping
/// tool sticks again when the step is opposite to the stretch, or when the trial stretch is more than 5 % below that
/// length, as when it is pressed harder. The stored stretch only ever shrinks by slipping, so the tool gains no energy
/// over a closed path, and a pause changes nothing.
[[nodiscard]] scene::Vec3 resolve_friction_corrected(const FrictionLaw&, const DuffingLaw& law, const scene::Mat3& R_WT,
                                                     const scene::Vec3& d, const RegionPoints&,
                                                     const scene::Vec3& step_m, RegionForce& force,
                                                     FrictionState&) noexcept;

/// |D_t| at which F_t = min(mu_D F_n, f_max) by resolve_friction_corrected's force [m].
[[nodiscard]] double sliding_stretch_m(const FrictionLaw&, const DuffingLaw& law, double normal_depth_m) noexcept;

}  // namespace touchstone::fast
