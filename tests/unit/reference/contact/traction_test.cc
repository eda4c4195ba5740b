// The traction on the surface carries the contact force and its torque.
#include "reference/contact/traction.h"

#include "reference/contact/contact_problem.h"
#include "reference/mesh/mesh.h"
#include "reference/tool/tool_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

constexpr double side_m = 0.02, depth_m = 0.001, radius_m = 0.01;

/// A ball beside the middle of a block's top, moved a little along it.
TEST(ContactTraction, SumsToForceAndTorque) {
  const Discretisation<3> mesh =
      block_mesh({{0.0, 0.0, 0.0}, {side_m, side_m, side_m}, false, false, {{}, 0.5, 0.005}});
  ContactProblem<3> problem(mesh, {3e6, 0.3}, scene::Kinematics::finite, false, false, 1);
  problem.set_friction({.K = 0.2, .beta = 1.0, .mu_D = 0.2}, 0.004);
  State<3> state = problem.rest();
  const scene::Vec3 above_m(0.011, 0.009, side_m + radius_m + 1e-4);
  problem.note_places(ball_tool<3>(radius_m, above_m), state);
  scene::Vec3 middle_m;
  for (int step = 1; step <= 3; ++step) {
    middle_m = scene::Vec3(0.011 + 1e-4 * step, 0.009, side_m + radius_m - depth_m * step / 3.0);
    problem.set_tool(ball_tool<3>(radius_m, middle_m));
    ASSERT_TRUE(problem.solve(state).converged);
  }
  const ContactTraction<3> traction = problem.contact_traction(state);
  // The deformed block as a mesh of its own.
  const Discretisation<3> deformed = mesh.moved([&](const Eigen::Vector3d& x_m) {
    for (int node = 0; node < mesh.node_count(); ++node) {
      if (mesh.points_m.col(node) == x_m) return Eigen::Vector3d(x_m + state.u_m.col(node));
    }
    return x_m;
  });
  const auto geometry = deformed.face_geometry();
  scene::Vec3 force_n = scene::Vec3::Zero(), torque_nm = scene::Vec3::Zero();
  double largest_pa = 0.0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int a = 0; a < 9; ++a) {
      const int node = mesh.faces[f].nodes[a];
      const scene::Vec3 on_tool_n = -geometry[f].weight[a] * traction.nodal_pa.col(node);
      force_n += on_tool_n;
      torque_nm += (deformed.points_m.col(node) - middle_m).cross(on_tool_n);
      largest_pa = std::max(largest_pa, traction.nodal_pa.col(node).norm());
      const bool may_push = state.touching[node] != 0 || mesh.hangs(node);
      EXPECT_TRUE(may_push || traction.nodal_pa.col(node).isZero(0.0));
    }
  }
  const Observation seen = problem.observe(state, 0.004);
  EXPECT_GT(seen.force_n.z(), 0.1);
  EXPECT_GT(std::abs(seen.force_n.x()), 0.01 * seen.force_n.z());
  EXPECT_LT((force_n - seen.force_n).norm(), 1e-9 * seen.force_n.norm());
  EXPECT_LT((torque_nm - seen.torque_nm).norm(), 1e-9 * radius_m * seen.force_n.norm());
  EXPECT_GT(traction.pressure_peak_pa, 0.9 * largest_pa);
  EXPECT_LE(traction.pressure_peak_pa, largest_pa);
}

TEST(ContactTraction, IsZeroAtRest) {
  const Discretisation<3> mesh =
      block_mesh({{0.0, 0.0, 0.0}, {side_m, side_m, side_m}, false, false, {{}, 0.5, 0.005}});
  const ContactProblem<3> problem(mesh, {3e6, 0.3}, scene::Kinematics::finite, false, false, 1);
  const ContactTraction<3> traction = problem.contact_traction(problem.rest());
  EXPECT_TRUE(traction.nodal_pa.isZero(0.0));
  EXPECT_EQ(traction.pressure_peak_pa, 0.0);
}

}  // namespace
}  // namespace touchstone::reference
