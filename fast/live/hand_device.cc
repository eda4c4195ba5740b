#include "fast/live/hand_device.h"

#include "fast/live/scripted_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::live {
namespace {

constexpr std::int64_t longest_gap = 1000;

}  // namespace

HandDevice::HandDevice(std::vector<scene::Waypoint> track, const scene::LiveSettings& settings, double period_s)
    : track_(std::move(track)), hand_(settings), period_s_(period_s), position_m_(track_.front().pose.position_m) {
  // Unstable if a root of z^2 - (2 - a - b) z + (1 - b) is outside the unit circle.
  const double a = hand_.hand_stiffness_n_per_m * period_s_ * period_s_ / hand_.hand_mass_kg,
               b = hand_.hand_damping_n_s_per_m * period_s_ / hand_.hand_mass_kg;
  if (!(a + 2.0 * b < 4.0) || !(b < 2.0)) {
    throw scene::InputError(fmt::format(
        "live.hand_mass_kg = {:g} is too light for hand_stiffness_n_per_m = {:g} and hand_damping_n_s_per_m = {:g} "
        "at {:g} Hz; expected at least {:g}",
        hand_.hand_mass_kg, hand_.hand_stiffness_n_per_m, hand_.hand_damping_n_s_per_m, 1.0 / period_s_,
        std::max(0.25 * (hand_.hand_stiffness_n_per_m * period_s_ + 2.0 * hand_.hand_damping_n_s_per_m) * period_s_,
                 0.5 * hand_.hand_damping_n_s_per_m * period_s_)));
  }
}

double HandDevice::time_s() const noexcept { return track_.front().time_s + static_cast<double>(periods_) * period_s_; }

void HandDevice::advance() noexcept {
  const double time_s = this->time_s();
  const scene::Vec3 here_m = scene::pose_at(track_, time_s).position_m;
  const scene::Vec3 there_m = scene::pose_at(track_, time_s + period_s_).position_m;
  const scene::Vec3 track_m_per_s = (there_m - here_m) / period_s_;
  const scene::Vec3 total_n = force_n_ + hand_.hand_stiffness_n_per_m * (here_m - position_m_) +
                              hand_.hand_damping_n_s_per_m * (track_m_per_s - velocity_m_per_s_);
  velocity_m_per_s_ += period_s_ / hand_.hand_mass_kg * total_n;
  position_m_ += period_s_ * velocity_m_per_s_;
  ++periods_;
}

bool HandDevice::read(const Tick& tick, DeviceSample& sample) noexcept {
  const std::int64_t gap = std::clamp<std::int64_t>(tick.index - last_tick_, 0, longest_gap);
  for (std::int64_t i = 0; i < gap; ++i) advance();
  last_tick_ = tick.index;
  sample.pose = {position_m_, scene::pose_at(track_, time_s()).orientation};
  sample.twist = track_twist(track_, time_s(), period_s_);
  sample.twist.linear_m_per_s = velocity_m_per_s_;
  sample.buttons = 0;
  sample.stamp_ns = std::llround(1e9 * tick.time_s);
  return true;
}

double HandDevice::energy_j() const noexcept {
  const scene::Vec3 stretch_m = scene::pose_at(track_, time_s()).position_m - position_m_;
  return 0.5 * hand_.hand_mass_kg * velocity_m_per_s_.squaredNorm() +
         0.5 * hand_.hand_stiffness_n_per_m * stretch_m.squaredNorm();
}

}  // namespace touchstone::live
