#include "compare/errors/compute_errors.h"

#include "compare/errors/contact_errors.h"
#include "compare/errors/moved_surface.h"
#include "reference/tool/tool_distance.h"
#include "scene/base/index.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace touchstone::compare {
namespace {

constexpr double same_time_s = 1e-12;
constexpr double same_place_m = 1e-9;

/// Replaces `farthest` by `value` if that is larger in magnitude; the sign is kept.
void keep_farther(double& farthest, double value) {
  if (std::isnan(value) || std::abs(value) > std::abs(farthest)) farthest = value;
}

void require_aligned(const scene::Answer& answer, const std::vector<scene::ReferenceInstant>& reference) {
  const std::size_t instants = answer.instants.size();
  const auto require = [](bool good, const std::string& what) {
    if (!good) throw std::logic_error("the two sides cannot be compared: " + what);
  };
  require(instants > 0, "no instants");
  require(reference.size() == instants, fmt::format("{} instants against {}", instants, reference.size()));
  const Eigen::Index points = answer.surface.points_m.cols();
  for (std::size_t t = 0; t < instants; ++t) {
    const scene::InstantRecord& f = answer.instants[t];
    const scene::ReferenceInstant& r = reference[t];
    require(std::abs(f.time_s - r.time_s) <= same_time_s,
            fmt::format("instant {} is at {} s against {} s", t, f.time_s, r.time_s));
    require((f.tool.position_m - r.tool.position_m).norm() <= same_place_m,
            fmt::format("the tool is at two places at instant {}", t));
    require(f.displacement_m.cols() == points && r.displacement_m.cols() == points &&
                r.displacement_uncertainty_m.size() == points,
            fmt::format("instant {} does not cover the {} rest points", t, points));
  }
}

void compare_forces(const scene::Answer& answer, const std::vector<scene::ReferenceInstant>& reference,
                    Errors& errors) {
  MeanSquares squares;
  SquareSums deep;
  int deep_instants = 0;
  bool deep_without_force = false;
  double band_at_peak_n = 0.0;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    InstantErrors& e = errors.instants[t];
    const scene::Vec3 fast_n = answer.instants[t].force_n();
    const scene::Vec3 reference_n = reference[t].force_n();
    e.force_fast_n = fast_n.norm();
    e.force_reference_n = reference_n.norm();
    e.force_uncertainty_n = reference[t].force_uncertainty_n;
    e.force_error_n = (fast_n - reference_n).norm();
    if (e.in_contact && e.force_reference_n > 0.0) e.force_error_rel = e.force_error_n / e.force_reference_n;
    squares.add(e.force_error_n, e.force_uncertainty_n);
    if (e.force_reference_n > errors.force_peak_reference_n) band_at_peak_n = e.force_uncertainty_n;
    keep_larger(errors.force_peak_fast_n, e.force_fast_n);
    keep_larger(errors.force_peak_reference_n, e.force_reference_n);
    if (!e.deep) continue;
    ++deep_instants;
    if (!e.force_error_rel) {
      deep_without_force = true;
      continue;
    }
    deep.add(1.0, *e.force_error_rel, e.force_uncertainty_n / e.force_reference_n, 1.0);
  }
  const double peak_n = errors.force_peak_reference_n;
  if (peak_n == 0.0) return;
  errors.force_nrmse = squares.over(peak_n);
  errors.force_peak_rel = {(errors.force_peak_fast_n - peak_n) / peak_n, known(band_at_peak_n / peak_n)};
  if (deep_instants > 0 && !deep_without_force) errors.force_rel_deep = deep.relative();
}

/// Points of the rest surface: below the centre of every region, or nearest to the tool's centre if there is no region.
std::vector<scene::Vec3> contact_points_m(const scene::Shape& body,
                                          const std::vector<scene::ReferenceInstant>& reference, std::size_t t) {
  std::vector<scene::Vec3> points_m = reference[t].region_middles_m;
  if (points_m.empty()) points_m.push_back(reference[t].tool.position_m);
  for (scene::Vec3& p_m : points_m) p_m = body.query(p_m).point_m;
  return points_m;
}

