// The step of the response model on responses that no solver computed.
#include "fast/response/response_step.h"

#include "support/press.h"
#include "support/synthetic_response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::fast {
namespace {

using ::testing::HasSubstr;

class ResponseStep : public ::testing::Test {
 protected:
  explicit ResponseStep(double C_m_per_n = 2e-5) : C_m_per_n_(C_m_per_n) {
    scene_.track = {{0.0, test::pressed(0.003, -0.006, -0.004)}, {1.0, test::pressed(0.003, 0.006, 0.004)}};
  }
  [[nodiscard]] ResponseModel model() const {
    return {scene_, surface_, test::synthetic_response(scene_, surface_, C_m_per_n_)};
  }
  double C_m_per_n_;
  scene::Scene scene_ = test::ball_on_cube();
  scene::Surface surface_ = scene::tessellate(*scene::body_shape(scene_.body), 1200);
};

TEST_F(ResponseStep, WithoutABodyItIsTheHalfSpace) {
  C_m_per_n_ = 0.0;
  const ResponseModel model = this->model();
  ResponseState state(model);
  for (const double depth_m : {0.0005, 0.002, 0.005}) {
    EXPECT_EQ(response_step(model, test::pressed(depth_m), state), StepStatus::ok);
    const LocalContact law = model.tips[0].tables.front().at(depth_m);
    EXPECT_NEAR(state.contacts[0].indentation_m, depth_m, 1e-15);
    EXPECT_NEAR(state.wrench.force_n.z(), law.force_n, 1e-12 * law.force_n);
    EXPECT_NEAR(state.wrench.force_n.head<2>().norm(), 0.0, 1e-9);
    EXPECT_NEAR(state.wrench.torque_nm.norm(), 0.0, 1e-12);
    EXPECT_NEAR(state.energy_j, model.tips[0].tables.front().energy_j(depth_m), 1e-12);
  }
}

TEST_F(ResponseStep, IndentationAndTheBodyAreInSeries) {
  const ResponseModel model = this->model();
  ResponseState state(model);
  const double depth_m = 0.004, x_m = 0.003;
  (void)response_step(model, test::pressed(depth_m, x_m), state);
  const double F = state.contacts[0].load.force_n, moved_m = state.contacts[0].load.center_m.x() - x_m,
               moved_y_m = state.contacts[0].load.center_m.y(), x = x_m + moved_m;
  const double C = 2e-5 * (1.0 + 40.0 * x + 900.0 * x * x - 15.0 * moved_y_m);
  EXPECT_NEAR(state.contacts[0].indentation_m + C * F, depth_m, 1e-9);
  EXPECT_NEAR(model.tips[0].tables.front().at(state.contacts[0].indentation_m).force_n, F, 1e-9 * F);
  // The load moves towards where the surface rises, and against its sway.
  EXPECT_NEAR(moved_m, F * 2e-5 * (0.010 * -60.0 - 0.3), 1e-9);
  EXPECT_NEAR(moved_y_m, F * 2e-5 * (0.010 * 25.0 + 0.2), 1e-9);
}

TEST_F(ResponseStep, FarAwayTheShapeIsTheHalfSpacesAndTheColumns) {
  scene_.track = {{0.0, test::pressed(0.003)}, {1.0, test::pressed(0.004)}};
  const ResponseModel model = this->model();
  ResponseState state(model);
  (void)response_step(model, test::pressed(0.002, 0.002, 0.001), state);
  const ResponseContact& contact = state.contacts[0];
  const SpreadLoad& load = contact.load;
  const scene::LoadGrid& grid = model.response.grid;
  // The columns where the tool is: the load's place at rest has swayed.
  const scene::GridWeights weights(grid, grid.place(load.center_m + load.force_n * contact.sway_m_per_n));
  const scene::GridWeights linear =
      scene::GridWeights::linear(grid, grid.place(load.center_m + load.force_n * contact.sway_m_per_n));
  // The pressure leans.
  const Eigen::Vector2d along_n = grid.along(grid.middle()).transpose() * load.ball_shear_n;
  EXPECT_GT(along_n.norm(), 1e-3 * load.force_n);
  EXPECT_LT((load.ball_shear_n + state.wrench.force_n - load.force_n * load.normal).norm(), 1e-9 * load.force_n);
  ASSERT_NE(weights.count % 4, 0) << "the columns that are added one by one are tested, too";
  int compared = 0;
  for (Eigen::Index i = 0; i < surface_.points_m.cols(); ++i) {
    const scene::Vec3 x_m = surface_.points_m.col(i);
    if (model.free[static_cast<std::size_t>(i)] == 0.0f || (x_m - load.center_m).norm() < 0.02) continue;
    scene::Vec3 expected_m = spread_displacement_m(load, model.half_space, x_m);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto column = [&](Eigen::Index k) {
        return static_cast<double>(model.response.smooth_m_per_n(axis * surface_.points_m.cols() + i, k));
      };
      for (int side = 0; side < 2; ++side) {
        expected_m[axis] += along_n[side] * column(model.response.along(grid.middle(), side));
      }
      expected_m[axis] += weights.sum<double>([&](int k) { return load.force_n * column(k); });
      expected_m[axis] += model.half_space.double_force_nm(load.apart_m3()) *
                          linear.sum<double>([&](int k) { return column(model.response.apart(k)); });
    }
    const auto k = static_cast<std::size_t>(i);
    const scene::Vec3 found_m(state.field.displacement_m[0][k], state.field.displacement_m[1][k],
                              state.field.displacement_m[2][k]);
    EXPECT_LT((found_m - expected_m).norm(), 1e-3 * expected_m.norm()) << x_m.transpose();
    ++compared;
  }
  EXPECT_GT(compared, 300);
}

