#include "compare/report/result_folder.h"

#include "compare/comparison/compare.h"
#include "compare/errors/compute_errors.h"
#include "scene/base/error.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;

class ResultFolderTest : public ::testing::Test {
 protected:
  ResultFolderTest() {
    comparison_ = write_comparison(folder_.path(), sides_.scene, sides_.run, sides_.result, sides_.manifest, {});
  }
  [[nodiscard]] std::string fault() const {
    try {
      (void)read_result_folder(folder_.path());
    } catch (const scene::InputError& error) {
      return error.what();
    }
    return "";
  }

  testing::Sides sides_ = testing::pressed(4, 200);
  testing::TemporaryFolder folder_;
  Comparison comparison_;
};

TEST_F(ResultFolderTest, IsReadBackAsItWasWritten) {
  const ResultFolder read = read_result_folder(folder_.path());
  EXPECT_EQ(read.command, sides_.manifest.command);
  EXPECT_EQ(read.scene_hash, sides_.manifest.scene_hash);
  EXPECT_EQ(read.title, sides_.manifest.title);
  EXPECT_EQ(read.resolved_scene, sides_.manifest.resolved_scene);
  ASSERT_EQ(read.figures.size(), comparison_.figures.size());
  for (const scene::Figure& written : comparison_.figures) {
    const scene::Figure* figure = read.figure(written.key);
    ASSERT_NE(figure, nullptr) << written.key;
    EXPECT_EQ(figure->text, written.text);
    EXPECT_EQ(figure->unit, written.unit);
    if (written.text.empty() && std::isfinite(written.number)) {
      EXPECT_EQ(figure->number, written.number);
    }
  }
  const Errors errors = compute_errors(sides_.scene, sides_.run, sides_.result.instants);
  const auto columns = curve_columns(sides_.run, sides_.result, errors);
  ASSERT_EQ(read.curve.size(), columns.size());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    EXPECT_EQ(read.curve[i].name, columns[i].name);
    ASSERT_EQ(read.curve[i].values.size(), columns[i].values.size());
    for (std::size_t t = 0; t < columns[i].values.size(); ++t) {
      const double a = read.curve[i].values[t], b = columns[i].values[t];
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << columns[i].name << " " << a << " " << b;
    }
  }
  EXPECT_EQ(read.figure("no.such"), nullptr);
  EXPECT_EQ(read.column("no_such"), nullptr);
  EXPECT_THROW((void)read.required_column("no_such"), scene::InputError);
}

TEST_F(ResultFolderTest, NamesEveryFileThatIsMissing) {
  std::filesystem::remove(folder_.path() / "summary.json");
  std::filesystem::remove(folder_.path() / "curve.csv");
  EXPECT_THAT(fault(), HasSubstr("summary.json"));
  EXPECT_THAT(fault(), HasSubstr("curve.csv"));
}

TEST_F(ResultFolderTest, NamesTheLineOfADamage) {
  scene::write_file(folder_.path() / "summary.json", "{\n\"a\": 1,\n\"b\": \n");
  EXPECT_THAT(fault(), ::testing::ContainsRegex("summary\\.json:[34]: "));
  scene::write_file(folder_.path() / "summary.json", "{\"a\": 1e999}");
  EXPECT_THAT(fault(), HasSubstr("summary.json: holds a number that is too large"));
  scene::write_file(folder_.path() / "curve.csv", "time_s,depth_m\n0,1\n1\n");
  EXPECT_THAT(fault(), HasSubstr("curve.csv:3: has 1 values, expected 2"));
  scene::write_file(folder_.path() / "curve.csv", "time_s,depth_m\n0,1\n1,2x\n");
  EXPECT_THAT(fault(), HasSubstr("curve.csv:3: \"2x\" in column depth_m is no number"));
}

TEST_F(ResultFolderTest, ReadsBackWhyANumberIsNotKnown) {
  testing::set_all(sides_.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  (void)write_comparison(folder_.path(), sides_.scene, sides_.run, sides_.result, sides_.manifest, {});
  const ResultFolder read = read_result_folder(folder_.path());
  const scene::Figure* figure = read.figure("force.nrmse_uncertainty");
  ASSERT_NE(figure, nullptr);
  EXPECT_TRUE(std::isnan(figure->number));
  EXPECT_EQ(figure->text, "unknown");
  for (const double band_n : read.required_column("reference_force_uncertainty_n")) EXPECT_TRUE(std::isnan(band_n));
}

}  // namespace
}  // namespace touchstone::compare
