// The beam skeleton: beams from the origin of deformation to every anchor point, how the contact force is split over
// them and how far the anchor points move (sections V-B and V-C, equations (2) to (6)).
#pragma once

#include "fast/anchor_points.h"

#include <vector>

namespace touchstone::fast {

/// What the skeleton keeps from contact to contact.
struct BeamSkeleton {
  std::vector<scene::Vec3> anchor_m;  ///< p_i, beam ends
  std::vector<bool> held;             ///< beam ends on the support
  std::vector<double> area_m2;        ///< s_i = gamma_i s_c, equation (19)
  double youngs_modulus_pa = 0.0;     ///< E
  double r_R_m = 0.0;                 ///< radius of the local neighbourhood R
};
[[nodiscard]] BeamSkeleton beam_skeleton(const AnchorPoints& anchors, const scene::Scene& scene);

/// What a contact does to the beam ends, world frame. Storage is fixed at construction.
struct BeamEnds {
  explicit BeamEnds(std::size_t beams);
  /// No force, no displacement.
  void clear() noexcept;
  std::vector<scene::Vec3> force_n;         ///< F_i, on beam i at the common end
  std::vector<scene::Vec3> displacement_m;  ///< of the anchor point; zero where held
  bool limited = false;                     ///< an anchor point was held back to the contact's own displacement
};

/// Splits the force F on the body over the beams and moves the anchor points.
///
/// Beam i runs from its anchor point to p0: x_i points to p0, l_i = max(|p0 - p_i|, r_R), and a beam shorter than 1e-9
/// m takes its direction from the force (errata E9).
///
/// The anchor point's displacement is the end displacement of its own beam under F_i, released at the anchor and held
/// at the contact: F_x l / (E s) along the beam and F_y l^3 / (3 E I_z) across it (errata E10: equation (7) cannot be
/// solved for a displacement from strain at one point). It is at most as long as the contact's own displacement D, or
/// a small s_c would tear the body off its contact.
/// @param p0_W_m origin of deformation; @param force_n F, of the tool on the body
/// @param displacement_m D d, of the equivalent contact point
using SplitForce = void (*)(const BeamSkeleton&, const scene::Vec3& p0_W_m, const scene::Vec3& force_n,
                            const scene::Vec3& displacement_m, BeamEnds&) noexcept;

/// Equations (4) to (6) as printed, errata E8: 2n + 1 equations for 2n unknowns. Equation (4) fixes all F_x up to one
/// factor a, equation (5) all F_y up to one factor b; a, b >= 0 are the least-squares solution of equation (6), of
/// minimum norm where a symmetric contact leaves their ratio open. Equation (6) keeps a residual.
/// Delta x_i has the bending's delta x of section V-C taken out (errata E19, as printed).
void split_force_published(const BeamSkeleton&, const scene::Vec3& p0_W_m, const scene::Vec3& force_n,
                           const scene::Vec3& displacement_m, BeamEnds&) noexcept;

/// Errata E8: the common end moves by u with K u = F, K = sum_i [E s_i / l_i x x^T + 3 E I_i / l_i^3 (1 - x x^T)], and
/// F_i = K_i u. Equations (2), (3) and (6) hold exactly and no y axis is needed. Every free anchor point then moves
/// by u.
void split_force_corrected(const BeamSkeleton&, const scene::Vec3& p0_W_m, const scene::Vec3& force_n,
                           const scene::Vec3& displacement_m, BeamEnds&) noexcept;

/// Reaction of the support on the body [N]: the beams' fixed ends together, -sum F_i. In balance with the contact
/// force where equation (6) holds.
[[nodiscard]] scene::Vec3 support_force_n(const BeamEnds& ends) noexcept;

}  // namespace touchstone::fast
