#include "fast/live/live_log.h"

#include "fast/live/hand_device.h"
#include "fast/live/replay_device.h"
#include "scene/base/error.h"
#include "scene/base/input.h"
#include "unit/fast/live/lock_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <random>

namespace touchstone::live {
namespace {

using scene::Vec3;
using test::live_scene;
using test::lock_step;
using test::LockStep;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class LiveLogTest : public testing::Test {
 protected:
  std::filesystem::path file_ = std::filesystem::path(testing::TempDir()) /
                                ("touchstone-" + std::to_string(getpid()) + "-" +
                                 testing::UnitTest::GetInstance()->current_test_info()->name() + ".csv");
  void TearDown() override { std::filesystem::remove(file_); }

  void write(const std::vector<TickRecord>& records) {
    std::string text = log_header();
    for (const TickRecord& record : records) append_log_line(record, text);
    std::ofstream(file_, std::ios::binary) << text;
  }
  /// The same with one text replaced in one line (1-based).
  void edit(int line, const std::string& from, const std::string& to) {
    std::ifstream in(file_);
    std::string text;
    int number = 0;
    for (std::string row; std::getline(in, row);) {
      if (++number == line) {
        const std::size_t at = row.find(from);
        ASSERT_NE(at, std::string::npos) << row;
        row.replace(at, from.size(), to);
      }
      text += row + "\n";
    }
    std::ofstream(file_, std::ios::binary) << text;
  }
  void expect_refused(int line, const std::string& message) {
    try {
      (void)read_log(file_);
      FAIL() << "accepted";
    } catch (const scene::InputError& error) {
      EXPECT_EQ(error.faults().size(), 1u);
      EXPECT_EQ(error.faults()[0].line, line) << error.what();
      EXPECT_THAT(error.what(), testing::HasSubstr(file_.string()));
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
      EXPECT_THAT(error.what(), testing::HasSubstr("expected"));
    }
  }
};

std::vector<TickRecord> a_few() {
  std::vector<TickRecord> records(5);
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].sequence = static_cast<std::int64_t>(i);
    records[i].tick = {static_cast<std::int64_t>(3 * i), static_cast<double>(3 * i) / 1000};
    records[i].pose = test::pressed(0.001);
  }
  return records;
}

TEST_F(LiveLogTest, ThatIsNoFileIsRefused) {
  std::filesystem::remove_all(file_);
  std::filesystem::create_directories(file_);
  expect_refused(0, "cannot read the log: it is a folder; expected the live.csv of a live run of at most 2 GiB");
  std::filesystem::remove_all(file_);
  ASSERT_EQ(::mkfifo(file_.c_str(), 0600), 0);
  expect_refused(0, "cannot read the log: it is a pipe");
  std::filesystem::remove(file_);
}

TEST_F(LiveLogTest, ThatIsTooLongToBeKeptIsRefused) {
  std::ofstream{file_};
  std::filesystem::resize_file(file_, scene::log_input.bytes_max + 1);
  expect_refused(0, "expected the live.csv of a live run of at most 2 GiB");
}

