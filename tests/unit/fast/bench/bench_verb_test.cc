// Results of `bench`: its folder, every figure finite and above zero. Times are not judged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

using testing::AllOf;
using testing::HasSubstr;

struct Answer {
  int exit_code;
  std::string output;  ///< stdout and stderr
};

class BenchVerb : public testing::Test {
 protected:
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) / ("touchstone-bench-verb-" + std::to_string(getpid()) + "-" +
                                                   testing::UnitTest::GetInstance()->current_test_info()->name());
  void TearDown() override { std::filesystem::remove_all(folder_); }

  Answer bench(const std::string& options) {
    const std::string command =
        std::string(TOUCHSTONE_FAST) + " bench --quiet --out " + folder_.string() + " " + options + " 2>&1";
    Answer answer{-1, ""};
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 4096> buffer{};
    while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) answer.output += buffer.data();
    answer.exit_code = WEXITSTATUS(pclose(pipe));
    return answer;
  }
  [[nodiscard]] nlohmann::json read(const char* name) const {
    return nlohmann::json::parse(std::ifstream(folder_ / name));
  }
};

void expect_positive(const nlohmann::json& summary, const std::string& key) {
  ASSERT_TRUE(summary.contains(key)) << key;
  ASSERT_TRUE(summary[key].is_number()) << key << ": " << summary[key];
  EXPECT_GT(summary[key].get<double>(), 0.0) << key;
  EXPECT_TRUE(summary["units"].contains(key)) << key;
}

void expect_case(const nlohmann::json& summary, const std::string& name) {
  const std::string key = "bench." + name + ".";
  for (const char* figure : {"triangles",
                             "vertices",
                             "ticks",
                             "points",
                             "setup_s",
                             "step_us.p50",
                             "step_us.p99",
                             "step_us.p999",
                             "step_us.max",
                             "floor_us.p50",
                             "over_floor",
                             "force_us.p50",
                             "force_us_per_region",
                             "step_cpu_us",
                             "stage.detection_us.p50",
                             "stage.force_us.p50",
                             "stage.skeleton_us.p99",
                             "stage.interpolation_us.p999",
                             "stage.local_factor_us.max",
                             "stage.normals_us.p50",
                             "stage.normals_over_floor"}) {
    expect_positive(summary, key + figure);
  }
  EXPECT_EQ(summary[key + "status"], "ok");
}

#if TOUCHSTONE_BENCH_WHOLE
TEST_F(BenchVerb, AQuickRunMeasuresEveryTarget) {
  const Answer answer = bench("--quick --ticks 40");
  ASSERT_EQ(answer.exit_code, 0) << answer.output;
  const nlohmann::json summary = read("summary.json");
  for (const char* key :
       {"step_over_floor_4k", "step_over_floor_100k", "ten_regions_over_one_4k", "force_us_p50_per_region"}) {
    expect_positive(summary, key);
    EXPECT_NE(summary["bench.verdict." + std::string(key)], "not measured");
    EXPECT_THAT(answer.output, HasSubstr(key));
  }
  EXPECT_TRUE(summary.contains("bullet_over_step_1k"));
  for (const char* body : {"box", "ellipsoid"}) {
    for (const char* size : {"1k", "4k", "100k"}) {
      for (const int regions : {1, 10}) {
        const std::string name = std::string(body) + "." + size + "." + std::to_string(regions);
        expect_case(summary, name);
        EXPECT_EQ(summary["bench." + name + ".regions_least"], regions) << name;
      }
    }
  }
#if TOUCHSTONE_BENCH_PEER
  expect_positive(summary, "bullet_over_step_1k");
  expect_positive(summary, "bench.bullet.1k.rubber.implicit.step_us.p50");
  EXPECT_EQ(summary["bench.bullet.1k.rubber.implicit.status"], "in contact");
#endif
}
#endif

TEST_F(BenchVerb, OneCaseLeavesItsFolder) {
  const Answer answer = bench("--only box/1k/1 --ticks 33");
  ASSERT_EQ(answer.exit_code, 0) << answer.output;
  const nlohmann::json summary = read("summary.json");
  expect_case(summary, "box.1k.1");
  EXPECT_EQ(summary["bench.box.1k.1.ticks"], 33);
  EXPECT_FALSE(summary.contains("bench.box.4k.1.ticks"));
  EXPECT_TRUE(summary["step_over_floor_4k"].is_null());
  EXPECT_EQ(summary["bench.verdict.step_over_floor_4k"], "not measured");
  const nlohmann::json manifest = read("manifest.json");
  for (const char* key : {"command", "host", "processor", "compiler", "date", "load_average_before", "counters"}) {
    EXPECT_TRUE(manifest.contains(key)) << key;
  }
  EXPECT_EQ(manifest["only"], "box/1k/1");
}

TEST_F(BenchVerb, RefusesACaseThatThereIsNot) {
  const Answer answer = bench("--only box/5k");
  EXPECT_EQ(answer.exit_code, 2);
  EXPECT_THAT(answer.output, AllOf(HasSubstr("box/5k: no such case"), HasSubstr("did you mean \"box/1k\"?")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "summary.json"));
  EXPECT_EQ(bench("--ticks 0").exit_code, 2);
}

}  // namespace
