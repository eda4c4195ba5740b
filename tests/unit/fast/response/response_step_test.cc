// The step of the response model on responses that no solver computed.
#include "fast/response/response_step.h"

#include "fast/response/grid_weights.h"
#include "support/press.h"
#include "support/synthetic_response.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
    const LocalContact law = model.tables.front().at(depth_m);
    EXPECT_NEAR(state.contact.indentation_m, depth_m, 1e-15);
    EXPECT_NEAR(state.wrench.force_n.z(), law.force_n, 1e-12 * law.force_n);
    EXPECT_NEAR(state.wrench.force_n.head<2>().norm(), 0.0, 1e-9);
    EXPECT_NEAR(state.wrench.torque_nm.norm(), 0.0, 1e-12);
    EXPECT_NEAR(state.contact.energy_j, model.tables.front().energy_j(depth_m), 1e-12);
  }
}

TEST_F(ResponseStep, IndentationAndTheBodyAreInSeries) {
  const ResponseModel model = this->model();
  ResponseState state(model);
  const double depth_m = 0.004, x_m = 0.003;
  (void)response_step(model, test::pressed(depth_m, x_m), state);
  const double F = state.contact.load.force_n, moved_m = state.contact.load.center_m.x() - x_m,
               moved_y_m = state.contact.load.center_m.y(), x = x_m + moved_m;
  const double C = 2e-5 * (1.0 + 40.0 * x + 900.0 * x * x - 15.0 * moved_y_m);
  EXPECT_NEAR(state.contact.indentation_m + C * F, depth_m, 1e-9);
  EXPECT_NEAR(model.tables.front().at(state.contact.indentation_m).force_n, F, 1e-9 * F);
  // The load moves towards where the surface rises, and against its sway.
  EXPECT_NEAR(moved_m, F * 2e-5 * (0.010 * -60.0 - 0.3), 1e-9);
  EXPECT_NEAR(moved_y_m, F * 2e-5 * (0.010 * 25.0 + 0.2), 1e-9);
}

TEST_F(ResponseStep, ForceAndLateralForceHaveOnePotential) {
  for (const double radius_m : {0.010, 0.006}) {
    for (scene::Waypoint& waypoint : scene_.track) waypoint.pose.position_m.z() += radius_m - scene_.tool.radius_m;
    scene_.tool.radius_m = radius_m;
    const ResponseModel model = this->model();
    ResponseState state(model);
    const auto energy_j = [&](const scene::Vec3& center_m) {
      scene::Pose pose;
      pose.position_m = center_m;
      (void)response_force(model, pose, state);
      return state.contact.energy_j;
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
  EXPECT_EQ(response_step(model, test::pressed(0.011), state), StepStatus::tip_exceeded);
  EXPECT_EQ(response_step(model, test::pressed(-0.001), state), StepStatus::ok);
  EXPECT_EQ(state.wrench.force_n, scene::Vec3::Zero());
  for (const std::vector<float>& column : state.field.displacement_m) {
    for (const float u_m : column) EXPECT_EQ(u_m, 0.0f);
  }
}

TEST_F(ResponseStep, SaysWhatItNeeds) {
  EXPECT_EQ(scene::response_needs(scene_), "");
  scene::Scene other = scene_;
  other.tool.shape = scene::ToolShape::mesh;
  EXPECT_THAT(scene::response_needs(other), HasSubstr("one contact region"));
  other = scene_;
  other.tool.shape = scene::ToolShape::capsule;
  other.tool.length_m = 0.02;
  for (scene::Waypoint& waypoint : other.track) {
    waypoint.pose.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, scene::Vec3::UnitX());
  }
  EXPECT_THAT(scene::response_needs(other), HasSubstr("upright"));
}

TEST(GridWeights, AreExactForQuadraticsAndSmooth) {
  for (const int count : {3, 4, 7}) {
    const auto value = [](double x) { return 3.0 - 2.0 * x + 0.7 * x * x; };
    double last = 0.0, last_slope = 0.0;
    for (int k = 0; k <= 100 * (count - 1); ++k) {
      const double x = 0.01 * k;
      const LineWeights line(x, count);
      double sum = 0.0, cubic = 0.0;
      for (int i = 0; i < 4 && line.first + i < count; ++i) {
        const double at = line.first + i;
        sum += line.weight[static_cast<std::size_t>(i)] * value(at);
        cubic += line.weight[static_cast<std::size_t>(i)] * std::sin(at);
      }
      EXPECT_NEAR(sum, value(x), 1e-12) << count << ' ' << x;
      const double slope = cubic - last;
      if (k > 1) {
        EXPECT_NEAR(slope, last_slope, 5e-4) << count << ' ' << x;
      }
      last = cubic;
      last_slope = slope;
    }
  }
  // Outside it is the nearest place.
  EXPECT_EQ(LineWeights(-5.0, 3).weight, LineWeights(0.0, 3).weight);
  EXPECT_EQ(LineWeights(9.0, 5).weight, LineWeights(4.0, 5).weight);
}

}  // namespace
}  // namespace touchstone::fast
