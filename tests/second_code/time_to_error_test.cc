// Selection of the mesh whose cost is that of an error.
#include "compare/calculix/time_to_error.h"

#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

TEST(TimeToError, TakesTheFirstMeshFromWhichOnTheErrorStaysSmall) {
  const std::vector<MeshCost> meshes{
      {0, 0.004, 1.0, 1.0}, {1, 0.02, 2.0, 2.0}, {2, 0.006, 4.0, 4.0}, {3, 0.001, 8.0, 8.0}};
  EXPECT_EQ(cost_within(meshes, 0.05)->level, 0);
  EXPECT_EQ(cost_within(meshes, 0.01)->level, 2);
  EXPECT_EQ(cost_within(meshes, 0.005)->level, 3);
  EXPECT_FALSE(cost_within(meshes, 0.0005));
  EXPECT_FALSE(cost_within({}, 1.0));
}

TEST(TimeToError, SaysTheRatioOrWhoMissesIt) {
  TimeToError times;
  times.ours = {{0, 0.02, 1.0, 0.5}, {1, 0.004, 3.0, 2.0}};
  times.calculix = {{0, 0.03, 9.0, 6.0}, {1, 0.008, 40.0, 30.0}};
  const std::string text = time_to_error_text(times);
  EXPECT_NE(text.find("within 1 %: ours 2.00 s, CalculiX 30.00 s of CPU, 15.0 times as much"), std::string::npos)
      << text;
  EXPECT_NE(text.find("within 0.5 %: CalculiX does not reach it"), std::string::npos) << text;
}

}  // namespace
}  // namespace touchstone::compare
