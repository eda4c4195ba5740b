// The local factor as the loops over vertices take it: in single precision, its constants worked out once.
#pragma once

#include "fast/surface/local_factor.h"
#include "fast/surface/patch_kernels.h"

namespace touchstone::fast {

/// local_factor_published
struct FactorPublished {
  [[nodiscard]] static FactorTerms terms(const LocalConstants& c, const RegionSize& size) noexcept {
    return factor_terms_published(c, size);
  }
  [[nodiscard]] TOUCHSTONE_INLINE static float at(const FactorTerms& c, float r_m) noexcept {
    const float w = (1.0f + c.C_n * log_of((r_m + c.C_r_m) * c.inverse_reach_per_m)) * c.area_part;
    return r_m > c.rim_m ? w : 1.0f;
  }
  /// local_room_published
  [[nodiscard]] TOUCHSTONE_INLINE static float room(const FactorTerms& c, float r_m) noexcept {
    return r_m > c.rim_m ? 1.0f : 0.0f;
  }
};

/// local_factor_corrected
struct FactorCorrected {
  [[nodiscard]] static FactorTerms terms(const LocalConstants& c, const RegionSize& size) noexcept {
    return factor_terms_corrected(c, size);
  }
  [[nodiscard]] TOUCHSTONE_INLINE static float at(const FactorTerms& c, float r_m) noexcept {
    const float point = 1.0f + c.C_n * log_of((r_m + c.C_r_m) * c.inverse_reach_per_m);
    const float w =
        (point > 0.0f ? point : 0.0f) * (c.area_part + (1.0f - c.area_part) * smoothstep(r_m * c.inverse_r_R_per_m));
    return 1.0f + room(c, r_m) * (w - 1.0f);
  }
  /// local_room_corrected
  [[nodiscard]] TOUCHSTONE_INLINE static float room(const FactorTerms& c, float r_m) noexcept {
    return smoothstep((r_m - c.rim_m) * c.inverse_C_r_per_m);
  }

 private:
  [[nodiscard]] TOUCHSTONE_INLINE static float smoothstep(float t) noexcept {
    const float above = t > 0.0f ? t : 0.0f, x = above < 1.0f ? above : 1.0f;
    return x * x * (3.0f - 2.0f * x);
  }
};

}  // namespace touchstone::fast
