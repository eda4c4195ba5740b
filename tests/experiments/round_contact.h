// The model's expected force under an axisymmetric tool pressed along its axis onto a flat face: the contact is a disc,
// integrated by quadrature, without samples.
#pragma once

#include "scene/model/scene.h"

#include <cmath>
#include <functional>
#include <numbers>

namespace touchstone::test {

/// A round contact.
struct RoundContact {
  double radius_m = 0.0;
  std::function<double(double r_m)> depth_m;  ///< d_i at a distance from the axis

  [[nodiscard]] double area_m2() const { return std::numbers::pi * radius_m * radius_m; }
};

inline RoundContact ball_contact(double ball_radius_m, double depth_m) {
  const double R = ball_radius_m;
  return {std::sqrt(2.0 * R * depth_m - depth_m * depth_m),
          [=](double r_m) { return depth_m - (R - std::sqrt(R * R - r_m * r_m)); }};
}

/// F of appendix III, the mean of the law over the contact: weighted by the lever arm r as printed, by 1 / r if
/// corrected (errata E6). Projected along d, the tool's area times cos(theta) is the disc's.
inline double mean_force_n(scene::Formulation formulation, const std::function<double(double)>& law_n,
                           const RoundContact& contact) {
  constexpr int rings = 2000;
  double sum = 0.0, weights = 0.0;
  for (int i = 0; i < rings; ++i) {
    const double r = contact.radius_m * (i + 0.5) / rings;
    const double share = formulation == scene::Formulation::published ? r : 1.0 / r;
    sum += share * r * law_n(contact.depth_m(r));
    weights += share * r;
  }
  return sum / weights;
}

}  // namespace touchstone::test
