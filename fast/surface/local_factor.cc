#include "fast/surface/local_factor.h"

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

/// Radius of the disc with the region's area: points nearer than that are in contact.
double contact_radius_m(const RegionSize& size) noexcept { return std::sqrt(size.area_m2 / std::numbers::pi); }

/// 0 below 0, 1 above 1, flat at both ends.
double smoothstep(double t) noexcept {
  const double x = std::clamp(t, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

/// Factor on the displacement of a region that is this many times as large as a point contact.
double area_part(double points) noexcept { return 1.0 / (1.0 + std::log(std::max(1.0, points))); }

double point_areas(const LocalConstants& c, const RegionSize& size) noexcept {
  return size.area_m2 / (std::numbers::pi * c.C_r_m * c.C_r_m);  // A / A_0
}

FactorTerms terms(const LocalConstants& c, const RegionSize& size, double points) noexcept {
  FactorTerms out;
  out.C_n = static_cast<float>(c.C_n);
  out.C_r_m = static_cast<float>(c.C_r_m);
  out.inverse_C_r_per_m = static_cast<float>(1.0 / c.C_r_m);
  out.inverse_r_R_per_m = static_cast<float>(1.0 / c.r_R_m);
  out.inverse_reach_per_m = static_cast<float>(1.0 / (c.r_R_m + c.C_r_m));
  out.area_part = static_cast<float>(area_part(points));
  out.rim_m = static_cast<float>(contact_radius_m(size));
  return out;
}

}  // namespace

double local_factor_published(const LocalConstants& c, const RegionSize& size, double r_m) noexcept {
  return local_room_published(c, size, r_m) == 0.0 ? 1.0 : point_factor(c, r_m) * area_part(size.points);
}

double local_factor_corrected(const LocalConstants& c, const RegionSize& size, double r_m) noexcept {
  const double area = area_part(point_areas(c, size));
  const double w = std::max(0.0, point_factor(c, r_m)) * (area + (1.0 - area) * smoothstep(r_m / c.r_R_m));
  return 1.0 + local_room_corrected(c, size, r_m) * (w - 1.0);
}

double local_room_published(const LocalConstants&, const RegionSize& size, double r_m) noexcept {
  return r_m <= contact_radius_m(size) ? 0.0 : 1.0;
}

double local_room_corrected(const LocalConstants& c, const RegionSize& size, double r_m) noexcept {
  return smoothstep((r_m - contact_radius_m(size)) / c.C_r_m);
}

FactorTerms factor_terms_published(const LocalConstants& c, const RegionSize& size) noexcept {
  return terms(c, size, size.points);
}

FactorTerms factor_terms_corrected(const LocalConstants& c, const RegionSize& size) noexcept {
  return terms(c, size, point_areas(c, size));
}

}  // namespace touchstone::fast