/// Face number of every patch; faces are separated by edges of the body. Empty if the body has one smooth face or the
/// surface does not have the body's patches.
std::vector<int> faces_of_patches(const scene::Shape& body, const scene::Surface& surface) {
  std::vector<int> face(static_cast<std::size_t>(body.patch_count()));
  if (surface.patch_begin.size() != face.size() + 1) return {};
  for (std::size_t patch = 0; patch < face.size(); ++patch) face[patch] = body.face_of(static_cast<int>(patch));
  return std::any_of(face.begin(), face.end(), [](int f) { return f > 0; }) ? face : std::vector<int>();
}

/// Rest points of faces that are never in contact; empty if the body has one face only.
std::vector<bool> on_side_faces(const scene::Shape& body, const scene::Surface& surface,
                                const std::vector<scene::ReferenceInstant>& reference, const Errors& errors) {
  const std::vector<int> face = faces_of_patches(body, surface);
  if (face.empty()) return {};
  std::set<int> touched;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    if (!errors.instants[t].in_contact) continue;
    for (const scene::Vec3& contact_m : contact_points_m(body, reference, t)) {
      touched.insert(nth(face, body.query(contact_m).patch));
    }
  }
  std::vector<bool> on_side(static_cast<std::size_t>(surface.points_m.cols()));
  for (std::size_t patch = 0; patch < face.size(); ++patch) {
    std::fill(on_side.begin() + surface.patch_begin[patch], on_side.begin() + surface.patch_begin[patch + 1],
              !touched.contains(face[patch]));
  }
  return on_side;
}