TEST_F(ResponseStep, ForceAndLateralForceHaveOnePotential) {
  for (const auto& [radius_m, falloff_per_m] : {std::pair{0.010, 0.0}, {0.006, 0.0}, {0.010, 250.0}, {0.006, 400.0}}) {
    for (scene::Waypoint& waypoint : scene_.track) waypoint.pose.position_m.z() += radius_m - scene_.tool.radius_m;
    scene_.tool.radius_m = radius_m;
    scene_.fast.body_falloff_per_m = falloff_per_m;
    const ResponseModel model = this->model();
    ResponseState state(model);
    const auto energy_j = [&](const scene::Vec3& center_m) {
      scene::Pose pose;
      pose.position_m = center_m;
      (void)response_force(model, pose, state);
      return state.energy_j;
    };
    for (const double depth_m : {0.0008, 0.003, 0.0055}) {
      const scene::Vec3 center_m(0.002, -0.001, 0.06 + radius_m - depth_m);
      for (int axis = 0; axis < 3; ++axis) {
        const scene::Vec3 e_m = 2e-6 * scene::Vec3::Unit(axis);
        const double slope_n = (energy_j(center_m + e_m) - energy_j(center_m - e_m)) / 4e-6;
        (void)energy_j(center_m);
        EXPECT_NEAR(-slope_n, state.wrench.force_n[axis], 2e-5 * state.wrench.force_n.norm()) << axis << ' ' << depth_m;
      }
      EXPECT_GT(std::abs(state.wrench.force_n.x()), 1e-4 * state.wrench.force_n.z());
      // Without friction nothing turns a ball about its centre.
      EXPECT_NEAR(state.wrench.torque_nm.norm(), 0.0, 1e-12);
    }
  }
}

