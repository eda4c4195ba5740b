// Whole runs in real time. Times are not judged: only that everything ended and was written.
#include "fast/live/live.h"

#include "fast/live/live_log.h"
#include "scene/base/error.h"
#include "unit/fast/live/lock_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

namespace touchstone::live {
namespace {

using test::live_scene;

class LiveRun : public testing::Test {
 protected:
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("touchstone-live-" + std::to_string(getpid()) + "-" +
                                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  std::atomic<bool> stop_{false};
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  LiveResult run(const LiveOptions& options, const scene::Scene& scene = live_scene()) {
    return run_live(scene, options, folder_, stop_, {}, {});
  }
};

TEST_F(LiveRun, EveryGridPointIsDoneOrMissedAndEveryTickIsWritten) {
  LiveOptions options;
  options.device = DeviceKind::hand;
  options.seconds = 0.3;
  const LiveResult result = run(options);
  EXPECT_EQ(result.ledger.ticks + result.ledger.missed, 300);
  EXPECT_FALSE(result.interrupted);
  const LiveLog log = read_log(folder_ / "live.csv");
  EXPECT_EQ(log.ticks.size() + result.dropped_records, static_cast<std::size_t>(result.ledger.ticks));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "live.csv.part"));
  EXPECT_GE(result.ledger.step.count(), log.ticks.size());
}

TEST_F(LiveRun, TheLedgerHasEveryStageOfTheSceneAndNoOther) {
  scene::Scene scene = live_scene();
  LiveOptions options;
  options.seconds = 0.3;
  const auto runs = [](const LiveResult& result, fast::Stage stage) {
    return result.ledger.stages[static_cast<std::size_t>(stage)].count();
  };
  using enum fast::Stage;
  for (const bool friction : {false, true}) {
    if (friction) scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
    const LiveResult result = run(options, scene);
    const auto ticks = static_cast<std::uint64_t>(result.ledger.ticks);
    EXPECT_EQ(runs(result, detection), ticks);
    EXPECT_EQ(runs(result, regions), 0u);
    EXPECT_EQ(runs(result, fast::Stage::friction), friction ? runs(result, force) : 0u);
    for (const fast::Stage stage : {force, skeleton, interpolation, local_factor, normals}) {
      EXPECT_GT(2 * runs(result, stage), ticks);
      EXPECT_LE(runs(result, stage), ticks);
    }
    std::int64_t longest_ns = 0;
    for (const fast::DurationHistogram& stage : result.ledger.stages) longest_ns = std::max(longest_ns, stage.max_ns());
    EXPECT_LE(longest_ns, result.ledger.step.max_ns());
    std::size_t keys = 0;
    for (const scene::Figure& figure : figures(result, options)) keys += figure.key.starts_with("live.stage.") ? 1 : 0;
    EXPECT_EQ(keys, friction ? 28u : 24u);
  }
}

TEST_F(LiveRun, AReplayOfItEqualsItsLog) {
  LiveOptions options;
  options.seconds = 0.4;  // of 0.5: in contact since 0.04
  const LiveResult first = run(options);
  ASSERT_GT(first.ledger.force_max_n, 1.0);
  options.device = DeviceKind::replay;
  options.seconds.reset();
  std::filesystem::rename(folder_ / "live.csv", folder_ / "first.csv");
  options.log = folder_ / "first.csv";
  const LiveResult again = run(options);
  ASSERT_TRUE(again.replay);
  EXPECT_TRUE(again.replay->equal());
  EXPECT_EQ(again.replay->compared, first.ledger.ticks);
  EXPECT_EQ(again.answer_hash, first.answer_hash);
  EXPECT_THAT(summary_text(again), testing::HasSubstr("to the last bit"));

  scene::Scene other = live_scene();
  other.contact.k1_n_per_m *= 1.01;
  const LiveResult differs = run(options, other);
  EXPECT_FALSE(differs.replay->equal());
  EXPECT_THAT(summary_text(differs), testing::HasSubstr("differ from the log's"));
}

TEST_F(LiveRun, EndsWhenAskedWithAllWritten) {
  LiveOptions options;
  options.device = DeviceKind::hand;
  options.seconds = 3600.0;
  std::jthread asker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop_ = true;
  });
  const LiveResult result = run(options);
  EXPECT_TRUE(result.interrupted);
  EXPECT_LT(result.ledger.ticks, 3600000);
  EXPECT_EQ(read_log(folder_ / "live.csv").ticks.size() + result.dropped_records,
            static_cast<std::size_t>(result.ledger.ticks));
}

