// The record of a tick, of fixed size.
#pragma once

#include "fast/live/device.h"
#include "fast/surface/surface_patches.h"

#include <cstdint>

namespace touchstone::live {

/// Bits of TickRecord::flags.
enum TickFlag : std::uint32_t {
  bad_pose = 1u << 0,  ///< no pose, or one that is not finite: the last good answer was held and faded
  limited = 1u << 1    ///< the published wrench is not the model's
};

/// One tick, as it is logged.
struct TickRecord {
  std::int64_t sequence = 0;  ///< counts the ticks done
  Tick tick;
  scene::Pose pose;  ///< as the device gave it; not a number where it gave none
  Wrench model;      ///< of the contact model
  Wrench published;  ///< after the limits
  std::uint32_t buttons = 0;
  std::uint32_t status = 0;  ///< fast::StepStatus bits
  std::uint32_t flags = 0;   ///< TickFlag bits
  std::int64_t lateness_ns = 0, force_ns = 0, shape_ns = 0;
};

/// The newest shape, for drawing.
struct ShapeFrame {
  std::int64_t tick = -1;     ///< -1: at rest, before the first tick
  std::int64_t stamp_ns = 0;  ///< the loop's clock at publication
  fast::SurfaceField field;
};

}  // namespace touchstone::live
