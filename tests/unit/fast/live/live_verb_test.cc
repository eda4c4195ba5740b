// The command `live` as a user sees it: exit codes, the folder, the result of a replay.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "support/source_folder.h"

namespace {

using testing::HasSubstr;

struct Answer {
  int exit_code;
  std::string output;  ///< stdout and stderr
};

const std::string scene = touchstone::source_folder() + "/meshes/scenes/ball-on-cube-press.toml";

class LiveVerb : public testing::Test {
 protected:
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("touchstone-live-verb-" + std::to_string(getpid()) + "-" +
                                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  /// Runs `live` on the shipped scene. @param before put in front of the command
  Answer live(const std::string& options, const std::string& out, const std::string& before = "") {
    const std::string command = before + TOUCHSTONE_FAST + " live " + scene + " --quiet --out " +
                                (folder_ / out).string() + " " + options + " 2>&1";
    Answer answer{-1, ""};
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) answer.output += buffer.data();
    answer.exit_code = WEXITSTATUS(pclose(pipe));
    return answer;
  }
  nlohmann::json summary(const std::string& out) {
    return nlohmann::json::parse(std::ifstream(folder_ / out / "summary.json"));
  }
  std::string log(const std::string& out) { return (folder_ / out / "live.csv").string(); }
};

TEST_F(LiveVerb, LeavesItsFolderAndPlaysItAgain) {
  const Answer first = live("--device hand --seconds 0.5 --set fast.triangles=300", "first");
  ASSERT_EQ(first.exit_code, 0) << first.output;
  for (const char* name : {"live.csv", "summary.json", "manifest.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "first" / name)) << name;
  }
  const nlohmann::json figures = summary("first");
  EXPECT_EQ(figures["live.ticks"].get<double>() + figures["live.missed"].get<double>(), 500.0);
  EXPECT_EQ(figures["live.device"], "hand");
  EXPECT_EQ(figures["units"]["live.lateness_us.p99"], "us");

  const Answer again = live("--device replay --set fast.triangles=300 --log " + log("first"), "again");
  EXPECT_EQ(again.exit_code, 0) << again.output;
  EXPECT_THAT(again.output, HasSubstr("answers equal the log's to the last bit"));
  EXPECT_EQ(summary("again")["live.answer_hash"], figures["live.answer_hash"]);
  EXPECT_EQ(summary("again")["live.replay_unequal"], 0.0);

  const Answer other = live("--device replay --set contact.k1_n_per_m=41 --log " + log("first"), "other");
  EXPECT_EQ(other.exit_code, 1) << other.output;
  EXPECT_THAT(other.output, HasSubstr("answers differ from the log's, the first on line"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "other" / "summary.json"));
}

TEST_F(LiveVerb, TheLimitIsTheScenes) {
  const Answer answer = live("--device scripted --seconds 1 --set live.force_max_n=2.5", "out");
  ASSERT_EQ(answer.exit_code, 0) << answer.output;
  EXPECT_LE(summary("out")["live.force_max_n"].get<double>(), 2.5);
  EXPECT_GT(summary("out")["live.model_force_max_n"].get<double>(), 5.0);
  EXPECT_GT(summary("out")["live.limited_ticks"].get<double>(), 10.0);
}

TEST_F(LiveVerb, EverySignalToStopEndsItWithAllWritten) {
  for (const std::string signal : {"INT", "TERM", "HUP"}) {
    const Answer answer =
        live("--device hand --seconds 3600", signal, "timeout --foreground --preserve-status -s " + signal + " 0.7 ");
    EXPECT_EQ(answer.exit_code, 130) << signal << ": " << answer.output;
    EXPECT_THAT(answer.output, HasSubstr("Results:"));
    for (const char* name : {"live.csv", "summary.json", "manifest.json"}) {
      EXPECT_TRUE(std::filesystem::exists(folder_ / signal / name)) << signal << ": " << name;
    }
    EXPECT_GE(summary(signal)["live.ticks"].get<double>(), 1.0);
  }
}

TEST_F(LiveVerb, OutlivesItsTerminalWhereThatIsAskedFor) {
  const Answer answer = live("--seconds 1.5 & sleep 0.7; kill -HUP $!; wait $!", "out", "trap '' HUP; ");
  EXPECT_EQ(answer.exit_code, 0) << answer.output;
}

TEST_F(LiveVerb, BadInputIsOneMessage) {
  std::ofstream(folder_ / "bad.csv") << "time_s,tick\n0,0\n";
  for (const auto& [options, message] : std::vector<std::pair<std::string, std::string>>{
           {"--device mouse", "mouse"},
           {"--rate 20000", "--rate = 20000; expected a whole number in [1, 10000]"},
           {"--seconds 0", "expected a number in (0, 604800]"},
           {"--device replay", "--device replay needs --log FILE"},
           {"--device replay --log " + (folder_ / "bad.csv").string(), "bad.csv:1: no column sequence; expected"}}) {
    const Answer answer = live(options, "bad");
    EXPECT_EQ(answer.exit_code, 2) << answer.output;
    EXPECT_THAT(answer.output, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "bad" / "summary.json"));
  }
}

}  // namespace
