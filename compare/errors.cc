#include "compare/errors.h"

#include "compare/moved_surface.h"
#include "reference/tool/tool_distance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace touchstone::compare {
namespace {

constexpr double same_time_s = 1e-12;
constexpr double same_place_m = 1e-9;

/// Known only when finite: a reference with too few levels has no band.
std::optional<double> known(double uncertainty) {
  return std::isfinite(uncertainty) ? std::optional(uncertainty) : std::nullopt;
}

/// Keeps the larger; once NaN, stays NaN, so that no bad number is lost in a maximum.
void keep_larger(double& largest, double value) {
  if (std::isnan(value) || value > largest) largest = value;
}

/// Keeps the value of larger magnitude with its sign.
void keep_farther(double& farthest, double value) {
  if (std::isnan(value) || std::abs(value) > std::abs(farthest)) farthest = value;
}

void keep_larger(std::optional<double>& largest, double value) {
  double kept = largest.value_or(value);
  keep_larger(kept, value);
  largest = kept;
}

/// Sums whose ratio's root is a relative L2 error.
struct SquareSums {
  double error = 0.0, uncertainty = 0.0, scale = 0.0;

  void add(double weight, double error_by, double uncertainty_by, double scale_by) {
    error += weight * error_by * error_by;
    uncertainty += weight * uncertainty_by * uncertainty_by;
    scale += weight * scale_by * scale_by;
  }
  [[nodiscard]] Measure relative() const {
    if (scale == 0.0) return {};
    return {std::sqrt(error / scale), known(std::sqrt(uncertainty / scale))};
  }
};

void require_aligned(const fast::Run& run, const reference::Result& result) {
  const std::size_t instants = run.instants.size();
  const auto require = [](bool good, const std::string& what) {
    if (!good) throw std::logic_error("the two sides cannot be compared: " + what);
  };
  require(instants > 0, "no instants");
  require(result.instants.size() == instants, fmt::format("{} instants against {}", instants, result.instants.size()));
  require(run.normals.size() == instants && result.force_uncertainty_n.size() == instants &&
              result.displacement_uncertainty_m.size() == instants &&
              result.residual_penetration_m.size() == instants &&
              result.between_nodes_penetration_m.size() == instants && result.equilibrium_rel.size() == instants &&
              result.volume_change_rel.size() == instants && result.region_middles_m.size() == instants,
          "a series lacks an instant");
  const Eigen::Index points = run.surface.points_m.cols();
  for (std::size_t t = 0; t < instants; ++t) {
    const scene::InstantRecord& f = run.instants[t];
    const scene::InstantRecord& r = result.instants[t];
    require(std::abs(f.time_s - r.time_s) <= same_time_s,
            fmt::format("instant {} is at {} s against {} s", t, f.time_s, r.time_s));
    require((f.tool.position_m - r.tool.position_m).norm() <= same_place_m,
            fmt::format("the tool is at two places at instant {}", t));
    require(f.displacement_m.cols() == points && r.displacement_m.cols() == points && run.normals[t].cols() == points &&
                result.displacement_uncertainty_m[t].size() == points,
            fmt::format("instant {} does not cover the {} rest points", t, points));
  }
}

void compare_forces(const fast::Run& run, const reference::Result& result, Errors& errors) {
  double error2 = 0.0, band2 = 0.0;
  SquareSums deep;
  int deep_instants = 0;
  bool deep_without_force = false;
  double band_at_peak_n = 0.0;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    InstantErrors& e = errors.instants[t];
    const scene::Vec3 fast_n = run.instants[t].force_n();
    const scene::Vec3 reference_n = result.instants[t].force_n();
    e.force_fast_n = fast_n.norm();
    e.force_reference_n = reference_n.norm();
    e.force_uncertainty_n = result.force_uncertainty_n[t];
    e.force_error_n = (fast_n - reference_n).norm();
    if (e.in_contact && e.force_reference_n > 0.0) e.force_error_rel = e.force_error_n / e.force_reference_n;
    error2 += e.force_error_n * e.force_error_n;
    band2 += e.force_uncertainty_n * e.force_uncertainty_n;
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
  const double count = static_cast<double>(errors.instants.size());
  errors.force_nrmse = {std::sqrt(error2 / count) / peak_n, known(std::sqrt(band2 / count) / peak_n)};
  errors.force_peak_rel = {(errors.force_peak_fast_n - peak_n) / peak_n, known(band_at_peak_n / peak_n)};
  if (deep_instants > 0 && !deep_without_force) errors.force_rel_deep = deep.relative();
}

/// Of the rest surface: below the middle of every region, or nearest to the tool's centre where there is none.
std::vector<scene::Vec3> contact_points_m(const scene::Shape& body, const reference::Result& result, std::size_t t) {
  std::vector<scene::Vec3> points_m = result.region_middles_m[t];
  if (points_m.empty()) points_m.push_back(result.instants[t].tool.position_m);
  for (scene::Vec3& p_m : points_m) p_m = body.query(p_m).point_m;
  return points_m;
}

void compare_shapes(const scene::Scene& scene, const fast::Run& run, const reference::Result& result, Errors& errors) {
  const auto body = scene::body_shape(scene.body);
  const auto tool = reference::tool_distance(scene.tool);
  const scene::Surface& surface = run.surface;
  const Eigen::Index points = surface.points_m.cols();
  const double rest_m3 = enclosed_volume_m3(surface, Eigen::Matrix3Xd::Zero(3, points));

  SquareSums all, inside, outside;
  double uncertainty_max_m = 0.0, hausdorff_max_m = 0.0, max_over_depth = 0.0, uncertainty_over_depth = 0.0;
  bool any_deep = false;
  double both_m2 = 0.0, either_m2 = 0.0;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    InstantErrors& e = errors.instants[t];
    const Eigen::Matrix3Xd& fast_m = run.instants[t].displacement_m;
    const Eigen::Matrix3Xd& reference_m = result.instants[t].displacement_m;
    const Eigen::VectorXd& uncertainty_m = result.displacement_uncertainty_m[t];
    const scene::Pose& pose = result.instants[t].tool;
    const std::vector<scene::Vec3> contacts_m = contact_points_m(*body, result, t);
    const double tolerance_m = contact_tolerance_share * e.depth_m;

    e.touched_fast.assign(static_cast<std::size_t>(points), false);
    e.touched_reference = e.touched_fast;
    if (e.in_contact) {
      const Eigen::VectorXd fast_gap_m = tool_gaps_m(surface, fast_m, *tool, pose);
      const Eigen::VectorXd reference_gap_m = tool_gaps_m(surface, reference_m, *tool, pose);
      for (Eigen::Index i = 0; i < points; ++i) {
        e.touched_fast[static_cast<std::size_t>(i)] = fast_gap_m[i] <= tolerance_m;
        e.touched_reference[static_cast<std::size_t>(i)] = reference_gap_m[i] <= tolerance_m;
        keep_larger(e.penetration_fast_m, -fast_gap_m[i]);
      }
    }
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
  if (inside.error + outside.error > 0.0) {
    errors.shape_error_outside_share = outside.error / (inside.error + outside.error);
  }
  if (any_deep) errors.shape_max_over_depth = {max_over_depth, known(uncertainty_over_depth)};
  errors.shape_hausdorff_m = {hausdorff_max_m, known(uncertainty_max_m)};
  if (either_m2 > 0.0) errors.contact_area_iou = both_m2 / either_m2;
}

}  // namespace

bool Measure::distinguishable() const noexcept {
  return value && (!uncertainty || !(std::abs(*value) <= *uncertainty));
}

Errors compute_errors(const scene::Scene& scene, const fast::Run& run, const reference::Result& result) {
  require_aligned(run, result);
  Errors errors;
  errors.instants.resize(run.instants.size());
  const std::vector<bool> deep = deep_instants(result.instants);
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    InstantErrors& e = errors.instants[t];
    e.time_s = result.instants[t].time_s;
    e.depth_m = result.instants[t].depth_m;
    e.in_contact = e.depth_m > grazing_depth_m;
    e.deep = deep[t];
    if (e.depth_m > errors.depth_max_m) {
      errors.depth_max_m = e.depth_m;
      errors.deepest = t;
    }
  }
  errors.reference = reference_quality(result);
  compare_forces(run, result, errors);
  compare_shapes(scene, run, result, errors);
  return errors;
}

}  // namespace touchstone::compare