TEST_F(ResponseStep, TheBodysComplianceFallsOffWithTheContactsRadius) {
  const ResponseModel plain = this->model();
  constexpr double falloff_per_m = 250.0;
  scene_.fast.body_falloff_per_m = falloff_per_m;
  const ResponseModel model = this->model();
  ResponseState state(model), as_it_was(plain);
  double last_n = 0.0;
  for (const double depth_m : {1e-6, 0.0005, 0.001, 0.002, 0.003, 0.004, 0.005, 0.006}) {
    (void)response_force(plain, test::pressed(depth_m), as_it_was);
    (void)response_force(model, test::pressed(depth_m), state);
    const ResponseContact& contact = state.contacts[0];
    const double F = contact.law.force_n, a = falloff_per_m * 0.75 * F * 0.75 / 3.0e6 / contact.indentation_m;
    const double C = 2e-5 * (1.0 + F * contact.shift_m_per_n.dot(scene::Vec3(40.0, -15.0, 0.0)) +
                             900.0 * std::pow(F * contact.shift_m_per_n.x(), 2));
    EXPECT_NEAR(contact.indentation_m + C / std::sqrt(1.0 + std::pow(a, 4)) * F, depth_m, 1e-6 * depth_m);
    EXPECT_GT(F, last_n);
    last_n = F;
    const double over = F / as_it_was.contacts[0].law.force_n - 1.0;
    if (depth_m < 1e-5) {
      EXPECT_LT(std::abs(over), 1e-6) << "the linear limit is the same";
    } else {
      EXPECT_GT(over, 0.0);
    }
  }
  EXPECT_GT(last_n, 1.1 * as_it_was.contacts[0].law.force_n);
}

TEST_F(ResponseStep, PointsUnderTheToolLieOnIt) {
  surface_ = scene::tessellate(*scene::body_shape(scene_.body), 12000);
  const ResponseModel model = this->model();
  ResponseState state(model);
  const scene::Pose pose = test::pressed(0.004, 0.001);
  (void)response_step(model, pose, state);
  int on_tool = 0;
  for (Eigen::Index i = 0; i < surface_.points_m.cols(); ++i) {
    scene::Vec3 moved_m = surface_.points_m.col(i);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      moved_m[axis] += state.field.displacement_m[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)];
    }
    const double out_m = (moved_m - pose.position_m).norm() - 0.010;
    EXPECT_GT(out_m, -5e-4);
    on_tool += std::abs(out_m) < 1e-7 ? 1 : 0;
    if (surface_.points_m(2, i) == 0.0) {
      EXPECT_EQ(moved_m, surface_.points_m.col(i));
    }
  }
  EXPECT_GT(on_tool, 20);
}

/// A capsule of 6 mm on its side, turned by some angle about the surface's normal.
class ResponseLine : public ResponseStep {
 protected:
  ResponseLine() {
    scene_.tool.shape = scene::ToolShape::capsule;
    scene_.tool.radius_m = R_m;
    scene_.tool.length_m = 2.0 * half_m;
    scene_.track = {{0.0, lying(0.001, 0.0)}, {1.0, lying(0.003, 0.0)}};
    surface_ = scene::tessellate(*scene::body_shape(scene_.body), 16000);
  }
  static scene::Pose lying(double depth_m, double x_m) {
    scene::Pose pose = test::at(x_m, 0.0, 0.06 + R_m - depth_m);
    pose.orientation =
        Eigen::AngleAxisd(0.4, scene::Vec3::UnitZ()) * Eigen::AngleAxisd(0.5 * std::numbers::pi, scene::Vec3::UnitX());
    return pose;
  }
  static constexpr double R_m = 0.006, half_m = 0.008;
};

