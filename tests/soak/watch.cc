#include "soak/watch.h"

#include "fast/contact/equivalent_point.h"
#include "fast/step/stages.h"
#include "scene/base/index.h"

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>

namespace touchstone::soak {
namespace {

using fast::ContactRegion;
using fast::StepStatus;
using scene::Vec3;

/// The groups of points are counted independently in one tick of so many.
constexpr std::int64_t ticks_per_count = 50;

bool has(StepStatus status, StepStatus bit) { return (status | bit) == status; }

/// By the bits of the exponent, so that the loop has no branch.
bool all_finite(const fast::Columns3& columns) {
  std::uint32_t bad = 0;
  for (const std::vector<float>& column : columns) {
    for (const float value : column)
      bad |= static_cast<std::uint32_t>((std::bit_cast<std::uint32_t>(value) & 0x7f800000U) == 0x7f800000U);
  }
  return bad == 0;
}

bool all_finite(const ContactRegion& region) {
  const fast::RegionForce& f = region.force;
  double sum = region.extent.deepest_m + region.extent.area_m2 + region.extent.thickness_m + f.magnitude_n + f.normal_n;
  for (const Vec3* v : {&region.d, &region.displacement_m, &region.origin.p0_W_m, &f.force_n, &f.torque_nm,
                        &f.tangential_n, &f.load_center_m, &region.friction.stretch_m})
    sum += v->sum();
  for (const Vec3& v : region.ends.force_n) sum += v.sum();
  for (const Vec3& v : region.ends.displacement_m) sum += v.sum();
  return std::isfinite(sum);
}

std::string with_number(const char* format, double number) {
  char text[160];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

/// Displacement that an anchor point would have without the limit, from the force on its beam [m].
double unlimited_m(const fast::Beam& beam, const Vec3& force_n) {
  const Vec3 along_n = force_n.dot(beam.x) * beam.x;
  return (along_n / beam.axial_n_per_m + beam.release_ratio / beam.bending_n_per_m * (force_n - along_n)).norm();
}

}  // namespace

std::int64_t Figures::faults() const {
  return std::accumulate(looked.begin(), looked.end(), std::int64_t{0},
                         [](std::int64_t sum, const Looked& property) { return sum + property.faults; });
}

Watch::Watch(const fast::FastModel& model, fast::FastState& state, Figures& figures,
             std::function<void(Property, const std::string&)> report)
    : model_(model),
      state_(state),
      figures_(figures),
      report_(std::move(report)),
      cells_(model.cell_scratch()),
      group_(static_cast<std::size_t>(model.max_points())) {}

void Watch::check(Property property, bool holds, const std::string& otherwise) {
  if (holds) return;
  ++nth(figures_.looked, property).faults;
  report_(property, otherwise);
}

void Watch::before_step() noexcept {
  force_n_ = total_force_n(state_);
  position_m_ = state_.motion.pose.position_m;
  if (state_.several) bulge_m_ = state_.several->bulge_m;
}

void Watch::after_step(const scene::Pose& asked, StepStatus status) {
  ++figures_.ticks;
  ++tick_;
  for (std::size_t bit = 0; bit < figures_.bits.size(); ++bit)
    figures_.bits[bit] += (static_cast<std::uint32_t>(status) >> bit) & 1U;

  const bool placement =
      asked.position_m.allFinite() && asked.orientation.coeffs().allFinite() && asked.orientation.squaredNorm() > 0.0;
  if (!placement || has(status, StepStatus::not_finite)) {
    ++nth(figures_.looked, Property::bad_pose_held).times;
    check(Property::bad_pose_held, !placement && status == StepStatus::not_finite, "a bad pose and its bit disagree");
    check(Property::bad_pose_held, total_force_n(state_) == force_n_ && state_.motion.pose.position_m == position_m_,
          "a bad pose changed the force or the last good pose");
    return;
  }
  check_finite();
  const bool in_contact = state_.in_contact();
  if (in_contact) {
    ++figures_.in_contact;
    figures_.several_regions += state_.region_count > 1;
    figures_.sliding += state_.regions[0].friction.sliding;
    check_reported(status);
  } else if (was_in_contact_ || tick_ % ticks_per_count == 0) {
    figures_.contacts_ended += was_in_contact_;
    check_rest();
  }
  if (state_.several && tick_ % ticks_per_count == 0) check_regions_full(asked, status);
  was_in_contact_ = in_contact;
}

void Watch::check_finite() {
  ++nth(figures_.looked, Property::finite).times;
  bool finite_depths = true;
  bool finite =
      total_force_n(state_).allFinite() && total_torque_nm(state_).allFinite() && support_force_n(state_).allFinite();
  for (int i = 0; i < state_.region_count; ++i) {
    const ContactRegion& region = nth(state_.regions, i);
    finite = finite && all_finite(region);
    finite_depths = finite_depths && std::isfinite(region.depth_rel);
  }
  check(Property::finite, finite, "a force, torque, place or beam is not finite");
  check(Property::finite, finite_depths, "a region's depth_rel is not finite");
  if (state_.deformed)
    check(Property::finite, all_finite(state_.field.displacement_m) && all_finite(state_.field.normal),
          "the surface is not finite");
}

void Watch::check_reported(StepStatus status) {
  ++nth(figures_.looked, Property::reported).times;
  bool too_deep = false, past_peak = false, ends_cut = false, ends_beyond = false;
  for (int i = 0; i < state_.region_count; ++i) {
    const ContactRegion& region = nth(state_.regions, i);
    if (!region.pressing()) continue;
    too_deep = too_deep || region.extent.deepest_m > fast::depth_limit_rel * region.extent.thickness_m;
    const double peak_m = model_.law.at(fast::contact_radius_m(region.extent.area_m2)).peak_depth_m();
    for (int k = 0; k < region.points.count; ++k) past_peak = past_peak || region.points.depth_m[k] > peak_m;
    const double D_m = region.displacement_m.norm();
    for (std::size_t k = 0; k < region.ends.force_n.size(); ++k) {
      ends_beyond = ends_beyond || !(region.ends.displacement_m[k].norm() <= D_m * (1.0 + 1e-9));
      // Below that, round-off of the force dominates.
      if (model_.skeleton.held[k] || !(D_m > 1e-12)) continue;
      ends_cut = ends_cut || unlimited_m(region.ends.beam[k], region.ends.force_n[k]) > D_m * (1.0 + 1e-3);
    }
    check(Property::reported, region.points.count <= model_.max_points(), "more points than the capacity");
  }
  check(Property::reported, state_.region_count <= model_.max_regions, "more regions than max_regions");
  check(Property::reported, !too_deep || has(status, StepStatus::depth_limited),
        "a depth beyond its limit, unreported");
  check(Property::reported, !past_peak || has(status, StepStatus::law_saturated), "a law past its peak, unreported");
  check(Property::reported, !ends_beyond, "an anchor point beyond the contact");
  check(Property::reported, !ends_cut || has(status, StepStatus::anchors_limited), "an anchor held back, unreported");
}

void Watch::check_regions_full(const scene::Pose& pose, StepStatus status) {
  fast::RegionPoints points = state_.probe.window();
  const scene::Pose unit{pose.position_m, pose.orientation.normalized()};
  fast::find_points(model_, fast::placement(unit), bulge_m_, points, cells_);
  // Groups of points by the rule of section II-B, in the simplest algorithm.
  const auto count = static_cast<std::size_t>(points.count);
  std::iota(group_.begin(), group_.begin() + points.count, 0);
  const auto root = [&](int i) {
    while (nth(group_, i) != i) i = nth(group_, i);
    return i;
  };
  const double near2_m2 = model_.clusters->r_th_m * model_.clusters->r_th_m;
  const auto sample_m = [&](std::size_t point) {
    const auto i = static_cast<std::size_t>(points.sample[point]);
    return Vec3(model_.tool.x_T_m[i], model_.tool.y_T_m[i], model_.tool.z_T_m[i]);
  };
  int groups = points.count;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = i + 1; k < count; ++k) {
      if (!((sample_m(i) - sample_m(k)).squaredNorm() < near2_m2)) continue;
      const int a = root(static_cast<int>(i)), b = root(static_cast<int>(k));
      if (a == b) continue;
      nth(group_, std::max(a, b)) = std::min(a, b);
      --groups;
    }
  }
  ++nth(figures_.looked, Property::reported).times;
  check(Property::reported, groups <= model_.max_regions || has(status, StepStatus::regions_full),
        with_number("groups of points beyond max_regions, unreported: %.0f", groups));
}

void Watch::check_rest() {
  ++nth(figures_.looked, Property::rest).times;
  check(Property::rest, total_force_n(state_).isZero(0.0), "a force without contact");
  double farthest_m = 0.0, turned = 0.0;
  for (std::size_t v = 0; v < model_.rest.vertex_count(); ++v) {
    Vec3 u_m, change;
    for (std::size_t k = 0; k < 3; ++k) {
      u_m[static_cast<int>(k)] = state_.field.displacement_m[k][v];
      change[static_cast<int>(k)] = state_.field.normal[k][v] - model_.rest.normal[k][v];
    }
    // NaN counts as far.
    farthest_m = u_m.norm() <= farthest_m ? farthest_m : u_m.norm();
    turned = change.norm() <= turned ? turned : change.norm();
  }
  figures_.farthest_from_rest_m = std::max(figures_.farthest_from_rest_m, farthest_m);
  check(Property::rest, farthest_m <= rest_tolerance_m, with_number("not at rest without contact: %g m", farthest_m));
  check(Property::rest, turned <= 1e-6, with_number("a normal not at rest without contact: %g", turned));
}

std::int64_t resident_bytes() {
  std::int64_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

}  // namespace touchstone::soak
