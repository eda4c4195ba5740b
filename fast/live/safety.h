// Safety limits between model and device: the wrench sent is finite, bounded and never jumps.
#pragma once

#include "fast/live/device.h"
#include "scene/model/scene.h"

namespace touchstone::live {

/// Bounds of the wrench sent to the device. A torque T counts as the force |T| / lever_m, so that the two limits of the
/// scene bound it too, for any couple of a contact.
struct WrenchLimits {
  double force_max_n = 0.0;
  double force_slew_n_per_s = 0.0;
  double release_s = 0.0;  ///< time to fall to zero after a bad pose, and to return
  double lever_m = 1.0;    ///< reach of the tool about its mass centre

  [[nodiscard]] static WrenchLimits of(const scene::LiveSettings& settings, double lever_m) noexcept {
    return {settings.force_max_n, settings.force_slew_n_per_s, settings.release_s, lever_m};
  }
};

/// Saturates the norm and the change of a wrench, keeping its direction: force and torque are scaled by one factor.
/// A wrench limited axis by axis would change its direction; one set to zero would jump.
class WrenchLimiter {
 public:
  /// @param period_s between two calls. Missed ticks are not counted: the slew rate is then below its limit, never
  ///   above.
  WrenchLimiter(const WrenchLimits& limits, double period_s) noexcept;

  /// The wrench to send. |F| <= force_max_n and |T| <= force_max_n lever_m; no change since the last call beyond the
  /// slew; finite whatever is asked (all of it to the rounding of a double).
  /// @param good  the answer to a pose of this tick. Where it is not, or is not finite, the last good one is held and
  ///              faded to zero in release_s; the slew limit comes first. After that it fades in as slowly.
  [[nodiscard]] const Wrench& next(const Wrench& asked, bool good) noexcept;

  /// The last answer differs from what was asked.
  [[nodiscard]] bool limited() const noexcept { return limited_; }

 private:
  WrenchLimits limits_;
  double largest_n_, step_n_, fade_step_;
  double gain_ = 1.0;
  Wrench target_, sent_;
  bool limited_ = false;
};

}  // namespace touchstone::live
