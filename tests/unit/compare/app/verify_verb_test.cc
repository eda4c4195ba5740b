// Results of `touchstone verify`: verdicts, exit codes, files.
#include "compare/app/verify_verb.h"

#include "fast/command/command_line.h"
#include "reference/solver.h"
#include "scene/base/error.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <iterator>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using verification::Check;
using verification::Effort;
using verification::Problem;

/// A problem with one check of 1 N, whose error is a fraction of its limit of 1 %.
Problem off_by(const std::string& name, double share, int* runs = nullptr) {
  return {name, "title of " + name, "source <of> " + name, [=](const Effort& effort) {
            effort.tell("at work");
            if (runs) ++*runs;
            Check check{"force, nu = 0.3", "N", 1.0, 1.0 + 0.01 * share, 0.01, 0.0, 0.002, 1.9};
            return verification::Findings{{check}, {"a note"}};
          }};
}
Problem stuck(const std::string& name) {
  return {name, "title", "source",
          [](const Effort&) -> verification::Findings { throw reference::NotConverged("stuck at step 3"); }};
}
VerifyOptions silent(std::vector<std::string> names = {}) {
  VerifyOptions options;
  options.names = std::move(names);
  options.quiet = true;
  return options;
}

TEST(VerifyVerb, AMissAndAFailureAreSaidAndTheOthersStillRun) {
  int runs = 0;
  const auto records = run_problems({off_by("good", 0.5), stuck("stuck"), off_by("bad", 2.0, &runs)}, silent());
  ASSERT_EQ(records.size(), 3u);
  EXPECT_TRUE(records[0].passes());
  EXPECT_FALSE(records[1].passes());
  EXPECT_FALSE(records[2].passes());
  EXPECT_EQ(runs, 1);
  const std::string text = verify_text(records);
  for (const char* part : {"+0.500 %", "+2.000 %", "MISS, no answer: stuck at step 3", "a note", "0.2 %", " 1.9 ",
                           "2 of 3 problems miss: stuck, bad."}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(verify_text({records[0]}), Not(HasSubstr("MISS")));
}

TEST(VerifyVerb, AProblemWithoutChecksDoesNotPass) {
  const Problem empty{"empty", "title", "source", [](const Effort&) { return verification::Findings{}; }};
  EXPECT_FALSE(run_problems({empty}, silent()).front().passes());
}

TEST(VerifyVerb, RunsOnlyWhatIsNamed) {
  int one = 0, other = 0;
  const auto records = run_problems({off_by("one", 0.0, &one), off_by("other", 0.0, &other)}, silent({"other"}));
  EXPECT_EQ(records.size(), 1u);
  EXPECT_EQ(one, 0);
  EXPECT_EQ(other, 1);
  try {
    static_cast<void>(run_problems({off_by("one", 0.0, &one), off_by("other", 0.0)}, silent({"one", "two"})));
    FAIL();
  } catch (const scene::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"two\"; expected some of one, other"));
  }
  EXPECT_EQ(one, 0) << "bad input is refused before any work";
}

TEST(VerifyVerb, FiguresHaveOneKeyEach) {
  const scene::Figures figures = verify_figures(run_problems({off_by("good", 0.5), stuck("stuck")}, silent()));
  const auto number = [&](const std::string& key) {
    for (const scene::Figure& figure : figures) {
      if (figure.key == key) return figure.number;
    }
    ADD_FAILURE() << key;
    return 0.0;
  };
  EXPECT_EQ(number("verify.problems"), 2.0);
  EXPECT_EQ(number("verify.missed"), 1.0);
  EXPECT_DOUBLE_EQ(number("verify.good.force_nu_0.3.target"), 1.0);
  EXPECT_NEAR(number("verify.good.force_nu_0.3.error_rel"), 0.005, 1e-12);
  EXPECT_DOUBLE_EQ(number("verify.good.force_nu_0.3.limit_rel"), 0.01);
  EXPECT_DOUBLE_EQ(number("verify.good.force_nu_0.3.mesh_band_rel"), 0.002);
}

TEST(VerifyVerb, LeavesAFolderAndAnExitCode) {
  const testing::TemporaryFolder folder;
  VerifyOptions options = silent({"plane-strain-block"});
  options.out = folder.path() / "out";
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(verify(options, "touchstone verify"), fast::done);
  const std::string said = ::testing::internal::GetCapturedStdout();
  EXPECT_THAT(said, HasSubstr("All 1 problems pass"));
  const auto read = [&](const char* name) {
    std::ifstream file(options.out / name);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_THAT(said, HasSubstr(read("table.txt")));
  EXPECT_TRUE(testing::is_well_formed(read("report.html")));
  const nlohmann::json summary = nlohmann::json::parse(read("summary.json"));
  EXPECT_EQ(summary["verify.missed"], 0.0);
  EXPECT_EQ(summary["verify.plane-strain-block.verdict"], "pass");
  EXPECT_EQ(nlohmann::json::parse(read("manifest.json"))["effort"], "full");
}

TEST(VerifyVerb, AMissIsExitCodeOne) {
  const testing::TemporaryFolder folder;
  VerifyOptions options = silent();
  options.out = folder.path();
  const auto exit_code = [&](const std::vector<Problem>& all) {
    ::testing::internal::CaptureStdout();
    const int code = verify(options, "touchstone verify", all);
    static_cast<void>(::testing::internal::GetCapturedStdout());
    return code;
  };
  EXPECT_EQ(exit_code({off_by("good", 0.9)}), fast::done);
  EXPECT_EQ(exit_code({off_by("good", 0.9), off_by("bad", 1.1)}), fast::answer_is_no);
  EXPECT_EQ(exit_code({stuck("stuck")}), fast::answer_is_no);
}

TEST(VerifyVerb, PageEscapesAndSaysTheMiss) {
  const std::string html = verify_html(run_problems({off_by("bad", -3.0)}, silent()), {});
  EXPECT_THAT(html, HasSubstr("source &lt;of&gt; bad"));
  EXPECT_THAT(html, HasSubstr("MISS"));
}

}  // namespace
}  // namespace touchstone::compare
