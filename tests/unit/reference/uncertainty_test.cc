#include "reference/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::reference {
namespace {

TEST(Uncertainty, LargerOfTheLastChangeAndHalfTheOneBefore) {
  const auto band = force_band({{10.0, 10.0}, {10.4, 10.1}, {10.5, 10.0}});
  ASSERT_EQ(band.size(), 2u);
  EXPECT_NEAR(band[0], 1.25 * 0.2, 1e-12);
  EXPECT_NEAR(band[1], 1.25 * 0.2, 1e-12);  // from its neighbour; its own is 0.125
}

TEST(Uncertainty, NeighboursCoverAChanceAgreement) {
  const auto band = force_band({{1.0, 2.0, 3.0, 4.0}, {1.0, 2.0, 3.0, 4.2}, {1.0, 2.0, 3.0, 4.2}});
  EXPECT_EQ(band[1], 0.0);
  EXPECT_NEAR(band[2], 0.125, 1e-12);
}

TEST(Uncertainty, UnknownWithFewerThanThreeLevels) {
  for (const double half_width : force_band({{1.0, 2.0}, {1.0, 2.0}})) EXPECT_TRUE(std::isinf(half_width));
  const auto shape = displacement_band({{Eigen::Matrix3Xd::Zero(3, 2)}});
  EXPECT_TRUE(std::isinf(shape[0][1]));
}

TEST(Uncertainty, ShapePerPoint) {
  Eigen::Matrix3Xd u0 = Eigen::Matrix3Xd::Zero(3, 2), u1 = u0, u2 = u0;
  u1.col(1) << 3.0, 4.0, 0.0;
  u2.col(1) << 3.0, 4.0, 1.0;
  const auto band = displacement_band({{u0}, {u1}, {u2}});
  EXPECT_EQ(band[0][0], 0.0);
  EXPECT_NEAR(band[0][1], 1.25 * 2.5, 1e-12);
}

}  // namespace
}  // namespace touchstone::reference