TEST_F(ResponseLine, PressesAsTheHalfSpaceAndPointsLieOnIt) {
  C_m_per_n_ = 0.0;
  const ResponseModel model = this->model();
  ASSERT_TRUE(model.tips[0].tip.line());
  ResponseState state(model);
  const double depth_m = 0.002, x_m = 0.001;
  const scene::Pose pose = lying(depth_m, x_m);
  EXPECT_EQ(response_step(model, pose, state), StepStatus::ok);
  const LocalContact law = model.tips[0].tables.front().at(depth_m);
  EXPECT_NEAR(state.wrench.force_n.z(), law.force_n, 1e-12 * law.force_n);
  EXPECT_NEAR(state.wrench.torque_nm.norm(), 0.0, 1e-12);
  const scene::Vec3 along = pose.orientation * scene::Vec3::UnitZ();
  EXPECT_NEAR(std::abs(state.contacts[0].half_line_m.normalized().dot(along)), 1.0, 1e-12);
  // Its patches have the load's second moment along the line.
  double moment_m2 = 0.0;
  const int n = model.tips[0].patches;
  for (int k = 0; k < n; ++k) {
    const double at_m = (2.0 * k / (n - 1) - 1.0) * state.contacts[0].half_line_m.norm();
    moment_m2 += at_m * at_m / n;
  }
  EXPECT_NEAR(moment_m2, law.half_line_m * law.half_line_m / 3.0, 1e-9 * moment_m2);
  int on_tool = 0;
  double furthest_m = 0.0;
  for (Eigen::Index i = 0; i < surface_.points_m.cols(); ++i) {
    scene::Vec3 moved_m = surface_.points_m.col(i);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      moved_m[axis] += state.field.displacement_m[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)];
    }
    const scene::Vec3 d_m = moved_m - pose.position_m;
    const double along_m = d_m.dot(along), out_m = (d_m - std::clamp(along_m, -half_m, half_m) * along).norm() - R_m;
    EXPECT_GT(out_m, -3e-4);
    if (std::abs(out_m) > 1e-7) continue;
    ++on_tool;
    furthest_m = std::max(furthest_m, std::abs(along_m));
  }
  EXPECT_GT(on_tool, 40);
  EXPECT_NEAR(furthest_m, half_m + law.radius_m, 0.001);
}

TEST_F(ResponseLine, FarAwayItIsAPointLoadAndEqualPosesGiveEqualBits) {
  C_m_per_n_ = 0.0;
  const ResponseModel model = this->model();
  ResponseState once(model), again(model);
  (void)response_step(model, lying(0.002, 0.0), once);
  (void)response_step(model, lying(0.003, 0.002), again);
  (void)response_step(model, lying(0.002, 0.0), again);
  EXPECT_EQ(once.wrench.force_n, again.wrench.force_n);
  EXPECT_EQ(once.field.displacement_m, again.field.displacement_m);
  SpreadLoad point = once.contacts[0].load;
  EXPECT_NEAR(point.force_n, once.wrench.force_n.z(), 1e-12 * point.force_n);
  int far = 0;
  for (Eigen::Index i = 0; i < surface_.points_m.cols(); ++i) {
    const scene::Vec3 p_m = surface_.points_m.col(i);
    if ((p_m - point.center_m).norm() < 5.0 * half_m || p_m.z() == 0.0) continue;
    scene::Vec3 u_m;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      u_m[axis] = once.field.displacement_m[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)];
    }
    const scene::Vec3 expected_m = spread_displacement_m(point, model.half_space, p_m);
    EXPECT_LT((u_m - expected_m).norm(), 0.05 * expected_m.norm());
    ++far;
  }
  EXPECT_GT(far, 100);
}

TEST_F(ResponseLine, TheBodyIsInSeriesAndTakesTheLoadOverTheLine) {
  const ResponseModel model = this->model();
  ResponseState state(model);
  (void)response_step(model, lying(0.002, 0.0), state);
  const ResponseContact& contact = state.contacts[0];
  EXPECT_NEAR(contact.indentation_m + contact.compliance_m_per_n * contact.load.force_n, 0.002, 1e-9);
  EXPECT_GT(contact.compliance_m_per_n * contact.load.force_n, 1e-4);
  // The columns at the patches' places, each with its share; all shares together are one.
  EXPECT_NEAR(state.column_weight.sum(), 1.0, 1e-12);
  const scene::LoadGrid& grid = model.response.grid;
  const scene::Vec3 along = contact.half_line_m.normalized(), middle_m = grid.points_m * state.column_weight;
  const scene::Vec3 tool_m = contact.load.center_m + contact.load.force_n * contact.sway_m_per_n;
  EXPECT_LT((middle_m - tool_m).norm(), 1e-6);
  const Eigen::VectorXd along_m = (grid.points_m.colwise() - tool_m).transpose() * along;
  const double spread_m2 = along_m.cwiseAbs2().dot(state.column_weight);
  EXPECT_NEAR(spread_m2, contact.law.half_line_m * contact.law.half_line_m / 3.0, 0.01 * spread_m2);
}

