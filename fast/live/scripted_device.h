// The scene's track as a device that ignores the force.
#pragma once

#include "fast/live/device.h"
#include "scene/model/scene.h"

#include <vector>

namespace touchstone::live {

/// Velocity on a track, by the difference over the period that follows.
[[nodiscard]] Twist track_twist(const std::vector<scene::Waypoint>& track, double time_s, double period_s) noexcept;

/// Plays a track by the time of the tick, so that a missed tick is a place passed by.
class ScriptedDevice final : public Device {
 public:
  ScriptedDevice(std::vector<scene::Waypoint> track, double period_s) : track_(std::move(track)), period_s_(period_s) {}
  [[nodiscard]] std::uint32_t capabilities() const noexcept override {
    return senses_position | senses_orientation | senses_twist | simulated;
  }
  [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override;
  void write(const Wrench&) noexcept override {}

 private:
  std::vector<scene::Waypoint> track_;
  double period_s_;
};

}  // namespace touchstone::live
