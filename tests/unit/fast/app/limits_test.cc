// Limits as a user sees them: exit codes, what is kept, and why refinement ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "support/source_folder.h"

namespace {

using testing::HasSubstr;

struct Answer {
  int exit_code;
  std::string output, errors;
};

class LimitsVerb : public testing::Test {
 protected:
  LimitsVerb()
      : dir_(std::filesystem::path(testing::TempDir()) /
             (std::string("limits-") + testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove_all(dir_);
    std::filesystem::create_directories(dir_);
  }
  ~LimitsVerb() override { std::filesystem::remove_all(dir_); }

  void SetUp() override {
    std::istringstream in(TOUCHSTONE_VERBS);
    for (std::string one; std::getline(in, one, '|');) {
      if (one.ends_with(" compare")) program_ = one.substr(0, one.rfind(' '));
    }
    if (program_.empty()) GTEST_SKIP() << "a build without the reference";
  }

  [[nodiscard]] static std::string text_of(const std::filesystem::path& file) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
  }

  [[nodiscard]] Answer run(const std::string& verb, const std::string& options) const {
    const std::string command = program_ + " " + verb + " " + touchstone::source_folder() +
                                "/meshes/scenes/pin-on-cylinder.toml --quiet --set compare.instants=3 " + options +
                                " --store " + (dir_ / "store").string() + " --out " + (dir_ / "out").string() + " >" +
                                (dir_ / "output").string() + " 2>" + (dir_ / "errors").string();
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), text_of(dir_ / "output"), text_of(dir_ / "errors")};
  }
  [[nodiscard]] nlohmann::json summary() const { return nlohmann::json::parse(text_of(dir_ / "out" / "summary.json")); }

  std::filesystem::path dir_;
  std::string program_;
};

TEST_F(LimitsVerb, NoMeshFinishedIsExitThreeAndOneSentence) {
  for (const std::string verb : {"reference", "compare"}) {
    for (const std::string limit : {"--memory-gib 0.1 --set reference.element_size_m=2e-5",
                                    "--minutes 0.01 --set reference.element_size_m=2e-5"}) {
      const Answer answer = run(verb, limit);
      EXPECT_EQ(answer.exit_code, 3) << answer.errors;
      EXPECT_EQ(answer.output, "");
      EXPECT_THAT(answer.errors, HasSubstr("no answer, since mesh 1 is not finished: its "));
      EXPECT_THAT(answer.errors, HasSubstr("--minutes and --memory-gib"));
      EXPECT_EQ(std::count(answer.errors.begin(), answer.errors.end(), '\n'), 1) << answer.errors;
      EXPECT_FALSE(std::filesystem::exists(dir_ / "out" / "summary.json"));
    }
  }
}

// One case, so that the body's response is computed once.
TEST_F(LimitsVerb, WhyRefinementEndedIsSaidAndRequireErrorExitsThreeWithItsResultsWritten) {
  const Answer one = run("reference", "--level 1");
  EXPECT_EQ(one.exit_code, 0) << one.errors;
  EXPECT_THAT(one.output, HasSubstr("Refinement ended: 1 mesh was asked for; an uncertainty needs 3\n"));
  EXPECT_THAT(one.output, HasSubstr("force unknown, shape unknown, from 1 mesh\n"));
  EXPECT_EQ(summary()["reference.why_ended"], "1 mesh was asked for; an uncertainty needs 3");
  const Answer known = run("compare", "--error 0.1");
  EXPECT_EQ(known.exit_code, 0) << known.errors;
  EXPECT_THAT(known.output, HasSubstr("Refinement ended: force and shape are known to 10 % after 3 meshes\n"));
  EXPECT_EQ(summary()["reference.why_ended"], "force and shape are known to 10 % after 3 meshes");

  std::filesystem::remove_all(dir_ / "out");
  for (const std::string verb : {"reference", "compare"}) {
    const Answer missed = run(verb, "--level 2 --require-error 0.05");
    EXPECT_EQ(missed.exit_code, 3) << missed.output;
    EXPECT_EQ(missed.errors,
              "The reference is not known to 5 %, which --require-error asks for: 2 meshes were asked for; an "
              "uncertainty needs 3\n");
    EXPECT_TRUE(std::filesystem::exists(dir_ / "out" / "summary.json"));
    std::filesystem::remove_all(dir_ / "out");
  }
  // Without --level or --error, --require-error is the target of the refinement.
  const Answer reached = run("reference", "--set reference.error=0.4 --require-error 0.05");
  EXPECT_EQ(reached.exit_code, 0) << reached.errors;
  EXPECT_EQ(reached.errors, "");
  EXPECT_LE(summary()["reference.force_uncertainty_rel"].get<double>(), 0.05);
}

TEST_F(LimitsVerb, PlanEstimatesEveryMesh) {
  const Answer plan = [&] {
    const std::string command = program_ + " plan " + touchstone::source_folder() +
                                "/meshes/scenes/pin-on-cylinder.toml >" + (dir_ / "output").string();
    const int status = std::system(command.c_str());
    return Answer{WEXITSTATUS(status), text_of(dir_ / "output"), ""};
  }();
  EXPECT_EQ(plan.exit_code, 0);
  for (const char* mesh : {"mesh 1", "mesh 2", "mesh 3", "all meshes"}) {
    const std::size_t at = plan.output.find(std::string("  yes  ") + mesh + " ");
    ASSERT_NE(at, std::string::npos) << plan.output;
    const std::string line = plan.output.substr(at, plan.output.find('\n', at) - at);
    EXPECT_TRUE(std::string(mesh) == "all meshes" || line.find(" unknowns, about ") != std::string::npos) << line;
    EXPECT_THAT(line, HasSubstr(" GiB and "));
    EXPECT_TRUE(line.ends_with(" s)") || line.ends_with(" min)")) << line;
  }
}

TEST_F(LimitsVerb, ABusyMachineGetsOneThread) {
  std::atomic<bool> over = false;
  std::vector<std::jthread> busy;
  for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i) {
    busy.emplace_back([&over] {
      while (!over) {
      }
    });
  }
  const std::string plan = " " + program_ + " plan " + touchstone::source_folder() +
                           "/meshes/scenes/pin-on-cylinder.toml >" + (dir_ / "output").string();
  EXPECT_EQ(std::system(("env -u OMP_NUM_THREADS" + plan).c_str()), 0);
  EXPECT_THAT(text_of(dir_ / "output"), HasSubstr("time of 1 thread on"));
  EXPECT_EQ(std::system(("env OMP_NUM_THREADS=3" + plan).c_str()), 0);
  EXPECT_THAT(text_of(dir_ / "output"), HasSubstr("time of 3 threads on"));
  over = true;
}

}  // namespace
