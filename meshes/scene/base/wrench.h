// What acts at one point of a rigid tool.
#pragma once

#include "scene/base/frames.h"

namespace touchstone::scene {

/// On the tool, world frame.
struct Wrench {
  Vec3 force_n = Vec3::Zero();
  Vec3 torque_nm = Vec3::Zero();  ///< about the tool's mass centre
};

}  // namespace touchstone::scene
