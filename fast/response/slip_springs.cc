#include "fast/response/slip_springs.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// A force this part short of its limit is at it: more than rounding.
constexpr double rounding_rel = 1e-9;

/// Sum of the springs' forces after a common step, each returned to its limit, and its derivative by the step.
struct Trial {
  Vector2d force_n = Vector2d::Zero();
  Matrix2d stiffness_n_per_m = Matrix2d::Zero();
  int slipping = 0;
};

struct Forces {
  std::array<double, SlipSprings::count> x_n, y_n;
};

Trial after_step(const SlipState& state, const std::array<double, SlipSprings::count>& pressing_n, double coefficient,
                 const Vector2d& step_m, Forces& to) noexcept {
  Trial out;
  double x_n = 0.0, y_n = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (int i = 0; i < state.touching; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double stiffness = state.stiffness_n_per_m[k], limit_n = coefficient * pressing_n[k];
    const double tx_n = state.x_n[k] + stiffness * step_m.x(), ty_n = state.y_n[k] + stiffness * step_m.y();
    const double trial_n = std::sqrt(tx_n * tx_n + ty_n * ty_n);
    const bool slips = trial_n >= limit_n * (1.0 - rounding_rel);
    const double share = slips && trial_n > limit_n ? limit_n / trial_n : 1.0;
    const double turning = slips && trial_n > 0.0 ? stiffness * share / (trial_n * trial_n) : 0.0;
    to.x_n[k] = share * tx_n;
    to.y_n[k] = share * ty_n;
    x_n += to.x_n[k];
    y_n += to.y_n[k];
    out.slipping += slips ? 1 : 0;
    if (turning > 0.0) {
      xx += turning * ty_n * ty_n;
      xy -= turning * tx_n * ty_n;
      yy += turning * tx_n * tx_n;
    } else if (!slips) {
      xx += stiffness;
      yy += stiffness;
    }
  }
  out.force_n = {x_n, y_n};
  out.stiffness_n_per_m << xx, xy, xy, yy;
  return out;
}

/// Newton's method on the step of the springs: the tool's step is theirs and the body's together.
Trial find_step(const SlipState& state, const std::array<double, SlipSprings::count>& pressing_n, double coefficient,
                const Matrix2d& compliance_m_per_n, const Vector2d& drive_m, Vector2d& step_m, Forces& to) noexcept {
  constexpr int most = 25;
  step_m.setZero();
  Trial trial = after_step(state, pressing_n, coefficient, step_m, to);
  for (int iteration = 0; iteration < most; ++iteration) {
    const Vector2d open_m = step_m + compliance_m_per_n * trial.force_n - drive_m;
    const Matrix2d slope = Matrix2d::Identity() + compliance_m_per_n * trial.stiffness_n_per_m;
    const Vector2d change_m = slope.inverse() * open_m;
    step_m -= change_m;
    trial = after_step(state, pressing_n, coefficient, step_m, to);
    if (!(change_m.norm() > 1e-14 + 1e-12 * step_m.norm())) break;
  }
  return trial;
}

}  // namespace

SlipSprings::SlipSprings(const scene::Friction& friction, double poissons_ratio, const ContactTable& table)
    : friction_(friction), shear_ratio_(2.0 * (1.0 - poissons_ratio) / (2.0 - poissons_ratio)), table_(table) {
  ends_.push_back({0.0, 0.0, 0.0, 0.0});
  for (int i = 1; i <= count; ++i) {
    const double share = static_cast<double>(i) / count, depth_m = share * share * table.largest_indentation_m();
    const LocalContact law = table.at(depth_m);
    ends_.push_back({depth_m, law.force_n, law.stiffness_n_per_m, law.radius_m});
  }
}

double SlipSprings::coefficient(double normal_n, bool sliding) const noexcept {
  if (!(normal_n > 0.0)) return 0.0;
  const double at_rest = friction_.K * std::pow(normal_n, friction_.beta - 1.0);
  return sliding ? std::min(friction_.mu_D, at_rest) : at_rest;
}

