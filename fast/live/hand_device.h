// A virtual hand on which the force acts: closes the loop without hardware.
#pragma once

#include "fast/live/device.h"
#include "scene/base/error.h"
#include "scene/model/scene.h"

#include <vector>

namespace touchstone::live {

/// A mass that is drawn to the scene's track by a spring and a damper and pushed by the published force:
///   m a = F + k (x_track - x) + c (v_track - v),
/// by semi-implicit Euler, v first. Rotation follows the track; torque is not felt.
///
/// Its time is the grid of the ticks: a tick missed is a period in which it moves on under the force last written, as a
/// hand does. Equal sequences of ticks and forces therefore give equal bits. A gap of more than 1000 periods counts as
/// 1000, so that the tick after it stays short; the track then lags by the rest.
class HandDevice final : public Device {
 public:
  /// @throws scene::InputError where the hand alone would be unstable at this rate: a + 2 b >= 4 with a = k dt^2 / m
  ///   and b = c dt / m
  HandDevice(std::vector<scene::Waypoint> track, const scene::LiveSettings& settings, double period_s);
  [[nodiscard]] std::uint32_t capabilities() const noexcept override {
    return senses_position | senses_orientation | senses_twist | renders_force | simulated;
  }
  [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override;
  void write(const Wrench& wrench) noexcept override { force_n_ = wrench.force_n; }

  /// Kinetic energy and that of the spring [J].
  [[nodiscard]] double energy_j() const noexcept;

 private:
  void advance() noexcept;
  [[nodiscard]] double time_s() const noexcept;

  std::vector<scene::Waypoint> track_;
  scene::LiveSettings hand_;  ///< of these the hand_...
  double period_s_;
  std::int64_t periods_ = 0;  ///< integrated so far
  std::int64_t last_tick_ = 0;
  scene::Vec3 position_m_, velocity_m_per_s_ = scene::Vec3::Zero();
  scene::Vec3 force_n_ = scene::Vec3::Zero();
};

}  // namespace touchstone::live
