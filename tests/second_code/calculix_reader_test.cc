// Reading CalculiX's .dat: factors, directions, and the output of an unfinished run.
#include "compare/calculix/calculix.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace touchstone::compare {
namespace {

class CalculixReader : public testing::Test {
 protected:
  CalculixReader()
      : dat_(std::filesystem::temp_directory_path() / ("touchstone-dat-" + std::to_string(::getpid()) + ".dat")) {
    deck_.whole_body = {0.0, 2.0, 2.0};
    deck_.surface_nodes = {4, 9};
  }
  ~CalculixReader() override { std::filesystem::remove(dat_); }

  std::vector<CalculixStep> read(const std::string& text) const {
    std::ofstream(dat_) << text;
    return read_calculix(dat_, deck_);
  }

  /// One step as CalculiX 2.20 prints it.
  static std::string step(int time, double scale, int nodes = 2) {
    std::ostringstream text;
    text << "\n total force (fx,fy,fz) for set TOOL and time  0." << time << "000000E+01\n\n       " << -3.0 * scale
         << "  " << -5.0 * scale << "  " << -7.0 * scale << "\n";
    text << "\n displacements (vx,vy,vz) for set SURFACE and time  0." << time << "000000E+01\n\n";
    const int numbers[] = {4, 9};
    for (int k = 0; k < nodes; ++k) text << "         " << numbers[k] << "  " << scale + k << "  2.0E-01 -3.0E-01\n";
    return text.str();
  }

  std::filesystem::path dat_;
  reference::Deck deck_;
};

TEST_F(CalculixReader, WholeBodyOfEveryStep) {
  const auto steps = read(step(1, 1.0) + step(2, 10.0));
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_EQ(steps[0].force_n, scene::Vec3(0.0, 10.0, 14.0));
  EXPECT_EQ(steps[1].force_n, scene::Vec3(0.0, 100.0, 140.0));
  EXPECT_EQ(steps[1].displacement_m.col(0), scene::Vec3(10.0, 0.2, -0.3));
  EXPECT_EQ(steps[1].displacement_m.col(1), scene::Vec3(11.0, 0.2, -0.3));
}

TEST_F(CalculixReader, TheMeridianPlaneStandsInTheWorld) {
  deck_.axisymmetric = true;
  deck_.whole_body = {0.0, 0.0, 180.0};
  const auto steps = read(step(1, 1.0));
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_EQ(steps[0].force_n, scene::Vec3(0.0, 0.0, 900.0));
  EXPECT_EQ(steps[0].displacement_m.col(1), scene::Vec3(2.0, 0.0, 0.2));
}

TEST_F(CalculixReader, AnUnfinishedStepIsLeftOut) {
  const std::string first = step(1, 1.0), second = step(2, 10.0);
  EXPECT_EQ(read(first + step(2, 10.0, 1)).size(), 1u);
  // Cut off anywhere except within its last number, where the cut cannot be seen.
  for (std::size_t length = 0; length < second.rfind("-3.0"); ++length) {
    EXPECT_EQ(read(first + second.substr(0, length)).size(), 1u) << length;
  }
  EXPECT_TRUE(read("").empty());
  std::filesystem::remove(dat_);
  EXPECT_TRUE(read_calculix(dat_, deck_).empty());
}

TEST_F(CalculixReader, AnotherDecksAnswerIsNone) {
  deck_.surface_nodes = {4, 8};
  EXPECT_TRUE(read(step(1, 1.0)).empty());
}

}  // namespace
}  // namespace touchstone::compare
