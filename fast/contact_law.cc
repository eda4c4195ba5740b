#include "fast/contact_law.h"

#include <cmath>
#include <limits>

namespace touchstone::fast {

DuffingLaw::DuffingLaw(double k1_n_per_m, double k3_n_per_m3) noexcept
    : k1_(k1_n_per_m),
      k3_(k3_n_per_m3),
      peak_depth_m_(k3_n_per_m3 < 0.0 ? std::sqrt(k1_n_per_m / (-3.0 * k3_n_per_m3))
                                      : std::numeric_limits<double>::infinity()) {}

double DuffingLaw::slope_n_per_m(double depth_m) const noexcept {
  if (depth_m >= peak_depth_m_) return 0.0;
  return k1_ + 3.0 * k3_ * depth_m * depth_m;
}

double DuffingLaw::energy_j(double depth_m) const noexcept {
  if (depth_m > peak_depth_m_) return energy_j(peak_depth_m_) + force_n(peak_depth_m_) * (depth_m - peak_depth_m_);
  const double D2 = depth_m * depth_m;
  return D2 * (0.5 * k1_ + 0.25 * k3_ * D2);
}

double DuffingLaw::depth_m(double force_n) const noexcept {
  const double F = force_n;
  if (F == 0.0) return 0.0;
  if (k3_ == 0.0) return k1_ > 0.0 ? F / k1_ : 0.0;
  if (k3_ < 0.0) {
    // F / F* = (3x - x^3) / 2 with x = D / D* = 2 sin(a) is sin(3a).
    const double peak_n = this->force_n(peak_depth_m_);
    if (F >= peak_n) return peak_depth_m_;
    return 2.0 * peak_depth_m_ * std::sin(std::asin(F / peak_n) / 3.0);
  }
  // D^3 + p D = q. With D = s sinh(t), s = 2 sqrt(p/3), this is sinh(3t) = 3q / (p s).
  const double p = k1_ / k3_, q = F / k3_;
  const double s = 2.0 * std::sqrt(p / 3.0);
  const double argument = 3.0 * q / (p * s);
  // k1 = 0, or so small that the cube alone decides.
  if (!(argument < 1e100)) return std::isnan(F) ? F : std::cbrt(q);
  return s * std::sinh(std::asinh(argument) / 3.0);
}

}  // namespace touchstone::fast
