#include "fast/live/replay_device.h"

#include "scene/base/index.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace touchstone::live {
namespace {

bool equal_bits(const scene::Vec3& a, const scene::Vec3& b) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::bit_cast<std::uint64_t>(a[axis]) != std::bit_cast<std::uint64_t>(b[axis])) return false;
  }
  return true;
}

bool equal_bits(const Wrench& a, const Wrench& b) noexcept {
  return equal_bits(a.force_n, b.force_n) && equal_bits(a.torque_nm, b.torque_nm);
}

}  // namespace

bool ReplayDevice::read(const Tick&, DeviceSample& sample) noexcept {
  if (next_ == ticks_.size()) return false;
  const TickRecord& row = ticks_[next_++];
  sample.pose = row.pose;
  sample.twist = Twist{};
  sample.buttons = row.buttons;
  sample.stamp_ns = std::llround(1e9 * row.tick.time_s);
  return true;
}

void ReplayDevice::tick_done(const TickRecord& record) noexcept {
  if (record.sequence < 0 || record.sequence >= static_cast<std::int64_t>(ticks_.size())) return;
  const TickRecord& row = nth(ticks_, record.sequence);
  ++compared_;
  if (equal_bits(record.model, row.model) && equal_bits(record.published, row.published)) return;
  if (unequal_++ == 0) first_unequal_ = record.sequence;
}

}  // namespace touchstone::live