TEST_F(ResponseStep, EqualPosesGiveEqualBits) {
  const ResponseModel model = this->model();
  ResponseState once(model), again(model);
  (void)response_step(model, test::pressed(0.003, 0.002, 0.001), once);
  for (const double depth_m : {0.006, -0.001, 0.001}) (void)response_step(model, test::pressed(depth_m), again);
  (void)response_step(model, test::pressed(0.003, 0.002, 0.001), again);
  EXPECT_EQ(once.wrench.force_n, again.wrench.force_n);
  EXPECT_EQ(once.wrench.torque_nm, again.wrench.torque_nm);
  EXPECT_EQ(once.field.displacement_m, again.field.displacement_m);
}

class ResponseFriction : public ResponseStep {
 protected:
  ResponseFriction() { scene_.contact.friction = scene::Friction{.K = mu, .beta = 1.0, .mu_D = mu}; }
  static constexpr double mu = 0.4;
};

TEST_F(ResponseFriction, DragsTheSurfaceAlongUpToTheLimit) {
  const ResponseModel model = this->model();
  ResponseState state(model);
  (void)response_step(model, test::pressed(0.003, -0.004), state);
  scene::Vec3 last_n = state.contacts[0].friction_n;
  const double step_m = 2e-5;
  int stuck = 0;
  for (int i = 1; i <= 400; ++i) {
    (void)response_step(model, test::pressed(0.003, -0.004 + i * step_m), state);
    // It grows smoothly, at most as the stuck contact's stiffness allows.
    const double stiffness = model.springs->shear_ratio() * model.tips[0].tables.front().at(0.003).stiffness_n_per_m;
    EXPECT_LT((state.contacts[0].friction_n - last_n).norm(), stiffness * step_m) << i;
    last_n = state.contacts[0].friction_n;
    stuck += state.slip->sliding ? 0 : 1;
  }
  EXPECT_GT(stuck, 20);
  EXPECT_LT(stuck, 300);
  const double F = state.contacts[0].load.force_n;
  EXPECT_LT(state.contacts[0].friction_n.x(), 0.0);
  EXPECT_NEAR(state.contacts[0].friction_n.norm(), mu * F, 1e-6 * F);
  EXPECT_NEAR(state.contacts[0].load.shear_n().x(), mu * F, 1e-6 * F);
  // The point of the surface that it loads is behind the tool by the body's and the contact's displacement.
  const double x_m = 0.004, C_t = 1.5 * 2e-5 * (1.0 + 40.0 * x_m + 900.0 * x_m * x_m);
  const double local_m = mu * state.contacts[0].indentation_m / model.springs->shear_ratio();
  EXPECT_NEAR(state.contacts[0].stretch_m.x(), C_t * mu * F + local_m, 0.03 * (C_t * mu * F + local_m));
  // At the height of the pressure's mean, below the ball's centre.
  const double arm_m = -state.wrench.torque_nm.y() / (mu * F);
  EXPECT_GT(arm_m, -0.0098);
  EXPECT_LT(arm_m, -0.0090);
  // The shape follows: the middle of the patch moved along by as much.
  Eigen::Index nearest = 0;
  (model.surface.points_m.colwise() - state.contacts[0].load.center_m).colwise().norm().minCoeff(&nearest);
  EXPECT_NEAR(state.field.displacement_m[0][static_cast<std::size_t>(nearest)], state.contacts[0].stretch_m.x(),
              0.3 * state.contacts[0].stretch_m.x());
}