void compare_shapes(const scene::Scene& scene, const scene::Answer& answer,
                    const std::vector<scene::ReferenceInstant>& reference, Errors& errors) {
  const auto body = scene::body_shape(scene.body);
  const auto tool = reference::tool_distance(scene.tool);
  const scene::Surface& surface = answer.surface;
  const Eigen::Index points = surface.points_m.cols();
  const double rest_m3 = enclosed_volume_m3(surface, Eigen::Matrix3Xd::Zero(3, points));

  const std::vector<bool> on_side = on_side_faces(*body, surface, reference, errors);
  SquareSums all, inside, outside, side;
  double normals2 = 0.0, normals_area_m2 = 0.0;
  double uncertainty_max_m = 0.0, hausdorff_max_m = 0.0, max_over_depth = 0.0, uncertainty_over_depth = 0.0;
  bool any_deep = false;
  double both_m2 = 0.0, either_m2 = 0.0;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    InstantErrors& e = errors.instants[t];
    const Eigen::Matrix3Xd& fast_m = answer.instants[t].displacement_m;
    const Eigen::Matrix3Xd& reference_m = reference[t].displacement_m;
    const Eigen::VectorXd& uncertainty_m = reference[t].displacement_uncertainty_m;
    const scene::Pose& pose = reference[t].tool;
    const std::vector<scene::Vec3> contacts_m = contact_points_m(*body, reference, t);
    const double tolerance_m = contact_tolerance_share * e.depth_m;

    e.touched_fast.assign(static_cast<std::size_t>(points), false);
    e.touched_reference = e.touched_fast;
    if (e.in_contact) {
      const Eigen::VectorXd fast_gap_m = tool_gaps_m(surface, fast_m, *tool, pose);
      const Eigen::VectorXd reference_gap_m = tool_gaps_m(surface, reference_m, *tool, pose);
      for (Eigen::Index i = 0; i < points; ++i) {
        nth(e.touched_fast, i) = fast_gap_m[i] <= tolerance_m;
        nth(e.touched_reference, i) = reference_gap_m[i] <= tolerance_m;
        keep_larger(e.penetration_fast_m, -fast_gap_m[i]);
      }
    }
    const Eigen::VectorXd turn_rad = angles_rad(moved_normals(surface, fast_m), moved_normals(surface, reference_m));
    SquareSums now;
    double now_both_m2 = 0.0, now_either_m2 = 0.0, now_uncertainty_max_m = 0.0;
    for (Eigen::Index i = 0; i < points; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double area_m2 = surface.vertex_area_m2[at];
      const double error_m = (fast_m.col(i) - reference_m.col(i)).norm();
      const double scale_m = reference_m.col(i).norm();
      now.add(area_m2, error_m, uncertainty_m[i], scale_m);
      all.add(area_m2, error_m, uncertainty_m[i], scale_m);
      if (e.in_contact) {
        const bool near = std::any_of(contacts_m.begin(), contacts_m.end(), [&](const scene::Vec3& contact_m) {
          return (surface.points_m.col(i) - contact_m).norm() <= scene.fast.r_R_m;
        });
        (near ? inside : outside).add(area_m2, error_m, uncertainty_m[i], scale_m);
        if (!on_side.empty() && on_side[at]) side.add(area_m2, error_m, uncertainty_m[i], scale_m);
        normals2 += area_m2 * turn_rad[i] * turn_rad[i];
        normals_area_m2 += area_m2;
      }
      if (std::isnan(error_m) || error_m > e.shape_max_m) {
        e.shape_max_m = error_m;
        e.shape_max_at = i;
      }
      keep_larger(now_uncertainty_max_m, uncertainty_m[i]);
      if (e.touched_fast[at] && e.touched_reference[at]) now_both_m2 += area_m2;
      if (e.touched_fast[at] || e.touched_reference[at]) now_either_m2 += area_m2;
    }
    if (e.in_contact) e.shape_rel_l2 = now.relative();
    if (now_either_m2 > 0.0) e.contact_area_iou = now_both_m2 / now_either_m2;
    both_m2 += now_both_m2;
    either_m2 += now_either_m2;
    e.hausdorff_m = hausdorff_m(surface, fast_m, reference_m);
    e.volume_change_fast_rel = enclosed_volume_m3(surface, fast_m) / rest_m3 - 1.0;
    e.volume_change_reference_surface_rel = enclosed_volume_m3(surface, reference_m) / rest_m3 - 1.0;

    keep_larger(uncertainty_max_m, now_uncertainty_max_m);
    keep_larger(hausdorff_max_m, e.hausdorff_m);
    keep_farther(errors.volume_change_fast_rel, e.volume_change_fast_rel);
    keep_farther(errors.volume_change_reference_surface_rel, e.volume_change_reference_surface_rel);
    if (!e.deep) continue;
    any_deep = true;
    keep_larger(errors.penetration_fast_rel, e.penetration_fast_m / e.depth_m);
    keep_larger(max_over_depth, e.shape_max_m / e.depth_m);
    keep_larger(uncertainty_over_depth, now_uncertainty_max_m / e.depth_m);
  }
  errors.shape_rel_l2 = all.relative();
  errors.shape_inside_r_rel_l2 = inside.relative();
  errors.shape_outside_r_rel_l2 = outside.relative();
  errors.shape_side_faces_rel_l2 = side.relative();
  if (normals_area_m2 > 0.0) errors.shape_normals_rms_rad = {std::sqrt(normals2 / normals_area_m2), std::nullopt};
  if (inside.error + outside.error > 0.0) {
    errors.shape_error_outside_share = outside.error / (inside.error + outside.error);
  }
  if (any_deep) errors.shape_max_over_depth = {max_over_depth, known(uncertainty_over_depth)};
  errors.shape_hausdorff_m = {hausdorff_max_m, known(uncertainty_max_m)};
  if (either_m2 > 0.0) errors.contact_area_iou = both_m2 / either_m2;
}

}  // namespace

Errors compute_errors(const scene::Scene& scene, const scene::Answer& answer,
                      const std::vector<scene::ReferenceInstant>& reference) {
  require_aligned(answer, reference);
  Errors errors;
  errors.instants.resize(answer.instants.size());
  const std::vector<bool> deep = deep_instants(reference);
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    InstantErrors& e = errors.instants[t];
    e.time_s = reference[t].time_s;
    e.depth_m = reference[t].depth_m;
    e.in_contact = e.depth_m > grazing_depth_m;
    e.deep = deep[t];
    if (e.depth_m > errors.depth_max_m) {
      errors.depth_max_m = e.depth_m;
      errors.deepest = t;
    }
  }
  errors.reference = reference_quality(reference);
  compare_forces(answer, reference, errors);
  compare_contacts(scene, answer, reference, errors);
  compare_shapes(scene, answer, reference, errors);
  const Eigen::VectorXd moved_m = reference[errors.deepest].displacement_m.colwise().norm();
  errors.shape_points_moved = static_cast<int>((moved_m.array() > Errors::moved_share * moved_m.maxCoeff()).count());
  return errors;
}

}  // namespace touchstone::compare