TEST_F(LiveLogTest, ComesBackToTheLastBit) {
  std::mt19937_64 random(11);
  std::vector<TickRecord> records;
  const auto any = [&](bool may_be_odd) {
    // Random bits give every kind of number.
    double value;
    do {
      const std::uint64_t bits = random();
      std::memcpy(&value, &bits, sizeof value);
    } while (!may_be_odd && !std::isfinite(value));
    return std::isnan(value) ? nan : value;
  };
  for (std::int64_t i = 0; i < 3000; ++i) {
    TickRecord r;
    r.sequence = i;
    r.tick = {i + 2 * (i / 5), static_cast<double>(i + 2 * (i / 5)) / 997};
    r.pose = {Vec3(any(true), any(true), any(true)), {any(true), any(true), any(true), any(true)}};
    r.published = {Vec3(any(false), any(false), -0.0), Vec3(any(false), any(false), any(false))};
    r.model = {Vec3(any(false), any(false), any(false)), Vec3(any(false), any(false), any(false))};
    r.buttons = static_cast<std::uint32_t>(random());
    r.status = static_cast<std::uint32_t>(random());
    r.flags = static_cast<std::uint32_t>(random());
    r.lateness_ns = static_cast<std::int64_t>(random() % 1000000);
    r.force_ns = static_cast<std::int64_t>(random() % 1000000);
    r.shape_ns = static_cast<std::int64_t>(random() % 1000000);
    records.push_back(r);
  }
  write(records);
  const LiveLog log = read_log(file_);
  EXPECT_EQ(log.rate_hz, 997);
  ASSERT_EQ(log.ticks.size(), records.size());
  const auto same = [](double a, double b) {
    return (std::isnan(a) && std::isnan(b)) || std::memcmp(&a, &b, sizeof a) == 0;
  };
  for (std::size_t i = 0; i < records.size(); ++i) {
    const TickRecord &a = records[i], &b = log.ticks[i];
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_TRUE(same(a.pose.position_m[axis], b.pose.position_m[axis]));
      ASSERT_TRUE(same(a.published.force_n[axis], b.published.force_n[axis]));
      ASSERT_TRUE(same(a.published.torque_nm[axis], b.published.torque_nm[axis]));
      ASSERT_TRUE(same(a.model.force_n[axis], b.model.force_n[axis]));
      ASSERT_TRUE(same(a.model.torque_nm[axis], b.model.torque_nm[axis]));
    }
    for (int c = 0; c < 4; ++c) {
      ASSERT_TRUE(same(a.pose.orientation.coeffs()[c], b.pose.orientation.coeffs()[c]));
    }
    ASSERT_EQ(a.tick.index, b.tick.index);
    ASSERT_EQ(a.tick.time_s, b.tick.time_s);
    ASSERT_EQ(a.buttons, b.buttons);
    ASSERT_EQ(a.status, b.status);
    ASSERT_EQ(a.flags, b.flags);
    ASSERT_EQ(a.lateness_ns, b.lateness_ns);
    ASSERT_EQ(a.force_ns, b.force_ns);
    ASSERT_EQ(a.shape_ns, b.shape_ns);
  }
}

TEST_F(LiveLogTest, RefusesWithFileLineAndRange) {
  write(a_few());
  const LiveLog log = read_log(file_);
  EXPECT_EQ(log.ticks.size(), 5u);
  EXPECT_EQ(log.rate_hz, 1000);

  edit(4, "0.06899999999999999", "0.069x");
  expect_refused(4, "tool_z_m = \"0.069x\"");
  write(a_few());
  edit(3, "0.003,3,1", "0.003,-3,1");
  expect_refused(3, "tick = \"-3\"; expected a whole number in [0, 9007199254740992]");
  write(a_few());
  edit(5, "0.009,9,3", "0.009,9,4");
  expect_refused(5, "sequence = 4; expected 3 (a log with dropped records cannot be replayed)");
  write(a_few());
  edit(5, "0.009,9,3", "0.006,6,3");
  expect_refused(5, "tick = 6; expected more than 6");
  write(a_few());
  edit(6, "0.012,12,4", "0.0121,12,4");
  expect_refused(6, "time_s = 0.0121 at tick 12; expected 0.012, as at 1000 Hz");
  write(a_few());
  edit(2, "0,0,0,", "0,0,0,1,");
  expect_refused(2, "29 values; expected 28");
  write(a_few());
  edit(1, "tool_qw", "tool_w");
  expect_refused(1, "no column tool_qw");
  std::vector<TickRecord> records = a_few();
  records[2].published.force_n.x() = nan;
  write(records);
  expect_refused(4, "force_x_n = \"nan\"; expected a finite number");
  write({});
  expect_refused(1, "the log is empty");
  std::filesystem::remove(file_);
  expect_refused(0, "cannot read the log");
}