TEST_F(ResponseFriction, TheForcesTurnAsTheSurfaceThatFrictionMovesUnderTheBall) {
  C_m_per_n_ = 0.0;
  constexpr double R_m = 0.010, body_m = 0.030, depth_m = 0.002;
  for (const bool round : {false, true}) {
    if (round) {
      scene_.body.shape = scene::BodyShape::sphere;
      scene_.body.radius_m = body_m;
      scene_.body.support_height_m = 0.005;
      surface_ = scene::tessellate(*scene::body_shape(scene_.body), 1200);
    }
    const ResponseModel model = this->model();
    ResponseState state(model);
    for (int i = 0; i <= 100; ++i) (void)response_force(model, test::pressed(depth_m, 2e-5 * (i - 100)), state);
    const ResponseContact& contact = state.contacts[0];
    const scene::Vec3 normal_n = state.wrench.force_n - contact.friction_n;
    const double moved_m = contact.stretch_m.x();
    EXPECT_GT(moved_m, 3e-4);
    EXPECT_NEAR(contact.friction_n.dot(normal_n), 0.0, 1e-9 * normal_n.squaredNorm());
    const double turned = 0.085 * moved_m / R_m + (round ? moved_m / (body_m + R_m - depth_m) : 0.0);
    EXPECT_NEAR(-normal_n.x() / normal_n.z(), turned, 0.02 * turned) << round;
    // The pressure acts through the ball's centre, which is the tool's.
    EXPECT_LT(std::abs(state.wrench.torque_nm.dot(contact.friction_n)), 1e-9);
    EXPECT_GT(state.wrench.torque_nm.norm(), 0.9 * contact.friction_n.norm() * (R_m - depth_m));
  }
}

TEST_F(ResponseFriction, WithoutACoefficientItIsTheFrictionlessContact) {
  const double bodies = C_m_per_n_;
  scene_.contact.friction->K = 0.0;
  const ResponseModel model = this->model();
  scene_.contact.friction.reset();
  const ResponseModel frictionless(scene_, surface_, test::synthetic_response(scene_, surface_, bodies));
  ResponseState state(model), other(frictionless);
  for (int i = 0; i < 20; ++i) {
    const scene::Pose pose = test::pressed(0.001 + 1e-4 * i, 0.0002 * i);
    (void)response_step(model, pose, state);
    (void)response_step(frictionless, pose, other);
    EXPECT_EQ(state.wrench.force_n, other.wrench.force_n);
    EXPECT_EQ(state.contacts[0].load.center_m, other.contacts[0].load.center_m);
    // The shape has the columns for the pressure's part along the surface, too.
    const Eigen::Matrix3Xd shape_m = matrix_of(state.field.displacement_m);
    EXPECT_LT((shape_m - matrix_of(other.field.displacement_m)).norm(), 0.05 * shape_m.norm());
  }
}

TEST_F(ResponseFriction, ARollingBallDoesNotRub) {
  C_m_per_n_ = 0.0;
  const ResponseModel model = this->model();
  ResponseState state(model);
  for (const double rolls : {1.0, 0.0}) {
    (void)response_step(model, test::pressed(-0.001), state);
    double largest = 0.0;
    for (int i = 0; i <= 100; ++i) {
      scene::Pose pose = test::pressed(0.001, 1e-5 * i);
      pose.orientation = Eigen::AngleAxisd(rolls * 1e-5 * i / 0.0098, scene::Vec3::UnitY());
      (void)response_step(model, pose, state);
      largest = std::max(largest, state.contacts[0].friction_n.norm() / state.contacts[0].load.force_n);
    }
    if (rolls == 1.0) {
      EXPECT_LT(largest, 0.1 * mu);
    } else {
      EXPECT_GT(largest, 0.9 * mu);
    }
  }
}

