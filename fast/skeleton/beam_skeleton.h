// The beam skeleton: beams from the origin of deformation to every anchor point, how the contact force is split over
// them and how far the anchor points move (sections V-B to V-D, equations (2) to (6) and (10) to (14)).
#pragma once

#include "fast/skeleton/anchor_points.h"
#include "fast/skeleton/beam_areas.h"
#include "fast/skeleton/inclusion_crossing.h"

#include <span>
#include <vector>

namespace touchstone::fast {

/// What the skeleton keeps from contact to contact.
struct BeamSkeleton {
  /// Takes over s_c and r_R; the anchor points and what lies between them stay.
  void set_constants(const scene::FastSettings& fast);

  std::vector<scene::Vec3> anchor_m;  ///< p_i, beam ends at rest
  std::vector<bool> held;             ///< beam ends on the support
  std::vector<double> area_m2;        ///< s_i = gamma_i s_c at rest, equation (19)
  double s_c_m2 = 0.0;                ///< sum of the s_i
  double youngs_modulus_pa = 0.0;     ///< E, outside the inclusions
  double poissons_ratio = 0.0;        ///< nu, outside the inclusions
  double r_R_m = 0.0;                 ///< radius of the local neighbourhood R
  AreaTriangles triangles;            ///< of the Voronoi regions
  std::vector<Inclusion> inclusions;  ///< empty: every beam is of one material
};
[[nodiscard]] BeamSkeleton beam_skeleton(const AnchorPoints& anchors, const scene::Scene& scene);

/// The skeleton as one contact region sees it. From a BeamSkeleton: at rest, as the first region does.
struct SkeletonView {
  SkeletonView(const BeamSkeleton& at_rest) noexcept  // NOLINT: the first region's view is the skeleton itself
      : skeleton(at_rest), anchor_m(at_rest.anchor_m), area_m2(at_rest.area_m2) {}
  SkeletonView(const BeamSkeleton& constants, std::span<const scene::Vec3> current_anchor_m,
               std::span<const double> current_area_m2) noexcept
      : skeleton(constants), anchor_m(current_anchor_m), area_m2(current_area_m2) {}

  const BeamSkeleton& skeleton;
  std::span<const scene::Vec3> anchor_m;  ///< p_i on the current surface
  std::span<const double> area_m2;        ///< s_i on the current surface
};

/// The beam ends on the body that earlier regions have deformed (section VI, appendix IV), for a region after the
/// first. Storage is fixed at construction.
struct CurrentEnds {
  explicit CurrentEnds(const BeamSkeleton& skeleton);
  /// @param anchor_displacement_m per anchor point, by all earlier regions together
  void update(const BeamSkeleton& skeleton, std::span<const scene::Vec3> anchor_displacement_m) noexcept;
  [[nodiscard]] SkeletonView view(const BeamSkeleton& skeleton) const noexcept { return {skeleton, anchor_m, area_m2}; }

  std::vector<scene::Vec3> anchor_m;
  std::vector<double> area_m2;
};

/// A beam of a contact.
struct Beam {
  scene::Vec3 x = scene::Vec3::UnitX();  ///< x_i, from the anchor point to the contact
  double l_m = 0.0;
  double axial_n_per_m = 0.0;    ///< F_x / Delta x, equation (3); E s / l in one material
  double bending_n_per_m = 0.0;  ///< F_y / y' of the contact end, equation (2); 3 E I_z / l^3 in one material
  /// Deflection of the anchor end, released there and held at the contact, over that of the contact end under the same
  /// force; 1 in one material.
  double release_ratio = 1.0;
};

/// What a contact does to the beam ends, world frame. Storage is fixed at construction.
struct BeamEnds {
  explicit BeamEnds(std::size_t beams);
  /// No force, no displacement.
  void clear() noexcept;
  std::vector<scene::Vec3> force_n;         ///< F_i, on beam i at the common end
  std::vector<scene::Vec3> displacement_m;  ///< of the anchor point; zero where held
  std::vector<Beam> beam;                   ///< those of the last split with a force
  bool limited = false;                     ///< an anchor point was limited to the contact's own displacement
};

/// Splits the force F on the body over the beams and moves the anchor points.
///
/// Beam i runs from its anchor point to p0: x_i points to p0, l_i = max(|p0 - p_i|, r_R), and a beam shorter than 1e-9
/// m takes its direction from the force (errata E9).
///
/// The anchor point's displacement is the end displacement of its own beam under F_i, released at the anchor and held
/// at the contact: in one material F_x l / (E s) along the beam and F_y l^3 / (3 E I_z) across it (errata E10: equation
/// (7) cannot be solved for a displacement from strain at one point). It is at most as long as the contact's own
/// displacement D, or a small s_c would tear the body off its contact.
/// @param p0_W_m origin of deformation, on the current surface; @param force_n F, of the tool on the body
/// @param displacement_m D d, of the equivalent contact point
using SplitForce = void (*)(const SkeletonView&, const scene::Vec3& p0_W_m, const scene::Vec3& force_n,
                            const scene::Vec3& displacement_m, BeamEnds&) noexcept;

/// The split of a formulation for a skeleton: the plain ones below where all beams are of one material.
[[nodiscard]] SplitForce split_force_of(scene::Formulation formulation, const BeamSkeleton& skeleton) noexcept;

/// Equations (4) to (6) as printed, errata E8: 2n + 1 equations for 2n unknowns. Equation (4) fixes all F_x up to one
/// factor a, equation (5) all F_y up to one factor b; a, b >= 0 are the least-squares solution of equation (6), of
/// minimum norm where a symmetric contact leaves their ratio open. Equation (6) keeps a residual.
/// Delta x_i has the bending's delta x of section V-C taken out (errata E19, as printed).
extern const SplitForce split_force_published;

/// Errata E8: the common end moves by u with K u = F, K = sum_i [E s_i / l_i x x^T + 3 E I_i / l_i^3 (1 - x x^T)], and
/// F_i = K_i u. Equations (2), (3) and (6) hold exactly and no y axis is needed. Every free anchor point then moves
/// by u.
extern const SplitForce split_force_corrected;

/// Section V-D as printed: equations (13) and (14), with the printed k in the split and in the anchor point's
/// displacement alike (errata E13), and (12) closed by equal strain (errata E14).
extern const SplitForce split_force_in_parts_published;

/// The same K u = F with each beam's own stiffnesses: the integral of (l - x)^2 / (E I) across (errata E12, E13),
/// springs in series along (E14). The anchor point is the other end of its beam, so it moves by u along and by u times
/// Beam::release_ratio across. With one compliance for both ends every anchor point would move by u, and no inclusion
/// could make the shape lean to one side, as the paper's Fig. 18 shows it.
extern const SplitForce split_force_in_parts_corrected;

/// Reaction of the support on the body [N]: the beams' fixed ends together, -sum F_i. In balance with the contact
/// force where equation (6) holds.
[[nodiscard]] scene::Vec3 support_force_n(const BeamEnds& ends) noexcept;

}  // namespace touchstone::fast
