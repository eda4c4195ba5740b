// What the loop asks of a device: a pose in, a wrench out, once per tick.
#pragma once

#include "scene/base/frames.h"
#include "scene/base/wrench.h"

#include <cstdint>

namespace touchstone::live {

using scene::Wrench;

/// A grid point of the loop's time.
struct Tick {
  std::int64_t index = 0;  ///< grid points since the start; those missed leave gaps
  double time_s = 0.0;     ///< index times the period
};

/// Velocity of the tool, world frame.
struct Twist {
  scene::Vec3 linear_m_per_s = scene::Vec3::Zero();     ///< of the tool's mass centre
  scene::Vec3 angular_rad_per_s = scene::Vec3::Zero();  ///< about it
};

/// What a device measured.
struct DeviceSample {
  scene::Pose pose;            ///< of the tool, world frame
  Twist twist;                 ///< zero where not measured
  std::uint32_t buttons = 0;   ///< one bit each, set while pressed
  std::int64_t stamp_ns = -1;  ///< of the measurement, since tick 0; -1: not known
};

/// What a device can do: bits.
enum Capability : std::uint32_t {
  senses_position = 1u << 0,
  senses_orientation = 1u << 1,
  senses_twist = 1u << 2,
  senses_buttons = 1u << 3,
  renders_force = 1u << 4,
  renders_torque = 1u << 5,
  simulated = 1u << 6  ///< no hardware behind it: may be stepped in virtual time
};

/// A device belongs to the thread of the loop from the first read to the last write. Both are called once per tick, in
/// this order, and neither may wait, lock, log or use the heap.
class Device {
 public:
  virtual ~Device() = default;
  /// Capability bits.
  [[nodiscard]] virtual std::uint32_t capabilities() const noexcept = 0;
  /// The newest sample. May leave any number in it; the loop trusts none.
  /// @returns false where there is none: the tick counts as one with a bad pose
  [[nodiscard]] virtual bool read(const Tick& tick, DeviceSample& sample) noexcept = 0;
  /// Valid until the next call; within the limits already (safety.h).
  virtual void write(const Wrench& wrench) noexcept = 0;

 protected:
  Device() = default;
  Device(const Device&) = default;
  Device& operator=(const Device&) = default;
};

}  // namespace touchstone::live