TEST_F(ResponseFriction, ForgetsWhenItLeaves) {
  const ResponseModel model = this->model();
  ResponseState once(model), again(model);
  for (int i = 0; i < 50; ++i) (void)response_step(model, test::pressed(0.002, 1e-4 * i), again);
  EXPECT_GT(again.contacts[0].friction_n.norm(), 1.0);
  (void)response_step(model, test::pressed(-0.001), again);
  EXPECT_EQ(again.wrench.force_n, scene::Vec3::Zero());
  for (ResponseState* state : {&once, &again}) {
    for (int i = 0; i < 10; ++i) (void)response_step(model, test::pressed(2e-4 * i, 0.002, 1e-4 * i), *state);
  }
  EXPECT_EQ(once.wrench.force_n, again.wrench.force_n);
  EXPECT_EQ(once.wrench.torque_nm, again.wrench.torque_nm);
  EXPECT_EQ(once.field.displacement_m, again.field.displacement_m);
}

TEST_F(ResponseFriction, AClosedPathGivesNoEnergy) {
  // Along the surface and into it with a lag, so that the path is a loop in both.
  const ResponseModel model = this->model();
  for (const double lag : {0.0, 1.5707963, -1.5707963, 0.7}) {
    for (const double size_m : {5e-5, 5e-4, 3e-3}) {
      ResponseState state(model);
      double work_j = 0.0, scale_j = 0.0;
      scene::Vec3 last_m, last_n = scene::Vec3::Zero();
      const int steps = 3000;
      for (int i = 0; i <= 2 * steps; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / steps;
        const scene::Pose pose = test::pressed(0.002 + 0.5e-3 * std::sin(angle + lag), size_m * std::sin(angle),
                                               0.3 * size_m * std::sin(angle + 1.0));
        (void)response_force(model, pose, state);
        if (i > steps) {
          const double part_j = -0.5 * (state.wrench.force_n + last_n).dot(pose.position_m - last_m);
          work_j += part_j;
          scale_j += std::abs(part_j);
        }
        last_m = pose.position_m;
        last_n = state.wrench.force_n;
      }
      EXPECT_GT(work_j, -1e-4 * scale_j) << lag << ' ' << size_m;
      if (size_m == 3e-3) {
        EXPECT_GT(work_j, 0.1 * scale_j) << lag;
      }
    }
  }
}

TEST_F(ResponseStep, SaysWhenItDoesNotHold) {
  const ResponseModel model = this->model();
  ResponseState state(model);
  (void)response_step(model, test::pressed(0.003), state);
  const scene::Vec3 force_n = state.wrench.force_n;
  const Columns3 shape_m = state.field.displacement_m;
  EXPECT_EQ(response_step(model, test::at(0.0, std::numeric_limits<double>::quiet_NaN(), 0.06), state),
            StepStatus::not_finite);
  EXPECT_EQ(state.wrench.force_n, force_n);
  EXPECT_EQ(state.field.displacement_m, shape_m);
  EXPECT_EQ(response_step(model, test::pressed(0.003, 0.02), state), StepStatus::outside_grid);
  EXPECT_EQ(response_step(model, test::pressed(0.011), state), StepStatus::tip_exceeded | StepStatus::depth_unchecked);
  EXPECT_EQ(response_step(model, test::pressed(-0.001), state), StepStatus::ok);
  EXPECT_EQ(state.wrench.force_n, scene::Vec3::Zero());
  for (const std::vector<float>& column : state.field.displacement_m) {
    for (const float u_m : column) EXPECT_EQ(u_m, 0.0f);
  }
}

TEST_F(ResponseStep, SaysWhatItNeeds) {
  EXPECT_EQ(scene::response_needs(scene_), "");
  scene::Scene other = scene_;
  other.tool.shape = scene::ToolShape::box;
  other.tool.size_m = scene::Vec3(0.02, 0.02, 0.02);
  EXPECT_THAT(scene::response_needs(other), HasSubstr("its tool is a ball"));
  other = scene_;
  other.tool.shape = scene::ToolShape::cylinder;
  other.tool.length_m = 0.02;
  other.tool.edge_radius_m = 0.002;
  for (scene::Waypoint& waypoint : other.track) {
    waypoint.pose.orientation = Eigen::AngleAxisd(0.1, scene::Vec3::UnitX());
  }
  EXPECT_THAT(scene::response_needs(other), HasSubstr("upright"));
}

}  // namespace
}  // namespace touchstone::fast