TEST(LiveSummary, IsNeverCut) {
  LiveResult result;
  result.ledger.status = 0xffffffff;
  result.scheduling.fifo = true;
  result.replay =
      ReplayAnswer{std::int64_t{1} << 60, std::int64_t{1} << 60, std::int64_t{1} << 59, std::int64_t{1} << 58};
  const std::string text = summary_text(result);
  EXPECT_NE(text.find("Status: " + fast::status_text(0xffffffff) + "\n"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with(
      "Replay: 576460752303423488 of 1152921504606846976 answers differ from the log's, the first on line "
      "288230376151711746 (same scene file?)\n"))
      << text;
}

TEST_F(LiveRun, FiguresHaveTheKeysOfTheContract) {
  LiveOptions options;
  options.seconds = 0.05;
  const scene::Figures list = figures(run(options), options);
  std::vector<std::string> keys;
  for (const scene::Figure& figure : list) keys.push_back(figure.key);
  for (const char* key :
       {"live.ticks", "live.missed", "live.lateness_us.p50", "live.lateness_us.p99", "live.lateness_us.p999",
        "live.lateness_us.max", "live.step_us.p50", "live.force_us.p99", "live.shape_us.max", "live.force_max_n",
        "live.dropped_records", "live.shape_age_us.p50", "live.shape_age_us.p999", "live.scheduling", "live.bad_poses",
        "live.limited_ticks", "live.status"}) {
    EXPECT_EQ(std::count(keys.begin(), keys.end(), key), 1) << key;
  }
}

TEST_F(LiveRun, RefusesOptionsThatCannotBe) {
  const auto expect_refused = [&](const LiveOptions& options, const std::string& message) {
    try {
      (void)run(options);
      FAIL() << message;
    } catch (const scene::InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(message));
      EXPECT_THAT(error.what(), testing::HasSubstr("expected"));
    }
  };
  LiveOptions options;
  options.seconds = -1.0;
  expect_refused(options, "--seconds");
  options.seconds = std::nan("");
  expect_refused(options, "--seconds");
  options = {};
  options.rate_hz = 10001;
  expect_refused(options, "--rate = 10001; expected a whole number in [1, 10000]");
  options = {};
  options.device = DeviceKind::replay;
  expect_refused(options, "needs --log");
  options.log = folder_ / "none.csv";
  expect_refused(options, "none.csv: cannot read the log");
  options.device = DeviceKind::hand;
  expect_refused(options, "--log is for --device replay");
}

TEST_F(LiveRun, RefusalsOfTheSystemAreWarningsWithAdvice) {
  LiveOptions options;
  options.seconds = 0.02;
  options.scheduling.processor = 100000;
  options.scheduling.priority = 1000;
  std::vector<std::string> warnings;
  const LiveResult result =
      run_live(live_scene(), options, folder_, stop_, {}, [&](const std::string& text) { warnings.push_back(text); });
  EXPECT_FALSE(result.scheduling.fifo);
  EXPECT_FALSE(result.scheduling.pinned);
  EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("processor 100000 refused")));
  EXPECT_THAT(warnings, testing::Contains(testing::HasSubstr("SCHED_FIFO refused")));
  EXPECT_THAT(result.scheduling.text(), testing::HasSubstr("SCHED_OTHER"));
  EXPECT_EQ(result.ledger.ticks + result.ledger.missed, 20);
}

}  // namespace
}  // namespace touchstone::live
