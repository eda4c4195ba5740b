#include "compare/errors/contact_errors.h"

#include "compare/errors/measure.h"

#include <algorithm>
#include <limits>
#include <map>
#include <tuple>

namespace touchstone::compare {
namespace {

using scene::InstantRecord;
using scene::RegionRecord;
using scene::Vec3;

/// Friction below this fraction of the peak force is round-off, as under a tool that is pressed straight in.
constexpr double least_friction_share = 1e-6;

/// Displacement of the tool's material point at the centre of the reference's regions up to the next instant; of the
/// tool's centre if there is no region.
Vec3 step_to_next_m(const std::vector<scene::ReferenceInstant>& reference, std::size_t t) {
  const scene::Pose &here = reference[t].tool, &next = reference[t + 1].tool;
  const std::vector<Vec3>& middles_m = reference[t].region_middles_m;
  Vec3 at_m = middles_m.empty() ? here.position_m : Vec3::Zero();
  for (const Vec3& middle_m : middles_m) at_m += middle_m / static_cast<double>(middles_m.size());
  const Vec3 at_T_m = here.orientation.conjugate() * (at_m - here.position_m);
  return next.orientation * at_T_m + next.position_m - at_m;
}

/// First instant at which the contact slips, among those deep enough to exclude grazing contact.
std::optional<std::size_t> slip_onset(const scene::Instants& records, const Errors& errors) {
  for (std::size_t t = 0; t < records.size(); ++t) {
    const auto slides = [](const RegionRecord& region) { return region.sliding; };
    if (errors.instants[t].deep && std::any_of(records[t].regions.begin(), records[t].regions.end(), slides)) return t;
  }
  return std::nullopt;
}

void compare_friction(const scene::Answer& answer, const std::vector<scene::ReferenceInstant>& reference,
                      Errors& errors) {
  MeanSquares squares;
  double peak_n = 0.0, work_fast_j = 0.0, work_reference_j = 0.0, work_band_j = 0.0;
  const std::size_t count = errors.instants.size();
  for (std::size_t t = 0; t < count; ++t) {
    InstantErrors& e = errors.instants[t];
    const Vec3 fast_n = answer.instants[t].friction_n(), reference_n = reference[t].friction_n();
    e.friction_fast_n = fast_n.norm();
    e.friction_reference_n = reference_n.norm();
    squares.add((fast_n - reference_n).norm(), e.force_uncertainty_n);
    keep_larger(peak_n, e.friction_reference_n);
    if (t + 1 == count) break;
    const Vec3 step_m = step_to_next_m(reference, t);
    errors.instants[t + 1].path_m = e.path_m + step_m.norm();
    work_fast_j -= 0.5 * (fast_n + answer.instants[t + 1].friction_n()).dot(step_m);
    work_reference_j -= 0.5 * (reference_n + reference[t + 1].friction_n()).dot(step_m);
    work_band_j += 0.5 * (e.force_uncertainty_n + reference[t + 1].force_uncertainty_n) * step_m.norm();
  }
  if (peak_n > least_friction_share * errors.force_peak_reference_n) {
    errors.force_friction_nrmse = squares.over(peak_n);
    if (work_reference_j != 0.0) {
      const double scale_j = std::abs(work_reference_j);
      errors.force_friction_work_rel = {(work_fast_j - work_reference_j) / scale_j, known(work_band_j / scale_j)};
    }
  }

  const std::optional<std::size_t> fast_at = slip_onset(answer.instants, errors);
  const std::optional<std::size_t> reference_at = slip_onset(reference, errors);
  if (fast_at) errors.slip_onset_fast_m = errors.instants[*fast_at].path_m;
  if (reference_at) errors.slip_onset_reference_m = errors.instants[*reference_at].path_m;
  if (!fast_at || !reference_at) return;
  // Slip may have begun at any time since the previous instant.
  const auto since_before_m = [&](std::size_t t) {
    return t == 0 ? 0.0 : errors.instants[t].path_m - errors.instants[t - 1].path_m;
  };
  errors.slip_onset_error_m = {*errors.slip_onset_fast_m - *errors.slip_onset_reference_m,
                               std::max(since_before_m(*fast_at), since_before_m(*reference_at))};
}

void compare_torques(const scene::Answer& answer, const std::vector<scene::ReferenceInstant>& reference,
                     Errors& errors) {
  MeanSquares squares;
  double scale_nm = 0.0;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    const InstantErrors& e = errors.instants[t];
    double lever_m = 0.0;
    for (const Vec3& middle_m : reference[t].region_middles_m) {
      lever_m = std::max(lever_m, (middle_m - reference[t].tool.position_m).norm());
    }
    squares.add((answer.instants[t].torque_nm() - reference[t].torque_nm()).norm(), e.force_uncertainty_n * lever_m);
    scale_nm = std::max(scale_nm, e.force_reference_n * lever_m);
  }
  if (scale_nm > 0.0) errors.force_torque_nrmse = squares.over(scale_nm);
}

/// Distance of a point from the line along which a region's force acts on the tool.
double from_load_line_m(const Vec3& point_m, const RegionRecord& region, const scene::Pose& tool) {
  const double force_n = region.force_n.norm();
  if (!(force_n > 0.0)) return std::numeric_limits<double>::infinity();
  return (region.torque_nm - (point_m - tool.position_m).cross(region.force_n)).norm() / force_n;
}

/// For every region of the reference the corresponding region of the fast model, or null. The closest pairs are matched
/// first, because each side has its own region numbers.
std::vector<const RegionRecord*> partners(const InstantRecord& fast, const InstantRecord& reference,
                                          const std::vector<Vec3>& middles_m) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t r = 0; r < middles_m.size(); ++r) {
    for (std::size_t f = 0; f < fast.regions.size(); ++f) {
      pairs.emplace_back(from_load_line_m(middles_m[r], fast.regions[f], reference.tool), r, f);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<const RegionRecord*> partner(middles_m.size(), nullptr);
  std::vector<bool> taken(fast.regions.size(), false);
  for (const auto& [distance_m, r, f] : pairs) {
    if (partner[r] != nullptr || taken[f]) continue;
    partner[r] = &fast.regions[f];
    taken[f] = true;
  }
  return partner;
}

void compare_regions(const scene::Answer& answer, const std::vector<scene::ReferenceInstant>& reference,
                     Errors& errors) {
  const auto several = [](const InstantRecord& record) { return record.regions.size() > 1; };
  if (std::none_of(answer.instants.begin(), answer.instants.end(), several) &&
      std::none_of(reference.begin(), reference.end(), several)) {
    return;
  }
  struct Sums {
    double error2 = 0.0, peak_fast_n = 0.0, peak_reference_n = 0.0;
  };
  std::map<int, Sums> of_id;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    const scene::ReferenceInstant& instant = reference[t];
    // If the tool penetrates only between the nodes, the region has no centre and no force.
    const std::size_t regions = std::min(instant.regions.size(), instant.region_middles_m.size());
    const std::vector<const RegionRecord*> partner = partners(
        answer.instants[t], instant,
        {instant.region_middles_m.begin(), instant.region_middles_m.begin() + static_cast<std::ptrdiff_t>(regions)});
    for (std::size_t r = 0; r < regions; ++r) {
      const RegionRecord& region = instant.regions[r];
      const Vec3 fast_n = partner[r] != nullptr ? partner[r]->force_n : Vec3::Zero();
      Sums& sums = of_id[region.id];
      sums.error2 += (fast_n - region.force_n).squaredNorm();
      keep_larger(sums.peak_fast_n, fast_n.norm());
      keep_larger(sums.peak_reference_n, region.force_n.norm());
    }
  }
  for (const auto& [id, sums] : of_id) {
    if (!(sums.peak_reference_n > 0.0)) continue;
    const double rms_n = std::sqrt(sums.error2 / static_cast<double>(errors.instants.size()));
    errors.regions.push_back({id,
                              {rms_n / sums.peak_reference_n, std::nullopt},
                              {sums.peak_fast_n / sums.peak_reference_n - 1.0, std::nullopt}});
  }
}

