#include "fast/contact/friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

/// A length this part shorter than another is taken as equal: more than rounding, less than any step.
constexpr double rounding_rel = 1e-12;
/// A sliding tool goes on sliding while its stretch is short of the sliding one by no more than this part. On a curved
/// body samples come into the region and leave it, and D_n jumps by some 0.3 %: more than a slow tool moves in a tick.
constexpr double slack_rel = 0.05;
/// Depths below this [m] are no contact, and vectors shorter than this have no direction: ratios of them may overflow.
constexpr double smallest = 1e-100;

Vec3 tangential(const Vec3& v, const Vec3& d) noexcept { return v - v.dot(d) * d; }

Vec3 scaled_to(const Vec3& v, double length) noexcept {
  const double norm = v.norm();
  return norm > smallest ? Vec3(v * (length / norm)) : Vec3(Vec3::Zero());
}

/// The turn that takes `from` to `to` the short way, applied to a vector at right angles to `from`. Keeps its length.
Vec3 carried(const Vec3& v, const Vec3& from, const Vec3& to) noexcept {
  const double opposite = 1.0 + from.dot(to);
  const Vec3 turned = opposite > 1e-6 ? Vec3(v - (v.dot(to) / opposite) * (from + to)) : v;
  return scaled_to(tangential(turned, to), v.norm());
}

/// Brings the state to this tick's d. A region without depth does not touch the body, and has nothing to remember.
void carry(const Vec3& d, double normal_depth_m, FrictionState& state) noexcept {
  if (!(normal_depth_m > smallest)) state = FrictionState{};
  if (state.d == d) return;
  state.stretch_m = carried(state.stretch_m, state.d, d);
  state.motion = carried(state.motion, state.d, d);
  state.d = d;
}

}  // namespace

FrictionLaw::FrictionLaw(const scene::Friction& friction) noexcept
    : K_(friction.K),
      beta_(friction.beta),
      mu_D_(friction.mu_D),
      bound_n_(std::numeric_limits<double>::infinity()),
      stiffness_root_(std::sqrt(friction.stiffness_ratio)) {
  if (mu_D_ > 0.0 && beta_ < 1.0) bound_n_ = std::pow(K_ / mu_D_, 1.0 / (1.0 - beta_));
  if (beta_ >= 1.0 && mu_D_ > K_) bound_n_ = 0.0;
}

double FrictionLaw::limit_n(double normal_n) const noexcept { return K_ * std::pow(normal_n, beta_); }

Vec3 material_step_m(const Placement& before, const Placement& now, const Vec3& arm_m) noexcept {
  return arm_m - before.R_WT * (now.R_WT.transpose() * arm_m) + (now.origin_W_m - before.origin_W_m);
}

double sliding_stretch_m(const FrictionLaw& friction, const DuffingLaw& law, double normal_depth_m) noexcept {
  // In y = sqrt(kappa) D_t, with which |D| = hypot(D_n, y) and F_t = sqrt(kappa) s y, s the secant of the law at |D|.
  const double root = friction.stiffness_root();
  const double D_n = normal_depth_m, farthest = friction.mu_D() / root * D_n;
  if (!(D_n > smallest) || farthest == 0.0 || friction.K() == 0.0) return 0.0;
  if (law.secant_n_per_m(std::hypot(D_n, farthest)) * D_n <= friction.bound_n()) return farthest / root;
  // F_t = f_max is s^(1 - beta) y = K / sqrt(kappa) D_n^beta, whose left side rises with y for every law. Newton on the
  // logarithms, whose slope lies between 0.5 and 2, kept within the bracket.
  const double rest = 1.0 - friction.beta();
  const double goal = std::log(friction.K() / root) + friction.beta() * std::log(D_n);
  double low = 0.0, high = farthest, y = farthest;
  for (int iteration = 0; iteration < 60; ++iteration) {
    const double D = std::hypot(D_n, y), s = law.secant_n_per_m(D);
    const double excess = rest * std::log(s) + std::log(y) - goal;
    (excess > 0.0 ? high : low) = y;
    const double along = y / D;
    const double slope = 1.0 + rest * (law.slope_n_per_m(D) / s - 1.0) * along * along;
    double next = y * std::exp(-excess / slope);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const bool settled = std::abs(next - y) <= 4.0 * std::numeric_limits<double>::epsilon() * y;
    y = next;
    if (settled) break;
  }
  return y / root;
}

