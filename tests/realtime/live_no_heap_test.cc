// No heap use in a tick of the device loop, whatever happens.
#include "support/no_heap.h"

#include "fast/live/hand_device.h"
#include "fast/live/replay_device.h"
#include "fast/live/scripted_device.h"
#include "fast/response/response_engine.h"
#include "support/synthetic_response.h"
#include "unit/fast/live/lock_step.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::live {
namespace {

using test::live_scene;

/// Runs the whole loop with an overflowing ring under the heap check.
Ledger run_without_heap(fast::Engine& engine, const scene::Scene& scene, Device& device, TickListener* listener,
                        VirtualClock& clock, std::int64_t ticks) {
  const LoopTime time{1000, ticks};
  WrenchLimiter limiter(WrenchLimits::of(scene.live, engine.tool_reach_m()), time.period_s());
  TripleBuffer<ShapeFrame> shapes(ShapeFrame{-1, 0, engine.field()});
  RecordRing<TickRecord> ring(128);
  LoopProgress progress;
  const std::atomic<bool> stop{false};
  Ledger ledger;
  const LoopPorts ports{device, engine, limiter, clock, &shapes, &ring, listener, &progress, &stop};
  {
    const touchstone::test::NoHeap guard;
    run_device_loop(time, ports, ledger);
  }
  EXPECT_GT(ring.dropped(), 0u);
  EXPECT_TRUE(shapes.take());
  return ledger;
}

Ledger run_without_heap(const scene::Scene& scene, Device& device, TickListener* listener, VirtualClock& clock,
                        std::int64_t ticks) {
  fast::SkeletonEngine engine(scene);
  return run_without_heap(engine, scene, device, listener, clock, ticks);
}

TEST(LiveNoHeap, ResponseModel) {
  const scene::Scene scene = live_scene();
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  fast::ResponseEngine engine(scene, surface, touchstone::test::synthetic_response(scene, surface));
  HandDevice hand(scene.track, scene.live, 1e-3);
  VirtualClock clock;
  EXPECT_GT(run_without_heap(engine, scene, hand, nullptr, clock, 600).force_max_n, 1.0);
}

TEST(LiveNoHeap, Scripted) {
  const scene::Scene scene = live_scene();
  ScriptedDevice device(scene.track, 1e-3);
  VirtualClock clock;
  EXPECT_GT(run_without_heap(scene, device, nullptr, clock, 600).force_max_n, 20.0);
}

TEST(LiveNoHeap, HandWithMissedTicksAndBadPoses) {
  const scene::Scene scene = live_scene();
  HandDevice hand(scene.track, scene.live, 1e-3);
  VirtualClock clock;
  class Eventful final : public Device {
   public:
    Eventful(HandDevice& hand, VirtualClock& clock) : hand_(hand), clock_(clock) {}
    [[nodiscard]] std::uint32_t capabilities() const noexcept override { return 0; }
    [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override {
      if (tick.index % 50 == 0) clock_.advance_ns(7'000'000);
      const bool good = hand_.read(tick, sample);
      if (tick.index > 400 && tick.index < 450) sample.pose.position_m.x() = std::nan("");
      if (tick.index > 500 && tick.index < 520) sample.pose.position_m.z() -= 0.05;
      return good && !(tick.index > 460 && tick.index < 470);
    }
    void write(const Wrench& wrench) noexcept override { hand_.write(wrench); }

   private:
    HandDevice& hand_;
    VirtualClock& clock_;
  } device(hand, clock);
  const Ledger ledger = run_without_heap(scene, device, nullptr, clock, 1200);
  EXPECT_GT(ledger.missed, 0);
  EXPECT_GT(ledger.bad_poses, 0);
  EXPECT_GT(ledger.limited_ticks, 0);
}

TEST(LiveNoHeap, Replay) {
  const scene::Scene scene = live_scene();
  ScriptedDevice script(scene.track, 1e-3);
  const test::LockStep first = test::lock_step(scene, script, 500);
  ReplayDevice device(first.records);
  VirtualClock clock;
  EXPECT_EQ(run_without_heap(scene, device, &device, clock, 500).ticks, 500);
  EXPECT_EQ(device.compared(), 500);
  EXPECT_EQ(device.unequal(), 0);
}

TEST(LiveNoHeapDeathTest, TheWatchSeesADeviceThatAllocates) {
  const scene::Scene scene = live_scene();
  VirtualClock clock;
  test::FakeDevice device([](const Tick& tick, DeviceSample& sample) {
    sample.pose = test::pressed(-0.01);
    if (tick.index == 5) delete new int volatile(3);
    return true;
  });
  EXPECT_DEATH(run_without_heap(scene, device, nullptr, clock, 10), "heap use below step");
}

}  // namespace
}  // namespace touchstone::live