/// A closed loop with everything that may happen: the hand, invalid poses, missed ticks.
LockStep eventful(const scene::Scene& scene) {
  VirtualClock clock;
  HandDevice hand(scene.track, scene.live, 1e-3);
  class Eventful final : public Device {
   public:
    Eventful(HandDevice& hand, VirtualClock& clock) : hand_(hand), clock_(clock) {}
    [[nodiscard]] std::uint32_t capabilities() const noexcept override { return 0; }
    [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override {
      const bool good = hand_.read(tick, sample);
      sample.buttons = tick.index % 100 < 10;
      if (tick.index > 600 && tick.index < 640) sample.pose.position_m.y() = nan;
      if (tick.index > 700 && tick.index < 740) sample.pose.position_m.z() -= 0.03;
      if (tick.index > 760 && tick.index < 770) return false;
      if (tick.index % 97 == 0) clock_.advance_ns(4'500'000);
      return good;
    }
    void write(const Wrench& wrench) noexcept override { hand_.write(wrench); }

   private:
    HandDevice& hand_;
    VirtualClock& clock_;
  } device(hand, clock);
  return lock_step(scene, device, 1500, clock);
}

TEST_F(LiveLogTest, AReplayGivesEqualBits) {
  scene::Scene scene = live_scene();
  const LockStep first = eventful(scene);
  ASSERT_GT(first.ledger.missed, 20);
  ASSERT_GT(first.ledger.bad_poses, 40);
  ASSERT_GT(first.ledger.limited_ticks, 100);
  write(first.records);

  const LiveLog log = read_log(file_);
  ReplayDevice device(log.ticks);
  const LockStep again = lock_step(scene, device, first.ledger.ticks);
  EXPECT_EQ(device.unequal(), 0);
  EXPECT_EQ(again.answer_hash, first.answer_hash);
  ASSERT_EQ(again.records.size(), first.records.size());
  for (std::size_t i = 0; i < again.records.size(); ++i) {
    ASSERT_EQ(again.records[i].published.force_n, first.records[i].published.force_n) << i;
    ASSERT_EQ(again.records[i].published.torque_nm, first.records[i].published.torque_nm) << i;
    ASSERT_EQ(again.records[i].model.force_n, first.records[i].model.force_n) << i;
    ASSERT_EQ(again.records[i].flags, first.records[i].flags) << i;
    ASSERT_EQ(again.records[i].buttons, first.records[i].buttons) << i;
  }
}

TEST_F(LiveLogTest, AReplayThatMissesTicksPlaysEveryRow) {
  const scene::Scene scene = live_scene();
  const LockStep first = eventful(scene);
  ReplayDevice replay(first.records);
  VirtualClock clock;
  test::FakeDevice device([&](const Tick& tick, DeviceSample& sample) {
    if (tick.index % 41 == 0) clock.advance_ns(3'200'000);
    return replay.read(tick, sample);
  });
  fast::SkeletonEngine engine(scene);
  const LoopTime time{1000, 1'000'000, first.ledger.ticks};
  WrenchLimiter limiter(WrenchLimits::of(scene.live, engine.tool_reach_m()), time.period_s());
  Ledger ledger;
  run_device_loop(time, {device, engine, limiter, clock, nullptr, nullptr, &replay}, ledger);
  EXPECT_GT(ledger.missed, 50);
  EXPECT_EQ(replay.compared(), first.ledger.ticks);
  EXPECT_EQ(replay.unequal(), 0);
  EXPECT_EQ(engine.answer_hash(), first.answer_hash);
}

TEST_F(LiveLogTest, AReplaySeesAnAnswerThatIsNotTheLogs) {
  scene::Scene scene = live_scene();
  const LockStep first = eventful(scene);
  {
    scene::Scene other = scene;
    other.contact.k3_n_per_m3 *= 1.0 + 1e-13;
    ReplayDevice device(first.records);
    fast::SkeletonEngine engine(other);
    VirtualClock clock;
    const LoopTime time{1000, first.ledger.ticks};
    WrenchLimiter limiter(WrenchLimits::of(other.live, engine.tool_reach_m()), time.period_s());
    Ledger ledger;
    run_device_loop(time, {device, engine, limiter, clock, nullptr, nullptr, &device}, ledger);
    EXPECT_GT(device.unequal(), 100);
    EXPECT_GT(device.first_unequal(), 0);
  }
  // One bit in one row, in the published wrench alone.
  std::vector<TickRecord> edited = first.records;
  edited[700].published.torque_nm.y() = std::nextafter(edited[700].published.torque_nm.y(), 1.0);
  ReplayDevice device(edited);
  for (const TickRecord& record : first.records) device.tick_done(record);
  EXPECT_EQ(device.unequal(), 1);
  EXPECT_EQ(device.first_unequal(), 700);
}

}  // namespace
}  // namespace touchstone::live
