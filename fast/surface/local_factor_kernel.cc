#include "fast/surface/local_factor_kernel.h"

#include "scene/base/index.h"

#include <cmath>

namespace touchstone::fast {
namespace {

using scene::Vec3;

template <class Factor>
TOUCHSTONE_INLINE void apply(const SurfacePatches& rest, const LocalConstants& constants, const RegionSize& size,
                             const Vec3& p0_W_m, SurfaceField& field) noexcept {
  const FactorTerms terms = Factor::terms(constants, size);
  const Eigen::Vector3f p0_m = p0_W_m.cast<float>();
  const auto r_R_m2 = static_cast<float>(constants.r_R_m * constants.r_R_m);
  const float *rx = rest.rest_W_m[0].data(), *ry = rest.rest_W_m[1].data(), *rz = rest.rest_W_m[2].data();
  float *x = field.displacement_m[0].data(), *y = field.displacement_m[1].data(), *z = field.displacement_m[2].data();
  for (const Patch& patch : rest.patches) {
    if (patch.all.distance2_m2(p0_m) >= r_R_m2) continue;
    for (std::int32_t b = patch.first_block; b < patch.last_block; ++b) {
      const VertexBlock& block = nth(rest.blocks, b);
      if (block.distance2_m2(p0_m) >= r_R_m2) continue;
      const auto begin = static_cast<std::size_t>(block.begin), end = static_cast<std::size_t>(block.end);
      // Columns never overlap.
#pragma GCC ivdep
      for (std::size_t v = begin; v < end; ++v) {
        const float dx = rx[v] - p0_m.x(), dy = ry[v] - p0_m.y(), dz = rz[v] - p0_m.z();
        const float r2_m2 = dx * dx + dy * dy + dz * dz;
        const float inside = Factor::at(terms, std::sqrt(r2_m2));
        const float w = r2_m2 < r_R_m2 ? inside : 1.0f;
        x[v] *= w;
        y[v] *= w;
        z[v] *= w;
      }
    }
  }
}

}  // namespace

TOUCHSTONE_WIDE_LOOPS
void apply_local_factor_published(const SurfacePatches& rest, const LocalConstants& constants, const RegionSize& size,
                                  const Vec3& p0_W_m, SurfaceField& field) noexcept {
  apply<FactorPublished>(rest, constants, size, p0_W_m, field);
}

TOUCHSTONE_WIDE_LOOPS
void apply_local_factor_corrected(const SurfacePatches& rest, const LocalConstants& constants, const RegionSize& size,
                                  const Vec3& p0_W_m, SurfaceField& field) noexcept {
  apply<FactorCorrected>(rest, constants, size, p0_W_m, field);
}

}  // namespace touchstone::fast
