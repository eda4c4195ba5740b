#include "fast/live/safety.h"

#include <algorithm>
#include <cmath>

namespace touchstone::live {
namespace {

/// Margin for the rounding of norms, so that the printed limits hold.
constexpr double below = 1.0 - 1e-12;

bool finite(const Wrench& w) noexcept { return w.force_n.allFinite() && w.torque_nm.allFinite(); }

/// Norm in newtons; infinite only if it exceeds the range of doubles.
double size_n(const Wrench& w, double lever_m) noexcept {
  return std::max(w.force_n.stableNorm(), w.torque_nm.stableNorm() / lever_m);
}

/// The wrench reduced to at most this norm, direction kept.
Wrench saturated(const Wrench& w, double lever_m, double largest_n) noexcept {
  // Scaled down first, so that no norm overflows.
  const double peak = std::max(w.force_n.cwiseAbs().maxCoeff(), w.torque_nm.cwiseAbs().maxCoeff() / lever_m);
  if (!(peak > 0.0)) return w;
  if (std::isfinite(peak) && size_n(w, lever_m) <= largest_n) return w;
  const double scale = std::max(w.force_n.cwiseAbs().maxCoeff(), w.torque_nm.cwiseAbs().maxCoeff());
  const Wrench unit{w.force_n / scale, w.torque_nm / scale};
  const double factor = largest_n / size_n(unit, lever_m);
  return {factor * unit.force_n, factor * unit.torque_nm};
}

}  // namespace

WrenchLimiter::WrenchLimiter(const WrenchLimits& limits, double period_s) noexcept
    : limits_(limits),
      largest_n_(below * limits.force_max_n),
      step_n_(below * limits.force_slew_n_per_s * period_s),
      fade_step_(limits.release_s > period_s ? period_s / limits.release_s : 1.0) {
  limits_.lever_m = std::max(limits.lever_m, 1e-6);
}

const Wrench& WrenchLimiter::next(const Wrench& asked, bool good) noexcept {
  good = good && finite(asked);
  if (good) target_ = saturated(asked, limits_.lever_m, largest_n_);
  gain_ = std::clamp(gain_ + (good ? fade_step_ : -fade_step_), 0.0, 1.0);

  const Wrench wanted{gain_ * target_.force_n, gain_ * target_.torque_nm};
  const Wrench change{wanted.force_n - sent_.force_n, wanted.torque_nm - sent_.torque_nm};
  if (size_n(change, limits_.lever_m) <= step_n_) {
    sent_ = wanted;
  } else {
    const Wrench step = saturated(change, limits_.lever_m, step_n_);
    // Both ends are within the limit, and so is every wrench between them up to rounding.
    sent_ = saturated({sent_.force_n + step.force_n, sent_.torque_nm + step.torque_nm}, limits_.lever_m, largest_n_);
  }
  limited_ = !good || sent_.force_n != asked.force_n || sent_.torque_nm != asked.torque_nm;
  return sent_;
}

}  // namespace touchstone::live