void compare_tractions(const scene::Answer& answer, const std::vector<scene::ReferenceInstant>& reference,
                       Errors& errors) {
  const Eigen::Index points = answer.surface.points_m.cols();
  SquareSums sums;
  double peak_fast_pa = 0.0, peak_pa = 0.0, band_at_peak_pa = 0.0;
  for (std::size_t t = 0; t < errors.instants.size(); ++t) {
    const InstantRecord& fast = answer.instants[t];
    const scene::ReferenceInstant& instant = reference[t];
    if (fast.traction_pa.cols() != points || instant.traction_pa.cols() != points) return;
    for (Eigen::Index i = 0; i < points; ++i) {
      sums.add(answer.surface.vertex_area_m2[static_cast<std::size_t>(i)],
               (fast.traction_pa.col(i) - instant.traction_pa.col(i)).norm(), instant.traction_uncertainty_pa[i],
               instant.traction_pa.col(i).norm());
    }
    if (instant.pressure_peak_pa > peak_pa) band_at_peak_pa = instant.pressure_peak_uncertainty_pa;
    keep_larger(peak_fast_pa, fast.pressure_peak_pa);
    keep_larger(peak_pa, instant.pressure_peak_pa);
  }
  errors.contact_pressure_rel_l2 = sums.relative();
  if (peak_pa > 0.0)
    errors.contact_pressure_peak_rel = {peak_fast_pa / peak_pa - 1.0, known(band_at_peak_pa / peak_pa)};
}

}  // namespace

void compare_contacts(const scene::Scene& scene, const scene::Answer& answer,
                      const std::vector<scene::ReferenceInstant>& reference, Errors& errors) {
  errors.friction = scene.contact.friction.has_value();
  if (errors.friction) compare_friction(answer, reference, errors);
  compare_torques(answer, reference, errors);
  compare_regions(answer, reference, errors);
  compare_tractions(answer, reference, errors);
}

}  // namespace touchstone::compare
