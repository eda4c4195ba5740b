#include "fast/live/scripted_device.h"

#include <cmath>

namespace touchstone::live {

Twist track_twist(const std::vector<scene::Waypoint>& track, double time_s, double period_s) noexcept {
  const scene::Pose here = scene::pose_at(track, time_s), there = scene::pose_at(track, time_s + period_s);
  const Eigen::AngleAxisd turn(there.orientation * here.orientation.conjugate());
  return {(there.position_m - here.position_m) / period_s, turn.angle() / period_s * turn.axis()};
}

bool ScriptedDevice::read(const Tick& tick, DeviceSample& sample) noexcept {
  const double time_s = track_.front().time_s + tick.time_s;
  sample.pose = scene::pose_at(track_, time_s);
  sample.twist = track_twist(track_, time_s, period_s_);
  sample.buttons = 0;
  sample.stamp_ns = std::llround(1e9 * tick.time_s);
  return true;
}

}  // namespace touchstone::live
