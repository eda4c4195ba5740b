#include "fast/local_factor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// w_p of a point contact.
double point_factor(const LocalConstants& c, double r_m) noexcept {
  return 1.0 + c.C_n * std::log((r_m + c.C_r_m) / (c.r_R_m + c.C_r_m));
}

/// Of a disc of the region's area: nearer points are in contact.
double contact_radius_m(const RegionSize& size) noexcept { return std::sqrt(size.area_m2 / std::numbers::pi); }

/// 0 below 0, 1 above 1, flat at both ends.
double smoothstep(double t) noexcept {
  const double x = std::clamp(t, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

template <auto factor>
void apply(const SurfacePatches& rest, const LocalConstants& constants, const RegionSize& size, const Vec3& p0_W_m,
           SurfaceField& field) noexcept {
  for (const Patch& patch : rest.patches) {
    if ((patch.center_W_m - p0_W_m).norm() > patch.radius_m + constants.r_R_m) continue;
    for (auto v = static_cast<std::size_t>(patch.begin); v < static_cast<std::size_t>(patch.end); ++v) {
      const Vec3 rest_m(rest.rest_W_m[0][v], rest.rest_W_m[1][v], rest.rest_W_m[2][v]);
      const double r2_m2 = (rest_m - p0_W_m).squaredNorm();
      if (r2_m2 >= constants.r_R_m * constants.r_R_m) continue;
      const auto w = static_cast<float>(factor(constants, size, std::sqrt(r2_m2)));
      for (auto& column : field.displacement_m) column[v] *= w;
    }
  }
}

}  // namespace

double local_factor_published(const LocalConstants& c, const RegionSize& size, double r_m) noexcept {
  if (r_m <= contact_radius_m(size)) return 1.0;
  return point_factor(c, r_m) / (1.0 + std::log(std::max(1, size.points)));
}

double local_factor_corrected(const LocalConstants& c, const RegionSize& size, double r_m) noexcept {
  const double point_area_m2 = std::numbers::pi * c.C_r_m * c.C_r_m;  // A_0
  const double area_part = 1.0 / (1.0 + std::log(std::max(1.0, size.area_m2 / point_area_m2)));
  const double w = std::max(0.0, point_factor(c, r_m)) * (area_part + (1.0 - area_part) * smoothstep(r_m / c.r_R_m));
  const double rim_m = contact_radius_m(size);
  return 1.0 + smoothstep((r_m - rim_m) / c.C_r_m) * (w - 1.0);
}

void apply_local_factor_published(const SurfacePatches& rest, const LocalConstants& constants, const RegionSize& size,
                                  const Vec3& p0_W_m, SurfaceField& field) noexcept {
  apply<local_factor_published>(rest, constants, size, p0_W_m, field);
}

void apply_local_factor_corrected(const SurfacePatches& rest, const LocalConstants& constants, const RegionSize& size,
                                  const Vec3& p0_W_m, SurfaceField& field) noexcept {
  apply<local_factor_corrected>(rest, constants, size, p0_W_m, field);
}

}  // namespace touchstone::fast
