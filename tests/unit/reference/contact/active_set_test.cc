// The active set alone: a ball over the top of a block, without a solve.
#include "reference/contact/active_set.h"

#include "reference/contact/contact_model.h"
#include "reference/mesh/mesh.h"
#include "reference/tool/tool_distance.h"

#include <gtest/gtest.h>

namespace touchstone::reference {
namespace {

class ActiveSetTest : public testing::Test {
 protected:
  ActiveSetTest()
      : mesh_(block_mesh({{0.0, 0.0, 0.0}, {0.02, 0.02, 0.02}, true, true, {{}, 0.5, 0.005}})),
        model_(mesh_, {3e6, 0.3}, scene::Kinematics::finite, true, true) {
    model_.tool = ball_tool<3>(0.01, {0.0, 0.0, 0.02 + 0.01 - 0.001});
    state_.u_m = Eigen::Matrix3Xd::Zero(3, mesh_.node_count());
    state_.touching.assign(static_cast<std::size_t>(mesh_.node_count()), 0);
  }
  Discretisation<3> mesh_;
  ContactModel<3> model_;
  State<3> state_;
};

TEST_F(ActiveSetTest, ModelKnowsTheSurface) {
  double area_m2 = 0.0;
  for (const double one_m2 : model_.area_m2) area_m2 += one_m2;
  EXPECT_NEAR(area_m2, 3 * 0.02 * 0.02, 1e-12);  // two sides and the top
  for (const int node : model_.nodes) {
    EXPECT_NEAR(model_.normal.col(node).norm(), 1.0, 1e-14);
    EXPECT_GT(model_.area_m2[node], 0.0);
  }
}

/// In reach of the ball nodes become active; they stay so while they are pushed, and leave when they are pulled.
TEST_F(ActiveSetTest, FollowsGapsAndForces) {
  ActiveSet<3> active_set(model_, 1.0);
  Eigen::Matrix3Xd forces_n = Eigen::Matrix3Xd::Zero(3, mesh_.node_count());
  active_set.measure(state_, forces_n);
  bool changed = false;
  const double open_m = active_set.update(state_, false, changed);
  EXPECT_TRUE(changed);
  EXPECT_NEAR(open_m, 0.001, 1e-12);  // the ball's depth, on the axis
  int active = 0;
  for (const int node : model_.nodes) {
    EXPECT_EQ(state_.touching[node] != 0, model_.gap(state_, node).value_m < 0.0);
    active += state_.touching[node];
  }
  EXPECT_GE(active, 3);

  // Bring the active nodes to the ball's surface; the outer one is pulled.
  int outer = -1;
  for (const int node : model_.nodes) {
    if (!state_.touching[node]) continue;
    const Gap<3> gap = model_.gap(state_, node);
    state_.u_m.col(node) -= gap.value_m * gap.gradient / gap.gradient.squaredNorm();
    forces_n.col(node) = 2.0 * model_.gap(state_, node).gradient;
    if (mesh_.points_m(0, node) > 0.0 && mesh_.points_m(1, node) > 0.0) outer = node;
  }
  ASSERT_GE(outer, 0);
  forces_n.col(outer) *= -1.0;
  active_set.measure(state_, forces_n);
  EXPECT_NEAR(active_set.force_n(outer), -2.0, 1e-9);
  (void)active_set.update(state_, false, changed);
  EXPECT_TRUE(changed);
  EXPECT_FALSE(state_.touching[outer]);
  int after = 0;
  for (const int node : model_.nodes) after += state_.touching[node];
  EXPECT_EQ(after, active - 1);
}

/// The lines hold exactly the displacements that close the gap to first order.
TEST_F(ActiveSetTest, LinesCloseTheGap) {
  ActiveSet<3> active_set(model_, 1.0);
  active_set.measure(state_, state_.u_m);
  bool changed = false;
  (void)active_set.update(state_, false, changed);
  active_set.eliminate(state_, [](int) { return false; });
  ASSERT_FALSE(active_set.eliminated().empty());
  const auto lines = active_set.lines({});
  EXPECT_EQ(lines.size(), active_set.eliminated().size());
  for (const auto& line : lines) {
    const int node = line.dof / 3;
    Eigen::Vector3d du_m(2e-4, -3e-4, 1e-4);
    for (int i = 0; i < 3; ++i) {
      if (model_.is_prescribed(node, i)) du_m[i] = 0.0;
    }
    du_m[line.dof % 3] = line.offset_m;
    for (const auto& [dof, weight] : line.terms) du_m[line.dof % 3] += weight * du_m[dof % 3];
    const Gap<3>& gap = active_set.gap(node);
    EXPECT_NEAR(gap.gradient.dot(du_m), -gap.value_m, 1e-15);
  }
  // Where a node sticks all its free components have a place to go to.
  Eigen::Matrix3Xd stick_m = Eigen::Matrix3Xd::Constant(3, mesh_.node_count(), 1e-5);
  active_set.eliminate(state_, [](int) { return true; });
  for (const auto& line : active_set.lines(stick_m)) {
    EXPECT_EQ(line.offset_m, 1e-5);
    EXPECT_TRUE(line.terms.empty());
    EXPECT_FALSE(model_.is_prescribed(line.dof / 3, line.dof % 3));
  }
}

}  // namespace
}  // namespace touchstone::reference
