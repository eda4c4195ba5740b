// The device loop in virtual time, with test devices.
#pragma once

#include "fast/live/device_loop.h"
#include "fast/step/skeleton_engine.h"
#include "support/press.h"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace touchstone::live::test {

using touchstone::test::ball_on_cube;
using touchstone::test::pressed;

/// The ball on the cube with the limits and the hand of the shipped scenes, on a small mesh.
inline scene::Scene live_scene() {
  scene::Scene scene = ball_on_cube();
  scene.fast.triangles = 300;
  scene.fast.tool_samples = 500;
  scene.live = {40.0, 2e4, 0.1, 0.2, 5.0, 500.0};
  return scene;
}

/// A device with poses and a reaction to wrenches given by a test.
class FakeDevice final : public Device {
 public:
  using Read = std::function<bool(const Tick&, DeviceSample&)>;
  explicit FakeDevice(Read read) : read_(std::move(read)) {}
  [[nodiscard]] std::uint32_t capabilities() const noexcept override { return simulated; }
  [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override { return read_(tick, sample); }
  void write(const Wrench& wrench) noexcept override { last = wrench; }
  Wrench last;

 private:
  Read read_;
};

/// Keeps every record.
class Keep final : public TickListener {
 public:
  explicit Keep(std::size_t ticks) { records.reserve(ticks); }
  void tick_done(const TickRecord& record) noexcept override { records.push_back(record); }
  std::vector<TickRecord> records;
};

struct LockStep {
  Ledger ledger;
  std::vector<TickRecord> records;
  std::uint64_t answer_hash = 0;
};

/// Runs the loop in lock-step.
inline LockStep lock_step(const scene::Scene& scene, Device& device, std::int64_t ticks, VirtualClock& clock,
                          int rate_hz = 1000) {
  fast::SkeletonEngine engine(scene);
  const LoopTime time{rate_hz, ticks};
  WrenchLimiter limiter(WrenchLimits::of(scene.live, engine.tool_reach_m()), time.period_s());
  Keep keep(static_cast<std::size_t>(ticks));
  LockStep result;
  run_device_loop(time, {device, engine, limiter, clock, nullptr, nullptr, &keep}, result.ledger);
  result.records = std::move(keep.records);
  result.answer_hash = engine.answer_hash();
  return result;
}

inline LockStep lock_step(const scene::Scene& scene, Device& device, std::int64_t ticks, int rate_hz = 1000) {
  VirtualClock clock;
  return lock_step(scene, device, ticks, clock, rate_hz);
}

}  // namespace touchstone::live::test
