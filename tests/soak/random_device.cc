#include "soak/random_device.h"

#include "fast/live/hand_device.h"
#include "fast/live/scripted_device.h"

#include <algorithm>
#include <limits>

namespace touchstone::soak {

using scene::Pose;
using scene::Vec3;

Touch random_touch(const fast::FastModel& model, Random& random) {
  const int vertex = random.below(model.surface.vertex_count());
  const Vec3 place_m = model.surface.points_m.col(vertex), normal = model.surface.normals.col(vertex);
  const Eigen::Quaterniond orientation =
      random.chance(0.3) ? Eigen::Quaterniond::Identity() : random.turn(std::numbers::pi);
  const Vec3 normal_T = orientation.conjugate() * normal;
  const fast::ToolSamples& tool = model.tool;
  Vec3 lowest_T_m = Vec3::Zero();
  double lowest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tool.x_T_m.size(); ++i) {
    const Vec3 p_T_m(tool.x_T_m[i], tool.y_T_m[i], tool.z_T_m[i]);
    if (p_T_m.dot(normal_T) >= lowest_m) continue;
    lowest_m = p_T_m.dot(normal_T);
    lowest_T_m = p_T_m;
  }
  return {{place_m - orientation * lowest_T_m, orientation}, place_m, normal};
}

std::vector<scene::Waypoint> random_track(const fast::FastModel& model, double rate_hz, std::int64_t ticks,
                                          Random& random) {
  const scene::Bounds bounds = model.body->bounds();
  const double least_m = (bounds.upper_m - bounds.lower_m).minCoeff();
  std::vector<scene::Waypoint> track;
  std::int64_t tick = 0;
  const auto go = [&](const Pose& pose) {
    tick += random.chance(0.05) ? 1 : static_cast<std::int64_t>(random.decades(3.0, 1000.0));
    track.push_back({static_cast<double>(tick) / rate_hz, pose});
  };
  while (tick < ticks) {
    Touch touch = random_touch(model, random);
    const double above_m = least_m * random.decades(1e-3, 1.0);
    go(touch.sunk(-above_m));
    const auto depth_m = [&] { return least_m * random.decades(1e-4, 0.7); };
    go(touch.sunk(depth_m()));
    for (int moves = random.below(6); moves > 0; --moves) {
      if (random.chance(0.7)) touch.pose.position_m += least_m * random.decades(1e-4, 0.5) * random.direction();
      if (random.chance(0.5)) touch.pose.orientation = random.turn(random.decades(1e-3, 3.0)) * touch.pose.orientation;
      go(touch.sunk(random.chance(0.2) ? -above_m : depth_m()));
    }
    go(touch.sunk(-above_m));
  }
  return track;
}

RandomDevice::RandomDevice(const fast::FastModel& model, const scene::Scene& scene, std::int64_t ticks, Random& random)
    : random_(random) {
  std::vector<scene::Waypoint> track = random_track(model, scene.fast.rate_hz, ticks, random);
  const double period_s = 1.0 / scene.fast.rate_hz;
  if (random.chance(0.5)) {
    device_ = std::make_unique<live::HandDevice>(std::move(track), scene.live, period_s);
  } else {
    device_ = std::make_unique<live::ScriptedDevice>(std::move(track), period_s);
  }
}

bool RandomDevice::read(const live::Tick& tick, live::DeviceSample& sample) noexcept {
  if (!device_->read(tick, sample)) return false;
  if (!random_.chance(2e-4)) return true;
  constexpr double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  switch (random_.below(4)) {
    case 0:
      sample.pose.position_m[random_.below(3)] = nan;
      break;
    case 1:
      sample.pose.position_m[random_.below(3)] = -inf;
      break;
    case 2:
      sample.pose.orientation.coeffs()[random_.below(4)] = nan;
      break;
    default:
      sample.pose.orientation.coeffs().setZero();
  }
  return true;
}

}  // namespace touchstone::soak
