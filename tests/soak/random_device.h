// A device that moves at random: presses, slides, rotates, leaves, jumps, and now and then returns an invalid pose.
#pragma once

#include "fast/live/device.h"
#include "fast/step/model.h"
#include "scene/model/scene.h"
#include "soak/random.h"

#include <memory>
#include <vector>

namespace touchstone::soak {

/// The tool above a place of the rest surface: one of its samples is at the place, all others are further out along the
/// normal. On a convex body that is first touch.
struct Touch {
  scene::Pose pose;
  scene::Vec3 place_m;
  scene::Vec3 normal;  ///< outward normal of the rest surface there
  [[nodiscard]] scene::Pose sunk(double depth_m) const {
    return {pose.position_m - depth_m * normal, pose.orientation};
  }
};
[[nodiscard]] Touch random_touch(const fast::FastModel& model, Random& random);

/// Random waypoints: touch, press to between 1e-4 and 0.7 of the body's smallest extent, slide, rotate, stay, leave.
/// One move in twenty is a jump in one tick, which may end anywhere.
[[nodiscard]] std::vector<scene::Waypoint> random_track(const fast::FastModel& model, double rate_hz,
                                                        std::int64_t ticks, Random& random);

/// Follows a random track, either exactly or as the virtual hand does, which reacts to the force. One sample in 5000 is
/// an invalid pose.
class RandomDevice final : public live::Device {
 public:
  RandomDevice(const fast::FastModel& model, const scene::Scene& scene, std::int64_t ticks, Random& random);
  [[nodiscard]] std::uint32_t capabilities() const noexcept override { return device_->capabilities(); }
  [[nodiscard]] bool read(const live::Tick& tick, live::DeviceSample& sample) noexcept override;
  void write(const live::Wrench& wrench) noexcept override { device_->write(wrench); }

 private:
  std::unique_ptr<live::Device> device_;
  Random random_;
};

}  // namespace touchstone::soak
