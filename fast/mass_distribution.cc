#include "fast/mass_distribution.h"

#include <algorithm>
#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// r_i^2 about the line through the mass centre along d [m^2].
double lever_arm2_m2(const RegionPoints& points, std::size_t i, const Vec3& d_T) noexcept {
  const Vec3 p(points.x_T_m[i], points.y_T_m[i], points.z_T_m[i]);
  return (p - p.dot(d_T) * d_T).squaredNorm();
}

void normalise(RegionPoints& points, double sum) noexcept {
  const auto count = static_cast<std::size_t>(points.count);
  if (sum > 0.0) {
    for (std::size_t i = 0; i < count; ++i) points.share[i] /= sum;
  } else {
    for (std::size_t i = 0; i < count; ++i) points.share[i] = 1.0 / points.count;
  }
}

}  // namespace

void distribute_mass_published(const Vec3& d_T, double /*r_0_m*/, RegionPoints& points) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    points.share[i] = std::sqrt(lever_arm2_m2(points, i, d_T)) * points.cos_theta[i];
    sum += points.share[i];
  }
  normalise(points, sum);
}

void distribute_mass_corrected(const Vec3& d_T, double r_0_m, RegionPoints& points) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    points.share[i] =
        points.area_m2[i] * points.cos_theta[i] / std::sqrt(lever_arm2_m2(points, i, d_T) + r_0_m * r_0_m);
    sum += points.share[i];
  }
  normalise(points, sum);
}

}  // namespace touchstone::fast
