#include "fast/response/finite_strain.h"

#include <algorithm>

namespace touchstone::fast {

FiniteStrain finite_strain(double poissons_ratio) noexcept {
  const double nu = poissons_ratio;
  return {.c1 = -0.73 + nu * (1.093 + nu * 1.447),
          .c2 = 0.355 - nu * (0.423 + nu * 1.033),
          .k1 = -0.14 + nu * (0.295 + nu * 0.35),
          .p1 = 1.45 + nu * (-2.853 - nu * 1.933),
          .p2 = -1.72 + nu * (1.857 + nu * 2.367)};
}

BallField::BallField(double poissons_ratio) noexcept {
  // At rho = 0, 0.2, ..., 3.
  constexpr Table outward_0{0.0,    0.061,  0.114,  0.149,  0.155,  0.116,  0.026,  0.005,
                            -0.001, -0.004, -0.005, -0.005, -0.005, -0.005, -0.005, -0.0045};
  constexpr Table outward_03{0.0,     0.043,  0.077,   0.094,   0.086,   0.038,   -0.016,  -0.021,
                             -0.0205, -0.018, -0.0157, -0.0136, -0.0118, -0.0103, -0.0090, -0.0080};
  constexpr Table outward_05{0.0,     0.037,   0.064,   0.071,   0.048,   -0.011,  -0.029,  -0.028,
                             -0.0237, -0.0195, -0.0162, -0.0134, -0.0113, -0.0097, -0.0083, -0.0072};
  constexpr Table up_0{0.0,    0.0,    0.0,    0.0,    0.0,    0.0,    -0.020, -0.026,
                       -0.017, -0.012, -0.009, -0.007, -0.005, -0.004, -0.002, 0.0};
  constexpr Table up_03{0.0,    0.0,    0.0,    0.0,    0.0,    0.0,    -0.031, -0.018,
                        -0.012, -0.007, -0.004, -0.003, -0.002, -0.001, 0.0,    0.0};
  constexpr Table up_05{0.0,    0.0,   0.0,   0.0,   0.0,   0.0,   -0.008, -0.003,
                        -0.001, 0.001, 0.002, 0.002, 0.002, 0.002, 0.001,  0.0};
  const double nu = poissons_ratio;
  const double at_03 = nu * (0.5 - nu) / 0.06, at_05 = nu * (nu - 0.3) / 0.1, at_0 = 1.0 - at_03 - at_05;
  for (std::size_t i = 0; i <= steps; ++i) {
    outward_[i] = at_0 * outward_0[i] + at_03 * outward_03[i] + at_05 * outward_05[i];
    up_[i] = at_0 * up_0[i] + at_03 * up_03[i] + at_05 * up_05[i];
  }
}

BallField::Value BallField::at(double rho, double body_share) const noexcept {
  // Of a curved body, per its share.
  constexpr Table curved{0.0,    -0.103, -0.196, -0.282, -0.345, -0.300, -0.182, -0.119,
                         -0.083, -0.062, -0.048, -0.038, -0.031, -0.025, -0.021, -0.018};
  if (rho > reach) return {far(body_share) / (rho * rho), 0.0};
  const double place = rho / reach * steps;
  const std::size_t i = std::min(static_cast<std::size_t>(place), steps - 1);
  const double high = place - static_cast<double>(i), low = 1.0 - high;
  return {low * (outward_[i] + body_share * curved[i]) + high * (outward_[i + 1] + body_share * curved[i + 1]),
          low * up_[i] + high * up_[i + 1]};
}

}  // namespace touchstone::fast
