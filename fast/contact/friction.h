// Friction of a contact region: whether the tool is stuck on the body or slides over it, and the skewed deformation and
// force that follow (sections IV-B and IV-C).
#pragma once

#include "fast/contact/region_force.h"

namespace touchstone::fast {

/// The scene's friction: most f_max = K F_n^beta while stuck, mu_D F_n while sliding.
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
  /// sqrt(kappa), kappa = (F_t / D_t) / (F_n / D_n) of the stuck contact; 1 in the paper.
  [[nodiscard]] double stiffness_root() const noexcept { return stiffness_root_; }

 private:
  double K_, beta_, mu_D_;
  double bound_n_;
  double stiffness_root_;
};

/// What a region remembers of its friction from tick to tick. Its initial value is that of a region that has just come
/// into being.
struct FrictionState {
  /// D_t, from the origin of deformation to the contact's centre along the rest surface, at right angles to d [m],
  /// world. The origin lies under the contact's centre less this.
  scene::Vec3 stretch_m = scene::Vec3::Zero();
  scene::Vec3 motion = scene::Vec3::Zero();  ///< published: unit direction of the last tangential step; zero before it
  scene::Vec3 d = scene::Vec3::Zero();       ///< what the others are at right angles to; zero before the first tick
  bool sliding = false;                      ///< not stuck
};

/// Way of the tool's material point at p from one placement to the next [m], world: the step that drives the friction,
/// with p at the load centre. The force acts there, so that what it does over this way is the tool's work, turning
/// included, and a ball that rolls does not slip.
/// @param arm_m p about the tool's mass centre in its placement `now`, world axes
[[nodiscard]] scene::Vec3 material_step_m(const Placement& before, const Placement& now,
                                          const scene::Vec3& arm_m) noexcept;

/// Friction of one tick, as a stage between region_force and the equivalent point contact.
/// @param law the contact law at the region's size
/// @param R_WT rotation from tool to world
/// @param d unit direction of deformation without skew, against the rest surface's normal, world
/// @param step_m material_step_m at the load centre since the last tick; zero in the tick the region comes into being.
///   Only its part at right angles to d counts, the rest is in the depths
/// @param force in: region_force of these points; out: with friction
/// @returns D of the equivalent point contact, world
using ResolveFriction = scene::Vec3 (*)(const FrictionLaw&, const DuffingLaw& law, const scene::Mat3& R_WT,
                                        const scene::Vec3& d, const RegionPoints&, const scene::Vec3& step_m,
                                        RegionForce& force, FrictionState&) noexcept;

/// C1 to C4 as printed. A single point has equation (1) for each component (IV-B); a region has it along the skewed
/// direction, its depths longer by |D| / D_n, and is decomposed then (IV-C).
///
/// What is wrong with it (errata E4, E5): the two readings differ by a factor of 2 in the cubic part at 45 degrees; a
/// tool that has slid is stuck again only where mu_D F_n >= f_max, so that one at rest goes on rubbing against its last
/// motion, and turning back changes the sign of the friction at once; the stretch while sliding is the one of the
/// onset, which does not give mu_D F_n by (1); in the "impossible case" F_n = f_max / mu_D takes f_max from the F_n it
/// throws away, so that the limit is broken by the answer.
///
/// Where the paper is silent: a step of zero keeps the last direction of motion, and F_cn of a sliding region is that
/// of the deformation after p0 has moved.
[[nodiscard]] scene::Vec3 resolve_friction_published(const FrictionLaw&, const DuffingLaw& law, const scene::Mat3& R_WT,
                                                     const scene::Vec3& d, const RegionPoints&,
                                                     const scene::Vec3& step_m, RegionForce& force,
                                                     FrictionState&) noexcept;

/// Errata E4 and E5. One potential U(|D|) with |D|^2 = D_n^2 + kappa D_t^2 and D_n the equivalent depth of the force
/// without friction, so that F_t / F_n = kappa D_t / D_n. The paper's kappa is 1. A half-space under a ball has
/// 3 (1 - nu) / (2 - nu), which is 1 for nu = 0.5 (Mindlin); a body that sways on its support has less. The tangential
/// step stretches the contact. While stuck F_t may rise to f_max; beyond it the tool slips: D_t is shortened to
/// F_t = min(mu_D F_n, f_max) in its own direction, with F_n as it then is, and p0 follows. A sliding tool is stuck
/// again once the step turns back against the stretch, or the trial falls short of that length by more than 5 %, as
/// when it is pressed harder. The stored stretch only ever shrinks by slipping, so no closed path gives the tool
/// energy, and a pause changes nothing.
[[nodiscard]] scene::Vec3 resolve_friction_corrected(const FrictionLaw&, const DuffingLaw& law, const scene::Mat3& R_WT,
                                                     const scene::Vec3& d, const RegionPoints&,
                                                     const scene::Vec3& step_m, RegionForce& force,
                                                     FrictionState&) noexcept;

/// |D_t| at which F_t = min(mu_D F_n, f_max) by resolve_friction_corrected's force [m].
[[nodiscard]] double sliding_stretch_m(const FrictionLaw&, const DuffingLaw& law, double normal_depth_m) noexcept;

}  // namespace touchstone::fast
