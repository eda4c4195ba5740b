#include "fast/bench/peer.h"

#include "fast/bench/statistics.h"

#ifdef TOUCHSTONE_BULLET
#include "fast/bench/bullet_peer.h"
#include "fast/step/skeleton_engine.h"
#include "scene/base/stopwatch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#endif

namespace touchstone::bench {

double PeerResult::over_step() const noexcept { return valid() ? ratio(step.cpu_us, our_step_us) : not_measured; }

std::vector<PeerSetting> peer_settings() {
  return {{"rubber.implicit", 3.0e6, 0.45, true},
          {"rubber.explicit", 3.0e6, 0.45, false},
          {"pvc.implicit", 33.77e3, 0.33, true},
          {"pvc.explicit", 33.77e3, 0.33, false}};
}

const PeerResult* fastest(const std::vector<PeerResult>& peers, const std::string& size, const std::string& begins) {
  const PeerResult* best = nullptr;
  for (const PeerResult& peer : peers) {
    if (peer.size != size || !peer.valid() || !peer.setting.name.starts_with(begins)) continue;
    if (best == nullptr || peer.step.cpu_us < best->step.cpu_us) best = &peer;
  }
  return best;
}

#ifdef TOUCHSTONE_BULLET
namespace {

/// Our step on the same box, some ticks after each of the other code's steps.
class OurStep {
 public:
  explicit OurStep(const Case& which) : which_(which), engine_(scene_of(which)) {
    while (tick_ < approach_ticks) engine_.step(next_pose());
  }
  void run() {
    // The first ticks have their data displaced from the caches.
    constexpr int warming = 4, measured = 16;
    for (int i = 0; i < warming + measured; ++i) {
      const double step_us = 1e-3 * static_cast<double>(engine_.step_timed(next_pose()).step_ns);
      if (i >= warming) step_us_.push_back(step_us);
    }
  }
  [[nodiscard]] double median_us() const { return median(step_us_); }
  [[nodiscard]] int triangles() const { return engine_.model().surface.triangle_count(); }

 private:
  scene::Pose next_pose() { return pose_at_tick(which_, tick_++); }

  Case which_;
  fast::SkeletonEngine engine_;
  std::vector<double> step_us_;
  std::int64_t tick_ = 0;
};

PeerResult measure_setting(const std::string& size, const PeerSetting& setting, bool quick) {
  constexpr double pressed_m = 0.0025, sway_m = 0.0002;
  constexpr int approach = 40;
  const int ticks = quick || size != "1k" ? 12 : 40;
  OurStep ours({scene::BodyShape::box, size, 1});
  BulletScene bullet;
  bullet.cells = static_cast<int>(std::lround(std::sqrt(ours.triangles() / 12.0)));
  bullet.youngs_modulus_pa = setting.youngs_modulus_pa;
  bullet.poissons_ratio = setting.poissons_ratio;
  bullet.implicit = setting.implicit;
  BulletPeer peer(bullet);
  PeerResult result;
  result.size = size;
  result.setting = setting;
  result.triangles = peer.surface_triangles();
  result.tetrahedra = peer.tetrahedra();

  const auto press = [&](double depth_m) {
    result.depth_m = depth_m;
    peer.step(peer.top_node_m() + scene::Vec3(0, 0, bullet.ball_radius_m - depth_m));
  };
  result.sound = true;
  for (int k = 1; k <= approach && result.sound; ++k) {
    press(pressed_m * k / approach);
    result.sound = peer.sound();
  }
  std::vector<double> step_us, cpu_us;
  int touching_ticks = 0;
  bool pierced = false;
  for (int k = 0; k < ticks && result.sound; ++k) {
    const scene::Stopwatch watch;
    const double cpu_begin_us = thread_cpu_us();
    press(pressed_m + sway_m * std::sin(2.0 * std::numbers::pi * k / 40.0));
    cpu_us.push_back(thread_cpu_us() - cpu_begin_us);
    step_us.push_back(1e6 * watch.wall_s());
    result.sound = peer.sound();
    if (peer.contacts() > 0) ++touching_ticks;
    pierced = pierced || peer.pierced_m() > 0.2 * result.depth_m;
    ours.run();
  }
  result.ticks = static_cast<int>(step_us.size());
  result.dent_m = peer.dent_m();
  result.touching = 2 * touching_ticks >= result.ticks && !pierced && result.dent_m > 0.7 * result.depth_m &&
                    result.dent_m < 1.3 * result.depth_m;
  result.step = {fast::percentiles(std::move(step_us)), median(std::move(cpu_us))};
  result.our_step_us = ours.median_us();
  return result;
}

}  // namespace

std::string peer_version() { return bullet_version(); }

std::vector<PeerResult> measure_peer(const std::string& size, const std::vector<PeerSetting>& settings, bool quick,
                                     const std::function<void(const std::string&)>& progress) {
  std::vector<PeerResult> results;
  for (const PeerSetting& setting : settings) {
    progress("bullet/" + size + "/" + setting.name);
    results.push_back(measure_setting(size, setting, quick));
  }
  return results;
}
#else
std::string peer_version() { return ""; }

std::vector<PeerResult> measure_peer(const std::string&, const std::vector<PeerSetting>&, bool,
                                     const std::function<void(const std::string&)>&) {
  return {};
}
#endif

}  // namespace touchstone::bench
