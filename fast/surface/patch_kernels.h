// Building blocks of the loops over the vertices of a patch, for the files that have such loops.
#pragma once

#include "fast/realtime/wide_loops.h"
#include "fast/surface/hat.h"
#include "scene/base/index.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace touchstone::fast {

inline constexpr std::size_t corners_max = patch_corners_max;

/// A kernel function (hat.h) at the vertices of a patch.
class Hat {
 public:
  Hat(const SurfacePatches& rest, const HatPart& part) noexcept
      : free_(rest.free.data()),
        ceiling_(static_cast<float>(part.ceiling)),
        per_free_(static_cast<float>(part.per_free)) {
    for (std::size_t k = 0; k < corners_max; ++k) {
      weight_[k] = rest.weight[k].data();
      base_[k] = static_cast<float>(part.base[k]);
      slope_[k] = static_cast<float>(part.slope[k]);
    }
  }
  [[nodiscard]] TOUCHSTONE_INLINE float operator()(std::size_t v) const noexcept {
    const float h0 = base_[0] + slope_[0] * weight_[0][v], h1 = base_[1] + slope_[1] * weight_[1][v];
    const float h2 = base_[2] + slope_[2] * weight_[2][v], h3 = base_[3] + slope_[3] * weight_[3][v];
    const float f = per_free_ * free_[v];
    const float a = h0 < h1 ? h0 : h1, b = h2 < h3 ? h2 : h3, c = f < ceiling_ ? f : ceiling_;
    const float d = a < b ? a : b, e = c < d ? c : d;
    return e > 0.0f ? e : 0.0f;
  }

 private:
  const float* free_;
  float ceiling_, per_free_;
  std::array<float, corners_max> base_, slope_;
  std::array<const float*, corners_max> weight_;
};

/// Adds a kernel function of that height over a patch to the displacements.
TOUCHSTONE_INLINE void raise(const SurfacePatches& rest, const Patch& patch, const HatPart& part,
                             const scene::Vec3& height_m, float* x, float* y, float* z) noexcept {
  const Hat hat(rest, part);
  const Eigen::Vector3f rise = height_m.cast<float>();
  const auto begin = static_cast<std::size_t>(patch.begin), end = static_cast<std::size_t>(patch.end);
  // Columns never overlap.
#pragma GCC ivdep
  for (std::size_t v = begin; v < end; ++v) {
    const float height = hat(v);
    x[v] += height * rise.x();
    y[v] += height * rise.y();
    z[v] += height * rise.z();
  }
}

/// Sum of a patch quantity by weight at vertex v.
class Weighted {
 public:
  Weighted(const SurfacePatches& rest, const std::array<double, corners_max>& corner) noexcept {
    for (std::size_t k = 0; k < corners_max; ++k) {
      weight_[k] = rest.weight[k].data();
      corner_[k] = static_cast<float>(corner[k]);
    }
  }
  [[nodiscard]] TOUCHSTONE_INLINE float operator()(std::size_t v) const noexcept {
    return weight_[0][v] * corner_[0] + weight_[1][v] * corner_[1] + weight_[2][v] * corner_[2] +
           weight_[3][v] * corner_[3];
  }

 private:
  std::array<const float*, corners_max> weight_;
  std::array<float, corners_max> corner_;
};

/// The displacements of a patch's anchor points.
template <class Displacements>
std::array<scene::Vec3, corners_max> corner_displacements(const Patch& patch, const Displacements& anchor_m) noexcept {
  std::array<scene::Vec3, corners_max> u;
  for (std::size_t k = 0; k < corners_max; ++k) u[k] = nth(anchor_m, patch.anchor[k]);
  return u;
}

/// W(p) q of a quantity at the corners.
inline double at_place(const std::array<double, corners_max>& corner, const PatchPlace& place) noexcept {
  double sum = 0.0;
  for (std::size_t k = 0; k < corners_max; ++k) sum += place.weight[k] * corner[k];
  return sum;
}

/// W(p) U for the anchor points' displacements.
template <class Displacements>
scene::Vec3 vector_at(const SurfacePatches& rest, const Displacements& anchor_m, std::size_t patch,
                      const PatchPlace& place) noexcept {
  scene::Vec3 sum = scene::Vec3::Zero();
  for (std::size_t k = 0; k < corners_max; ++k) {
    sum += place.weight[k] * nth(anchor_m, rest.patches[patch].anchor[k]);
  }
  return sum;
}

/// Angle between a direction and a normal.
inline double angle_to(const scene::Vec3& direction, const scene::Vec3& normal) noexcept {
  return std::atan2(direction.cross(normal).norm(), direction.dot(normal));
}

/// cos and sin of an angle within 0 to pi by their series about pi/2, to 1e-7, so that the loop is vectorised.
struct CosSin {
  float cos, sin;
};
TOUCHSTONE_INLINE CosSin cos_sin(float angle) noexcept {
  const float x = angle - 0.5f * std::numbers::pi_v<float>, x2 = x * x;
  const float sine =
      x * (1.0f + x2 * (-1.0f / 6 + x2 * (1.0f / 120 + x2 * (-1.0f / 5040 + x2 * (1.0f / 362880 - x2 / 39916800)))));
  const float cosine = 1.0f + x2 * (-0.5f + x2 * (1.0f / 24 + x2 * (-1.0f / 720 + x2 * (1.0f / 40320 - x2 / 3628800))));
  return {-sine, cosine};
}

/// The displacement of a length and an angle to the normal, towards the given unit direction; lengths are kept >= 0 and
/// angles within 0 to pi.
struct Turned {
  float x, y, z;
};
TOUCHSTONE_INLINE Turned turned(float length_m, float angle_rad, const Eigen::Vector3f& toward, float nx, float ny,
                                float nz) noexcept {
  const float magnitude = length_m > 0.0f ? length_m : 0.0f;
  const float not_negative = angle_rad > 0.0f ? angle_rad : 0.0f;
  const float theta = not_negative < std::numbers::pi_v<float> ? not_negative : std::numbers::pi_v<float>;
  // Unit tangent towards the direction; none where that is along the normal.
  const float along = toward.x() * nx + toward.y() * ny + toward.z() * nz;
  const float tx = toward.x() - along * nx, ty = toward.y() - along * ny, tz = toward.z() - along * nz;
  const float tangent2 = tx * tx + ty * ty + tz * tz;
  const float inverse = 1.0f / std::sqrt(tangent2 + 1e-20f);
  const float to_unit = tangent2 > 1e-10f ? inverse : 0.0f;
  const CosSin turn = cos_sin(theta);
  const float out = magnitude * turn.cos, aside = magnitude * turn.sin * to_unit;
  return {out * nx + aside * tx, out * ny + aside * ty, out * nz + aside * tz};
}

/// Natural logarithm of a normal positive number, to 2e-7 of max(1, |ln x|), so that the loop is vectorised.
TOUCHSTONE_INLINE float log_of(float x) noexcept {
  // x = 2^exponent m with m within sqrt(1/2) to sqrt(2); ln m = 2 artanh(s).
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;
  const float m = std::bit_cast<float>(bits - exponent * (1 << 23));
  const float s = (m - 1.0f) / (m + 1.0f), s2 = s * s;
  const float mantissa = 2.0f * s * (1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 / 9))));
  return static_cast<float>(exponent) * std::numbers::ln2_v<float> + mantissa;
}

}  // namespace touchstone::fast