bool SlipState::carry(const scene::Vec3& normal) noexcept {
  if (frame.isZero(0.0)) {
    frame.col(0) = normal.unitOrthogonal();
    frame.col(1) = normal.cross(frame.col(0));
    return false;
  }
  const scene::Vec3 last = frame.col(0).cross(frame.col(1));
  if (last == normal) return true;
  const scene::Mat3 turn = Eigen::Quaterniond::FromTwoVectors(last, normal).toRotationMatrix();
  frame.col(0) = turn * frame.col(0);
  frame.col(0) = (frame.col(0) - frame.col(0).dot(normal) * normal).normalized();
  frame.col(1) = normal.cross(frame.col(0));
  return true;
}

Slip slip(const SlipSprings& springs, const LocalContact& law, double indentation_m, const Matrix2d& compliance_m_per_n,
          const Vector2d& sway_m, const Vector2d& step_m, SlipState& state) noexcept {
  const std::vector<SlipSprings::End>& ends = springs.ends();
  const LocalContact here = springs.table().at(indentation_m);
  const SlipSprings::End top{std::min(indentation_m, ends.back().depth_m), here.force_n, here.stiffness_n_per_m,
                             here.radius_m};
  // The springs' pressing forces sum to the table's force, and by this to that of the place.
  const double scale = here.force_n > 0.0 ? law.force_n / here.force_n : 0.0;
  std::array<double, SlipSprings::count> pressing_n;
  int touching = 0;
  for (; touching < SlipSprings::count; ++touching) {
    const auto k = static_cast<std::size_t>(touching);
    const SlipSprings::End &low = ends[k], &high = ends[k + 1].depth_m < top.depth_m ? ends[k + 1] : top;
    if (!(low.depth_m < top.depth_m)) break;
    const double stiffness =
        springs.shear_ratio() * scale * std::max(high.stiffness_n_per_m - low.stiffness_n_per_m, 0.0);
    pressing_n[k] =
        scale * std::max(high.force_n - low.force_n + high.stiffness_n_per_m * (top.depth_m - high.depth_m) -
                             low.stiffness_n_per_m * (top.depth_m - low.depth_m),
                         0.0);
    // Stiffness is added without shear; stiffness that is lost takes its share of the force with it.
    double& last = state.stiffness_n_per_m[k];
    if (stiffness < last) {
      state.x_n[k] *= stiffness / last;
      state.y_n[k] *= stiffness / last;
    }
    last = stiffness;
  }
  for (int i = touching; i < state.touching; ++i) {
    const auto k = static_cast<std::size_t>(i);
    state.x_n[k] = state.y_n[k] = state.stiffness_n_per_m[k] = 0.0;
  }
  state.touching = touching;

  const Vector2d drive_m = step_m + state.body_m - sway_m;
  Vector2d local_step_m;
  Forces forces;
  Trial trial = find_step(state, pressing_n, springs.coefficient(law.force_n, state.sliding), compliance_m_per_n,
                          drive_m, local_step_m, forces);
  const bool was_sliding = state.sliding;
  state.sliding = touching > 0 && trial.slipping == touching;
  if (state.sliding && !was_sliding) {
    trial = find_step(state, pressing_n, springs.coefficient(law.force_n, true), compliance_m_per_n, drive_m,
                      local_step_m, forces);
  }
  Slip out;
  out.force_n = state.last_n = trial.force_n;
  for (int i = 0; i < touching; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double a0 = ends[k].radius_m, a1 = std::min(ends[k + 1].radius_m, top.radius_m);
    state.x_n[k] = forces.x_n[k];
    state.y_n[k] = forces.y_n[k];
    out.moment_n_m2 += (a0 * a0 + a0 * a1 + a1 * a1) / 3.0 * Vector2d(forces.x_n[k], forces.y_n[k]);
  }
  if (touching > 0 && state.stiffness_n_per_m[0] > 0.0) {
    out.displacement_m = Vector2d(forces.x_n[0], forces.y_n[0]) / state.stiffness_n_per_m[0];
  }
  // The body takes the rest of the tool's step. If Newton's method stopped short, the next tick goes on from there.
  state.body_m += step_m - local_step_m;
  return out;
}

}  // namespace touchstone::fast
