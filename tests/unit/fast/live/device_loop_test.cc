#include "fast/live/device_loop.h"

#include "fast/live/scripted_device.h"
#include "unit/fast/live/lock_step.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace touchstone::live {
namespace {

using scene::Vec3;
using test::FakeDevice;
using test::live_scene;
using test::lock_step;
using test::LockStep;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void expect_sane(const scene::Scene& scene, const std::vector<TickRecord>& records, double period_s) {
  Vec3 before_n = Vec3::Zero();
  for (const TickRecord& r : records) {
    ASSERT_TRUE(r.published.force_n.allFinite() && r.published.torque_nm.allFinite()) << r.sequence;
    ASSERT_LE(r.published.force_n.norm(), scene.live.force_max_n) << r.sequence;
    ASSERT_LE((r.published.force_n - before_n).norm(), scene.live.force_slew_n_per_s * period_s) << r.sequence;
    before_n = r.published.force_n;
  }
}

TEST(LoopTime, GridDoesNotDrift) {
  for (const int rate_hz : {1, 3, 7, 1000, 4096, 9999, 10000}) {
    const LoopTime time{rate_hz};
    for (const std::int64_t seconds : {1, 2, 3600, 1000000}) {
      EXPECT_EQ(time.time_ns(seconds * rate_hz), seconds * 1000000000) << rate_hz;
    }
    EXPECT_NEAR(static_cast<double>(time.time_ns(12345)), 1e9 * time.time_s(12345), 1.0);
  }
}

TEST(DeviceLoop, ScriptedGivesTheModelsOwnAnswerAtThePosesOfTheTrack) {
  const scene::Scene scene = live_scene();
  ScriptedDevice device(scene.track, 1e-3);
  const LockStep run = lock_step(scene, device, 501);
  ASSERT_EQ(run.records.size(), 501u);
  fast::SkeletonEngine engine(scene);
  double largest_n = 0.0;
  for (std::int64_t k = 0; k < 501; ++k) {
    const TickRecord& record = run.records[static_cast<std::size_t>(k)];
    const scene::Pose pose = scene::pose_at(scene.track, static_cast<double>(k) / 1000);
    EXPECT_EQ(record.pose.position_m, pose.position_m);
    EXPECT_EQ(record.tick.index, k);
    engine.step_force(pose);
    engine.step_shape();
    ASSERT_LT((record.model.force_n - engine.wrench().force_n).norm(), 1e-12);
    largest_n = std::max(largest_n, record.published.force_n.norm());
  }
  EXPECT_GT(largest_n, 20.0);
  EXPECT_EQ(run.ledger.force_max_n, largest_n);
  EXPECT_EQ(run.ledger.ticks, 501);
  EXPECT_EQ(run.ledger.missed, 0);
  EXPECT_EQ(run.ledger.bad_poses, 0);
  EXPECT_EQ(run.ledger.lateness.max_ns(), 0);
}

TEST(DeviceLoop, TwistIsTheVelocityOfThePose) {
  scene::Scene scene = live_scene();
  scene.track[1].pose.orientation = Eigen::AngleAxisd(0.6, Vec3(0, 1, 0));  // in 0.5 s
  ScriptedDevice device(scene.track, 1e-3);
  DeviceSample sample;
  ASSERT_TRUE(device.read({100, 0.1}, sample));
  EXPECT_LT((sample.twist.linear_m_per_s - Vec3(0, 0, -0.013)).norm(), 1e-9);
  EXPECT_LT((sample.twist.angular_rad_per_s - Vec3(0, 1.2, 0)).norm(), 1e-6);
  ASSERT_TRUE(device.read({9000, 9.0}, sample));
  EXPECT_EQ(sample.twist.linear_m_per_s, Vec3::Zero()) << "behind the end of the track";
  EXPECT_EQ(sample.twist.angular_rad_per_s, Vec3::Zero());
}

TEST(DeviceLoop, ANonFinitePoseHoldsAndFadesAndComesBack) {
  const scene::Scene scene = live_scene();
  FakeDevice device([](const Tick& tick, DeviceSample& sample) {
    sample.pose = test::pressed(std::min(0.004, 1e-5 * static_cast<double>(tick.index)));
    if (tick.index >= 500 && tick.index < 700) sample.pose.position_m.x() = nan;
    if (tick.index >= 550 && tick.index < 560) sample.pose = {Vec3::Zero(), Eigen::Quaterniond(0, 0, 0, 0)};
    if (tick.index >= 560 && tick.index < 570) sample.pose.orientation.w() = std::numeric_limits<double>::infinity();
    return tick.index < 570 || tick.index >= 580;  // and no sample at all
  });
  const LockStep run = lock_step(scene, device, 1000);
  expect_sane(scene, run.records, 1e-3);
  const auto force_n = [&](std::size_t k) { return run.records[k].published.force_n.z(); };
  ASSERT_GT(force_n(499), 5.0);
  EXPECT_NEAR(force_n(549), 0.5 * force_n(499), 1e-6 * force_n(499)) << "half of release_s";
  for (std::size_t k = 600; k < 700; ++k) EXPECT_NEAR(force_n(k), 0.0, 1e-9);
  EXPECT_LT(force_n(700), 0.02 * force_n(499)) << "back as slowly";
  EXPECT_EQ(force_n(999), run.records[999].model.force_n.z());
  EXPECT_EQ(run.ledger.bad_poses, 200);
  for (std::size_t k = 0; k < 1000; ++k) EXPECT_EQ((run.records[k].flags & bad_pose) != 0, k >= 500 && k < 700);
  // Meanwhile the model keeps its last valid result.
  EXPECT_EQ(run.records[650].model.force_n, run.records[499].model.force_n);
}

TEST(DeviceLoop, AJumpOf50MillimetresStaysWithinTheLimits) {
  const scene::Scene scene = live_scene();
  FakeDevice device([](const Tick& tick, DeviceSample& sample) {
    sample.pose = test::pressed(tick.index % 100 < 50 ? -0.01 : 0.04);
    return true;
  });
  const LockStep run = lock_step(scene, device, 400);
  expect_sane(scene, run.records, 1e-3);
  EXPECT_GT(run.ledger.model_force_max_n, scene.live.force_max_n);
  EXPECT_NEAR(run.ledger.force_max_n, scene.live.force_max_n, 1e-6);
  EXPECT_GT(run.ledger.limited_ticks, 190);
  EXPECT_EQ(run.records[51].published.force_n.norm(), run.ledger.force_max_n) << "40 N at 20 N per tick";
  EXPECT_NEAR(run.records[50].published.force_n.norm(), 20.0, 1e-6);
}

TEST(DeviceLoop, MissedTicksAreSkippedAndCounted) {
  const scene::Scene scene = live_scene();
  VirtualClock clock;
  std::int64_t reads = 0;
  FakeDevice device([&](const Tick& tick, DeviceSample& sample) {
    sample.pose = test::pressed(-0.01);
    ++reads;
    if (tick.index == 10) clock.advance_ns(5'300'000);  // ends at 15.3
    if (tick.index == 20) clock.advance_ns(1'600'000);  // ends at 21.6: 21 is late, not missed
    if (tick.index == 30) clock.advance_ns(1'000'000);  // ends on the grid
    if (tick.index == 97) clock.advance_ns(50'000'000);
    return true;
  });
  const LockStep run = lock_step(scene, device, 100, clock);
  std::vector<std::int64_t> expected;
  for (std::int64_t k = 0; k < 98; ++k) {
    if (k < 11 || k > 14) expected.push_back(k);
  }
  std::vector<std::int64_t> done;
  for (std::size_t i = 0; i < run.records.size(); ++i) {
    done.push_back(run.records[i].tick.index);
    EXPECT_EQ(run.records[i].sequence, static_cast<std::int64_t>(i));
    EXPECT_EQ(run.records[i].tick.time_s, static_cast<double>(done.back()) / 1000);
  }
  EXPECT_EQ(done, expected);
  EXPECT_EQ(run.ledger.ticks, 94);
  EXPECT_EQ(reads, 94);
  EXPECT_EQ(run.ledger.missed, 6);
  EXPECT_EQ(run.records[11].lateness_ns, 300'000) << "tick 15 by its own grid point";
  EXPECT_EQ(run.ledger.lateness.max_ns(), 49'000'000) << "of tick 98, which was missed";
  EXPECT_EQ(run.ledger.step.max_ns(), 50'000'000);
  EXPECT_EQ(run.ledger.force.max_ns(), 50'000'000);
}

TEST(DeviceLoop, PublishesForceBeforeShape) {
  const scene::Scene scene = live_scene();
  fast::SkeletonEngine engine(scene);
  const LoopTime time{1000, 300};
  WrenchLimiter limiter(WrenchLimits::of(scene.live, engine.tool_reach_m()), time.period_s());
  VirtualClock clock;

  /// At each write the engine's shape must still be that of the previous tick.
  class Watch final : public Device {
   public:
    explicit Watch(const fast::Engine& watched) : engine(watched) {}
    [[nodiscard]] std::uint32_t capabilities() const noexcept override { return 0; }
    [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override {
      sample.pose = test::pressed(1e-5 * static_cast<double>(tick.index));
      before = engine.field().displacement_m;
      return true;
    }
    void write(const Wrench& wrench) noexcept override {
      ++writes;
      moved += engine.field().displacement_m != before;
      jump_n = std::max(jump_n, (wrench.force_n - last.force_n).norm());
      last = wrench;
    }
    const fast::Engine& engine;
    fast::Columns3 before;
    int writes = 0, moved = 0;
    double jump_n = 0.0;
    Wrench last;
  } device(engine);
  TripleBuffer<ShapeFrame> shapes(ShapeFrame{-1, 0, engine.field()});
  Ledger ledger;
  run_device_loop(time, {device, engine, limiter, clock, &shapes}, ledger);
  EXPECT_EQ(device.writes, 300 + 100) << "and the way to zero at the end, in release_s";
  EXPECT_EQ(device.moved, 100) << "those at the end";
  EXPECT_LT(device.jump_n, 0.1 * ledger.force_max_n);
  EXPECT_EQ(device.last.force_n, Vec3::Zero());

  // The reader gets a complete shape.
  ASSERT_TRUE(shapes.take());
  EXPECT_EQ(shapes.front().tick, 299);
  EXPECT_EQ(shapes.front().field.displacement_m, engine.field().displacement_m);
  EXPECT_EQ(shapes.front().field.normal, engine.field().normal);
  EXPECT_NE(engine.field().displacement_m[2], std::vector<float>(engine.field().displacement_m[2].size(), 0.0f));
}

TEST(DeviceLoop, AFullRingDropsAndCounts) {
  const scene::Scene scene = live_scene();
  fast::SkeletonEngine engine(scene);
  const LoopTime time{1000, 100};
  WrenchLimiter limiter(WrenchLimits::of(scene.live, engine.tool_reach_m()), time.period_s());
  VirtualClock clock;
  ScriptedDevice device(scene.track, time.period_s());
  RecordRing<TickRecord> ring(64);
  Ledger ledger;
  run_device_loop(time, {device, engine, limiter, clock, nullptr, &ring}, ledger);
  EXPECT_EQ(ledger.ticks, 100);
  EXPECT_EQ(ring.dropped(), 36u);
  TickRecord record;
  for (int i = 0; i < 64; ++i) {
    ASSERT_TRUE(ring.pop(record));
    EXPECT_EQ(record.sequence, i);
  }
}

TEST(DeviceLoop, StopsWhenAsked) {
  const scene::Scene scene = live_scene();
  fast::SkeletonEngine engine(scene);
  const LoopTime time{1000, 1000};
  WrenchLimiter limiter(WrenchLimits::of(scene.live, engine.tool_reach_m()), time.period_s());
  VirtualClock clock;
  std::atomic<bool> stop{false};
  FakeDevice device([&](const Tick& tick, DeviceSample& sample) {
    sample.pose = test::pressed(0.003);
    if (tick.index == 41) stop = true;
    return true;
  });
  Ledger ledger;
  LoopProgress progress;
  run_device_loop(time, {device, engine, limiter, clock, nullptr, nullptr, nullptr, &progress, &stop}, ledger);
  EXPECT_EQ(ledger.ticks, 42);
  EXPECT_EQ(progress.ticks.load(), 42);
  EXPECT_GT(progress.force_n.load(), 1.0);
  EXPECT_EQ(device.last.force_n, Vec3::Zero());
}

}  // namespace
}  // namespace touchstone::live
