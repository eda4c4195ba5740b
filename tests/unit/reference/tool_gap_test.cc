#include "reference/tool_gap.h"

#include <gtest/gtest.h>

namespace touchstone::reference {
namespace {

TEST(BallTool, GradientAndHessianAreTheSlopes) {
  const Eigen::Vector3d center(0.1, -0.2, 1.5);
  const RigidTool<3> tool = ball_tool<3>(0.7, center);
  const Eigen::Vector3d x(0.3, 0.2, 0.9);
  const Gap<3> g = tool.gap(x);
  EXPECT_NEAR(g.value_m, (x - center).norm() - 0.7, 1e-15);
  const double step = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d dx = step * Eigen::Vector3d::Unit(i);
    const Gap<3> up = tool.gap(x + dx), down = tool.gap(x - dx);
    EXPECT_NEAR(g.gradient[i], (up.value_m - down.value_m) / (2.0 * step), 1e-9);
    EXPECT_LT((g.hessian_per_m.col(i) - (up.gradient - down.gradient) / (2.0 * step)).norm(), 1e-8);
  }
}

TEST(BallTool, GapAlongTheNormalIsHertzsBoundaryCondition) {
  const RigidTool<2> tool = ball_tool<2>(1.0, {0.0, 1.9});
  const Gap<2> below = tool.gap_along({0.0, 1.0}, {0.0, 1.0}, {0.0, -0.04});
  EXPECT_NEAR(below.value_m, -0.06, 1e-15);
  // Sideways motion does not matter, and what is not under the ball never touches.
  EXPECT_NEAR(tool.gap_along({0.6, 1.0}, {0.0, 1.0}, {0.3, 0.0}).value_m, 0.9 - 0.8, 1e-15);
  EXPECT_TRUE(std::isinf(tool.gap_along({1.2, 1.0}, {0.0, 1.0}, {0.0, 0.0}).value_m));
}

}  // namespace
}  // namespace touchstone::reference