Vec3 resolve_friction_corrected(const FrictionLaw& friction, const DuffingLaw& law, const Mat3& /*R_WT*/, const Vec3& d,
                                const RegionPoints& /*points*/, const Vec3& step_m, RegionForce& force,
                                FrictionState& state) noexcept {
  const double D_n = law.depth_m(force.magnitude_n);
  carry(d, D_n, state);
  const Vec3 step = D_n > smallest ? tangential(step_m, d) : Vec3(Vec3::Zero());
  const Vec3 trial = state.stretch_m + step;
  const double reach = trial.norm();

  double longest = 0.0;
  if (state.sliding) {
    longest = sliding_stretch_m(friction, law, D_n);
    const double before = state.stretch_m.norm();
    const double drive = before > 0.0 ? step.dot(state.stretch_m) / before : 0.0;
    // While the limit falls, a way back slower than it leaves the tool sliding.
    const bool turns_back = drive < std::min(0.0, longest - before) - rounding_rel * longest;
    state.sliding = !turns_back && reach >= (1.0 - slack_rel) * longest;
  }
  const double root = friction.stiffness_root(), kappa = root * root;
  if (!state.sliding) {
    const double s = law.secant_n_per_m(std::hypot(D_n, root * reach));
    state.sliding = kappa * s * reach > friction.limit_n(s * D_n);
    if (state.sliding) longest = sliding_stretch_m(friction, law, D_n);
  }
  state.stretch_m = state.sliding && reach > longest ? scaled_to(trial, longest) : trial;

  const double D = std::hypot(D_n, root * state.stretch_m.norm()), s = law.secant_n_per_m(D);
  force.saturated = force.saturated || D > law.peak_depth_m();
  set_force(d, s * D_n, -kappa * s * state.stretch_m, force);
  return D_n * d + state.stretch_m;
}

namespace {

/// F_cn and F_ct of a deformation that is stuck.
struct Components {
  double normal_n = 0.0, tangential_n = 0.0;
  Vec3 load_center_T_m = Vec3::Zero();
  double deepest_m = 0.0;
};

Components components(const DuffingLaw& law, const RegionPoints& points, double D_n, double D_t) noexcept {
  if (!(D_n > smallest)) return {};
  if (points.count == 1) return {law.force_n(D_n), law.force_n(D_t), points.p_T_m(0), std::max(D_n, D_t)};
  const double D = std::hypot(D_n, D_t);
  const RegionLoad load = region_load(law, points, D / D_n);
  return {load.force_n * (D_n / D), load.force_n * (D_t / D), load.center_T_m, load.deepest_m};
}

}  // namespace

Vec3 resolve_friction_published(const FrictionLaw& friction, const DuffingLaw& law, const Mat3& R_WT, const Vec3& d,
                                const RegionPoints& points, const Vec3& step_m, RegionForce& force,
                                FrictionState& state) noexcept {
  double D_n = law.depth_m(force.magnitude_n);
  carry(d, D_n, state);
  const Vec3 step = D_n > smallest ? tangential(step_m, d) : Vec3(Vec3::Zero());
  if (step.norm() > rounding_rel * D_n) state.motion = step.normalized();

  const Vec3 trial = state.stretch_m + step;
  Components here = components(law, points, D_n, trial.norm());
  double f_max = friction.limit_n(here.normal_n);
  const bool past_limit = here.tangential_n > f_max;                              // C4
  const bool stuck = !state.sliding || friction.mu_D() * here.normal_n >= f_max;  // C1 or C2; else C3
  Vec3 against;
  if (!past_limit && stuck) {
    state.sliding = false;
    state.stretch_m = trial;
    against = state.stretch_m;
  } else {
    // p0 moves with the tool, so the stretch stays.
    state.sliding = true;
    here = components(law, points, D_n, state.stretch_m.norm());
    f_max = friction.limit_n(here.normal_n);
    here.tangential_n = friction.mu_D() * here.normal_n;
    if (past_limit && here.tangential_n > f_max) {
      here.tangential_n = f_max;
      here.normal_n = f_max / friction.mu_D();
      D_n = law.depth_m(here.normal_n);
    }
    against = state.motion != Vec3::Zero() ? state.motion : state.stretch_m;
  }
  force.load_center_m = R_WT * here.load_center_T_m;
  force.saturated = force.saturated || here.deepest_m > law.peak_depth_m();
  set_force(d, here.normal_n, scaled_to(against, -here.tangential_n), force);
  if (points.count == 1) return D_n * d + state.stretch_m;
  return scaled_to(force.force_n, -law.depth_m(force.magnitude_n));
}

}  // namespace touchstone::fast
