// Reduced models against fuller ones on the same cells: equal to the solver's tolerance.
#include "reference/contact/contact_problem.h"
#include "reference/mesh/mesh.h"
#include "reference/tool/tool_distance.h"

#include <gtest/gtest.h>

namespace touchstone::reference {
namespace {

/// Ball of 10 mm pressed 3 mm into the middle of a block, 6 x 6 x 3 cells.
Observation press(bool mirror_x, bool mirror_y, double nu) {
  const double half_m = 0.03;
  BlockSpec spec{{mirror_x ? 0.0 : -half_m, mirror_y ? 0.0 : -half_m, 0.0},
                 Eigen::Vector3d::Constant(half_m),
                 mirror_x,
                 mirror_y,
                 {{}, 0.5, half_m / 3.0}};
  ContactProblem<3> body(block_mesh(spec), {3e6, nu}, scene::Kinematics::finite, mirror_x, mirror_y);
  State<3> state = body.rest();
  for (const double depth_m : {0.001, 0.003}) {
    body.set_tool(ball_tool<3>(0.01, {0.0, 0.0, half_m + 0.01 - depth_m}));
    const NewtonReport report = body.solve(state);
    EXPECT_TRUE(report.converged) << report.trouble;
  }
  return body.observe(state);
}

TEST(Symmetry, QuarterHalfAndFullAgree) {
  const Observation quarter = press(true, true, 0.5), half = press(true, false, 0.5), full = press(false, false, 0.5);
  ASSERT_GT(full.force_n.z(), 10.0);
  for (const Observation& reduced : {quarter, half}) {
    EXPECT_NEAR(reduced.force_n.z() / full.force_n.z(), 1.0, 1e-7);
    EXPECT_NEAR(reduced.support_force_n.z() / full.support_force_n.z(), 1.0, 1e-7);
    EXPECT_NEAR(reduced.area_m2 / full.area_m2, 1.0, 1e-6);
    EXPECT_LT((reduced.half_axes_m() - full.half_axes_m()).norm(), 1e-6 * full.half_axes_m()[0]);
    EXPECT_LT((reduced.torque_nm - full.torque_nm).norm(), 1e-9);
  }
  EXPECT_NEAR(full.half_axes_m()[1] / full.half_axes_m()[0], 1.0, 1e-6);
  EXPECT_LT(std::hypot(full.force_n.x(), full.force_n.y()), 1e-6);
}

}  // namespace
}  // namespace touchstone::reference
