#include "fast/contact/contact_law.h"

#include <cmath>
#include <limits>
#include <numbers>

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
  if (F == 0.0 || std::isnan(F)) return F;
  if (k3_ == 0.0) return k1_ > 0.0 ? F / k1_ : 0.0;
  if (k3_ < 0.0) {
    // F / F* = (3x - x^3) / 2 with x = D / D* = 2 sin(a) is sin(3a).
    const double peak_n = this->force_n(peak_depth_m_);
    if (F >= peak_n) return peak_depth_m_;
    return 2.0 * peak_depth_m_ * std::sin(std::asin(F / peak_n) / 3.0);
  }
  // With D = s sinh(t), s = 2 sqrt(k1 / (3 k3)), the cubic is sinh(3t) = x.
  const double linear_m = F / k1_, x = 1.5 * linear_m * std::sqrt(3.0 * k3_ / k1_);
  if (x < 1e-9) return linear_m;
  // k1 = 0, or so small that the cube alone decides.
  if (!(x < 1e100)) return std::cbrt(F / k3_);
  return 2.0 * std::sqrt(k1_ / (3.0 * k3_)) * std::sinh(std::asinh(x) / 3.0);
}

double contact_radius_m(double area_m2) noexcept { return std::sqrt(area_m2 / std::numbers::pi); }

DuffingLaw ContactLaw::at(double contact_radius_m) const noexcept {
  const scene::Contact& c = contact_;
  switch (c.law) {
    case scene::ContactLaw::duffing:
      return {c.k1_n_per_m, c.k3_n_per_m3};
    case scene::ContactLaw::area_aware:
      return {c.k1_per_radius_n_per_m2 * contact_radius_m, c.k3_n_per_m3};
  }
  return {0.0, 0.0};
}

}  // namespace touchstone::fast
