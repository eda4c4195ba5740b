// How far the fast model is from the reference: force, shape and contact, with the reference's own
// uncertainty for every error. Aligned by track instant and by rest point, never by nearest vertex.
#pragma once

#include "compare/errors/measure.h"
#include "compare/errors/reference_quality.h"

#include <optional>
#include <vector>

namespace touchstone::compare {

/// A rest point is in contact when its deformed position is nearer to the tool's surface than this fraction of the
/// instant's depth, or inside the tool.
inline constexpr double contact_tolerance_share = 0.01;

/// Errors at one track instant. F is the total contact force on the tool, u_i the displacement of rest
/// point i, A_i its part of the rest surface's area; f is the fast model, r the reference.
struct InstantErrors {
  double time_s = 0.0;
  double depth_m = 0.0;                   ///< scene::rest_depth_m, zero when apart
  bool in_contact = false;                ///< depth above grazing_depth_m
  bool deep = false;                      ///< depth above deep_share of the largest
  double force_fast_n = 0.0;              ///< |F_f|
  double force_reference_n = 0.0;         ///< |F_r|
  double force_uncertainty_n = 0.0;       ///< of the reference; NaN where unknown
  double force_error_n = 0.0;             ///< |F_f - F_r|, of the vectors
  double friction_fast_n = 0.0;           ///< |T_f|, the part of F_f along the surface; zero without friction
  double friction_reference_n = 0.0;      ///< |T_r|
  double path_m = 0.0;                    ///< slip path of the tool's point at the contact since the first instant
  std::optional<double> force_error_rel;  ///< |F_f - F_r| / |F_r|; absent where apart or |F_r| = 0
  Measure shape_rel_l2;                   ///< sqrt(sum A |u_f - u_r|^2 / sum A |u_r|^2); absent where apart or u_r = 0
  double shape_max_m = 0.0;               ///< largest |u_f - u_r|
  Eigen::Index shape_max_at = 0;          ///< rest point of that
  double penetration_fast_m = 0.0;        ///< largest depth of the fast model's points inside the tool
  double hausdorff_m = 0.0;               ///< see Errors::shape_hausdorff_m
  double volume_change_fast_rel = 0.0;  ///< of the closed surface the moved rest points span, by the divergence theorem
  double volume_change_reference_surface_rel = 0.0;   ///< the same surface with the reference's displacements
  std::vector<bool> touched_fast, touched_reference;  ///< per rest point; see contact_tolerance_share
  std::optional<double> contact_area_iou;             ///< area in contact in both / in either; absent where none is
};

/// One contact region over the track, where either solver has several at once.
struct RegionErrors {
  int id = 0;              ///< the reference's
  Measure force_nrmse;     ///< as Errors::force_nrmse, of this region's force and its own peak
  Measure force_peak_rel;  ///< as Errors::force_peak_rel. The reference has no uncertainty for a single region.
};

/// Every figure that compares the two solvers, and how good the reference is.
struct Errors {
  std::vector<InstantErrors> instants;
  std::size_t deepest = 0;  ///< instant of the largest depth, the first of several
  double depth_max_m = 0.0;
  double force_peak_fast_n = 0.0;       ///< largest |F_f| of the track
  double force_peak_reference_n = 0.0;  ///< largest |F_r|; zero: the reference was never in contact

  /// sqrt(mean over all instants of |F_f - F_r|^2) / peak |F_r|. Uncertainty: the same with the reference's.
  Measure force_nrmse;
  /// (peak |F_f| - peak |F_r|) / peak |F_r|; negative: the fast model is too weak. Uncertainty: the reference's there /
  /// peak.
  Measure force_peak_rel;
  /// sqrt(mean over deep instants of (|F_f - F_r| / |F_r|)^2). Uncertainty: the same with the reference's.
  Measure force_rel_deep;

  bool friction = false;  ///< the scene has it; without, the figures up to the slip's are absent
  /// As force_nrmse, of the friction and its peak. Uncertainty: that of the whole force, of which it is a part.
  Measure force_friction_nrmse;
  /// (W_f - W_r) / |W_r|, W the work of the tool against friction over the track, at the tool's point in the middle of
  /// the reference's contact: the area of the loop where the track turns back. Uncertainty: the work of the force's
  /// uncertainty.
  Measure force_friction_work_rel;
  /// Slip path at the first deep instant at which a region slips; absent where none ever does.
  std::optional<double> slip_onset_fast_m, slip_onset_reference_m;
  Measure slip_onset_error_m;  ///< their difference; uncertainty: the path between the instants
  /// As force_nrmse, of the torque about the tool's mass centre and the largest |F_r| times the distance of the contact
  /// from there. Uncertainty: the force's at that distance.
  Measure force_torque_nrmse;
  std::vector<RegionErrors> regions;  ///< by rising id; empty where there is never more than one

  /// sqrt(sum over instants and rest points of A |u_f - u_r|^2 / the same of A |u_r|^2). Uncertainty: of u_r, same sum.
  Measure shape_rel_l2;
  /// Of the rest points those that the reference moves by more than moved_share of its largest displacement, at the
  /// deepest instant: where they are few, the shape's errors rest on them alone.
  int shape_points_moved = 0;
  static constexpr double moved_share = 0.1;
  /// The same sums over rest points within, and beyond, fast.r_R_m of a contact point, instants in contact.
  /// Contact points are the points of the rest surface nearest to the middles of the reference's regions, to the tool's
  /// centre where it has none; the distance is straight, at rest, to the nearest.
  Measure shape_inside_r_rel_l2, shape_outside_r_rel_l2;
  /// The same sums, instants in contact, over the faces that no contact point lies on at any instant, where edges
  /// divide the surface into faces: of a box, of a surface of revolution. Absent elsewhere.
  Measure shape_side_faces_rel_l2;
  /// Angle between the normals of the two moved surfaces, root mean square by area over the instants in contact; see
  /// moved_normals. The reference has no uncertainty for it.
  Measure shape_normals_rms_rad;
  /// Fraction of the summed squared shape error that lies beyond fast.r_R_m; absent where there is no error.
  std::optional<double> shape_error_outside_share;
  /// Largest |u_f - u_r| / depth over deep instants and rest points. Uncertainty: of u_r, same maximum.
  Measure shape_max_over_depth;
  /// Largest distance from a vertex of one moved surface to the triangles of the other, in both directions, over all
  /// instants. Uncertainty: the largest of u_r over all, by which this distance can change at most.
  Measure shape_hausdorff_m;
  /// Of the largest magnitude over the instants, signed, relative to the rest volume.
  double volume_change_fast_rel = 0.0;
  double volume_change_reference_surface_rel = 0.0;  ///< on the triangles the fast model's is measured on
  /// Largest depth of a fast model's point inside the tool / depth, over deep instants; absent where there is none.
  std::optional<double> penetration_fast_rel;
  /// sqrt(sum over instants and rest points of A |t_f - t_r|^2 / the same of A |t_r|^2), t the traction. Uncertainty:
  /// of t_r, same sum. This and the next are absent where the model or the reference gives no traction.
  Measure contact_pressure_rel_l2;
  /// (peak p_f - peak p_r) / peak p_r, p the largest pressure of an instant. Uncertainty: the reference's there / peak.
  Measure contact_pressure_peak_rel;
  /// Area in contact in both, summed over instants, / area in contact in either. Absent where none ever is.
  std::optional<double> contact_area_iou;

  ReferenceQuality reference;
};

}  // namespace touchstone::compare
