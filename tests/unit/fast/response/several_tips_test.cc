// Several contact regions of the response model, on responses that no solver computed.
#include "fast/response/response_engine.h"
#include "fast/response/response_step.h"
#include "fast/run/run.h"
#include "scene/base/files.h"
#include "scene/response/response_file.h"
#include "support/synthetic_response.h"
#include "support/temporary_folder.h"
#include "support/two_balls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;
using ::testing::HasSubstr;

class SeveralTips : public ::testing::Test {
 protected:
  [[nodiscard]] ResponseModel model(bool left_first = true, double C_m_per_n = 2e-5) const {
    const scene::Scene scene = test::two_balls_on_cube(left_first);
    return {scene, surface_, test::synthetic_response(scene, surface_, C_m_per_n)};
  }
  /// C of the synthetic response.
  static double C_m_per_n(const Vec3& p_m) {
    return 2e-5 * (1.0 + 40.0 * p_m.x() + 900.0 * p_m.x() * p_m.x() - 15.0 * p_m.y());
  }
  scene::Scene scene_ = test::two_balls_on_cube();
  scene::Surface surface_ = scene::tessellate(*scene::body_shape(scene_.body), scene_.fast.triangles);
  const std::array<scene::Pose, 4> poses_{test::both_pressed(0.002), test::both_pressed(0.0015, 0.001, -0.001, 0.04),
                                          test::both_pressed(0.0010, -0.002, 0.002, -0.02), test::both_pressed(1e-4)};
};

TEST_F(SeveralTips, EachIsInEquilibriumWithTheOthersLoads) {
  const ResponseModel model = this->model();
  ASSERT_EQ(model.tips.size(), 2u);
  ResponseState state(model);
  const scene::Material& material = scene_.body.material;
  for (const scene::Pose& pose : poses_) {
    EXPECT_EQ(response_step(model, pose, state), StepStatus::ok);
    for (std::size_t i = 0; i < 2; ++i) {
      const ResponseContact &one = state.contacts[i], &other = state.contacts[1 - i];
      ASSERT_TRUE(one.touches());
      // The half space's part is Boussinesq's.
      const double r_m = (one.at.point_m - other.at.point_m).norm();
      const double half_space = (1.0 - material.poissons_ratio * material.poissons_ratio) /
                                (std::numbers::pi * material.youngs_modulus_pa * r_m);
      double smooth = 0.0;
      for (int a = 0; a < one.weights.count; ++a) {
        for (int b = 0; b < other.weights.count; ++b) {
          const auto [k, w] = one.weights.terms[static_cast<std::size_t>(a)];
          const auto [l, v] = other.weights.terms[static_cast<std::size_t>(b)];
          smooth += w * v * model.cross_compliance(k, l);
        }
      }
      // The load of one place lowers all rest points of the top by its C; both directions' mean counts.
      EXPECT_NEAR(smooth, 0.5 * (C_m_per_n(one.at.point_m) + C_m_per_n(other.at.point_m)), 1e-6 * 2e-5);
      const LocalContact law = model.tips[i].tables.front().at(one.indentation_m);
      EXPECT_NEAR(law.force_n, one.load.force_n, 1e-14 * law.force_n);
      const double depth_m =
          one.indentation_m + one.compliance_m_per_n * one.load.force_n + (half_space + smooth) * other.load.force_n;
      EXPECT_NEAR(depth_m, one.depth_m, 4e-16 * (1.0 + one.depth_m / 1e-3)) << one.depth_m;
    }
    EXPECT_NEAR((state.wrench.force_n - state.contacts[0].wrench.force_n - state.contacts[1].wrench.force_n).norm(),
                0.0, 1e-12);
  }
}

TEST_F(SeveralTips, TheirOrderDoesNotMatter) {
  const ResponseModel model = this->model(), other = this->model(false);
  EXPECT_EQ(model.cross_compliance, model.cross_compliance.transpose());
  EXPECT_NEAR(model.tips[0].tip.radius_m, other.tips[1].tip.radius_m, 1e-12);
  ResponseState state(model), swapped(other), again(model);
  for (const scene::Pose& pose : poses_) {
    (void)response_step(model, pose, state);
    (void)response_step(other, pose, swapped);
    const double F = state.wrench.force_n.norm();
    EXPECT_NEAR((state.wrench.force_n - swapped.wrench.force_n).norm(), 0.0, 1e-10 * F);
    EXPECT_NEAR((state.wrench.torque_nm - swapped.wrench.torque_nm).norm(), 0.0, 1e-12 * F);
    const Eigen::Matrix3Xd shape_m = matrix_of(state.field.displacement_m);
    EXPECT_LT((shape_m - matrix_of(swapped.field.displacement_m)).cwiseAbs().maxCoeff(),
              1e-5 * shape_m.cwiseAbs().maxCoeff());
  }
  // Nor does which of them touched first.
  for (const double turn : {0.08, -0.08}) {
    (void)response_step(model, test::both_pressed(0.001, 0.0, 0.0, turn), again);
    EXPECT_EQ(again.contacts[0].touches() && again.contacts[1].touches(), false);
    (void)response_step(model, poses_.front(), state);
    (void)response_step(model, poses_.front(), again);
    EXPECT_EQ(state.wrench.force_n, again.wrench.force_n);
    EXPECT_EQ(state.wrench.torque_nm, again.wrench.torque_nm);
    EXPECT_EQ(state.field.displacement_m, again.field.displacement_m);
  }
}

TEST_F(SeveralTips, ForcesAndTorqueHaveOnePotential) {
  const ResponseModel model = this->model();
  ResponseState state(model);
  const auto energy_j = [&](const scene::Pose& pose) {
    (void)response_force(model, pose, state);
    return state.energy_j;
  };
  for (const scene::Pose& pose : {poses_[0], poses_[1], poses_[2]}) {
    (void)energy_j(pose);
    const scene::Wrench wrench = state.wrench;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 e = Vec3::Unit(axis);
      scene::Pose low = pose, high = pose;
      const double e_m = 2e-6;
      low.position_m -= e_m * e;
      high.position_m += e_m * e;
      EXPECT_NEAR(-(energy_j(high) - energy_j(low)) / (2.0 * e_m), wrench.force_n[axis], 3e-5 * wrench.force_n.norm())
          << axis;
      low = high = pose;
      const double angle = 2e-4;
      low.orientation = Eigen::AngleAxisd(-angle, e) * pose.orientation;
      high.orientation = Eigen::AngleAxisd(angle, e) * pose.orientation;
      EXPECT_NEAR(-(energy_j(high) - energy_j(low)) / (2.0 * angle), wrench.torque_nm[axis],
                  3e-5 * wrench.force_n.norm() * test::apart_m)
          << axis;
    }
    // By the slope that the body has there.
    EXPECT_GT(std::abs(state.contacts[0].wrench.force_n.x()), 1e-4 * wrench.force_n.norm());
  }
}

TEST_F(SeveralTips, OnAHalfSpaceTheyPullTowardsEachOther) {
  const ResponseModel model = this->model(true, 0.0);
  ResponseState state(model);
  (void)response_force(model, poses_.front(), state);
  const ResponseContact &left = state.contacts[0], &right = state.contacts[1];
  // Each slides down the dent of the other, whose slope is (1 - nu^2) F / (pi E r^2).
  const scene::Material& material = scene_.body.material;
  const double nu = material.poissons_ratio;
  const double r_m = (left.at.point_m - right.at.point_m).norm();
  const double slope_per_n = (1.0 - nu * nu) / (std::numbers::pi * material.youngs_modulus_pa * r_m * r_m);
  const double pull_n = slope_per_n * left.load.force_n * right.load.force_n;
  EXPECT_GT(pull_n, 1e-3);
  EXPECT_NEAR(left.wrench.force_n.x(), pull_n, 1e-6 * pull_n);
  EXPECT_NEAR(right.wrench.force_n.x(), -pull_n, 1e-6 * pull_n);
}

TEST_F(SeveralTips, OneThatIsApartChangesNothing) {
  const ResponseModel both = model();
  ResponseModel one = model();
  one.tips.pop_back();
  ResponseState state(both), alone(one);
  const scene::Pose left_only = test::both_pressed(-0.0002, 0.0, 0.0, -0.06);
  EXPECT_EQ(response_step(both, left_only, state), StepStatus::ok);
  (void)response_step(one, left_only, alone);
  ASSERT_TRUE(state.contacts[0].touches());
  EXPECT_FALSE(state.contacts[1].touches());
  EXPECT_EQ(state.wrench.force_n, alone.wrench.force_n);
  EXPECT_EQ(state.wrench.torque_nm, alone.wrench.torque_nm);
  EXPECT_EQ(state.energy_j, alone.energy_j);
  EXPECT_EQ(state.field.displacement_m, alone.field.displacement_m);
  // Nothing of it is left when both leave.
  (void)response_step(both, test::both_pressed(-0.005), state);
  EXPECT_EQ(state.wrench.force_n, Vec3::Zero());
  EXPECT_TRUE(matrix_of(state.field.displacement_m).isZero(0.0));
}

TEST_F(SeveralTips, ALoadLowersTheSurfaceAwayFromTheOther) {
  const ResponseModel both = model();
  ResponseModel one = model();
  one.tips.pop_back();
  ResponseState state(both), alone(one);
  // By the shapes at rest the right ball is 2 um deep; the left one lowers its place by more.
  const double turn = -0.05;
  const auto right_depth_m = [&](double z_m) {
    scene::Pose pose = test::both_pressed(z_m, 0.0, 0.0, turn);
    (void)response_force(both, pose, state);
    return scene::touch(*both.body, both.tips[1].tip, pose).depth_m;
  };
  double z_m = 0.0;
  for (int k = 0; k < 20; ++k) z_m += 2e-6 - right_depth_m(z_m);
  const scene::Pose pose = test::both_pressed(z_m, 0.0, 0.0, turn);
  (void)response_step(both, pose, state);
  (void)response_step(one, pose, alone);
  EXPECT_TRUE(state.contacts[0].touches());
  EXPECT_FALSE(state.contacts[1].touches());
  const double F = alone.wrench.force_n.norm();
  EXPECT_NEAR((state.wrench.force_n - alone.wrench.force_n).norm(), 0.0, 1e-13 * F);
  // Pressed in together, each has less force than alone, by about what the other lowers it.
  (void)response_step(both, poses_.front(), state);
  (void)response_step(one, poses_.front(), alone);
  const ResponseContact& left = state.contacts[0];
  const double lowered_m =
      state.contacts[1].load.force_n * (both.half_space.surface_m2_per_n() / test::apart_m +
                                        0.5 * (C_m_per_n(left.at.point_m) + C_m_per_n(state.contacts[1].at.point_m)));
  const double C = left.compliance_m_per_n, k = left.law.stiffness_n_per_m;
  const double less_n = alone.contacts[0].load.force_n - left.load.force_n;
  EXPECT_NEAR(less_n, lowered_m * k / (1.0 + C * k), 0.05 * less_n);
}

TEST_F(SeveralTips, PointsUnderEachLieOnIt) {
  surface_ = scene::tessellate(*scene::body_shape(scene_.body), 60000);
  const ResponseModel model = this->model();
  ResponseState state(model);
  const scene::Pose pose = test::both_pressed(0.0015, 0.001, 0.0, 0.01);
  (void)response_step(model, pose, state);
  const Eigen::Matrix3Xd moved_m = surface_.points_m + matrix_of(state.field.displacement_m);
  for (const TipLaw& law : model.tips) {
    const Vec3 center_m = pose.orientation * law.tip.center_T_m + pose.position_m;
    int on_tool = 0;
    for (const auto& p_m : moved_m.colwise()) {
      const double out_m = (p_m - center_m).norm() - law.tip.radius_m;
      EXPECT_GT(out_m, -3e-4);
      on_tool += std::abs(out_m) < 1e-7 ? 1 : 0;
    }
    EXPECT_GT(on_tool, 6);
  }
  // Far away the shape is the sum of what both loads give alone.
  const auto contacts = state.contacts;
  Eigen::Matrix3Xd sum_m = Eigen::Matrix3Xd::Zero(3, moved_m.cols());
  for (std::size_t i = 0; i < 2; ++i) {
    state.contacts = contacts;
    state.contacts[1 - i].load.force_n = 0.0;
    response_shape(model, state);
    sum_m += matrix_of(state.field.displacement_m);
  }
  state.contacts = contacts;
  response_shape(model, state);
  const Eigen::Matrix3Xd both_m = matrix_of(state.field.displacement_m);
  int far = 0;
  for (Eigen::Index i = 0; i < sum_m.cols(); ++i) {
    const Vec3 p_m = surface_.points_m.col(i);
    if ((p_m - contacts[0].load.center_m).norm() < 0.005 || (p_m - contacts[1].load.center_m).norm() < 0.005) continue;
    ++far;
    EXPECT_NEAR((sum_m.col(i) - both_m.col(i)).norm(), 0.0, 1e-9);
  }
  EXPECT_GT(far, 1000);
}

TEST_F(SeveralTips, AreInTheRecordsAndThePlan) {
  compare::testing::TemporaryFolder folder;
  scene_.fast.formulation = scene::Formulation::response;
  scene_.fast.store = folder.path();
  scene_.fast.triangles = 20000;
  surface_ = scene::tessellate(*scene::body_shape(scene_.body), scene_.fast.triangles);
  const std::string identity =
      scene::response_identity(scene_.body, scene::load_grid(scene_).grid.value(), surface_, scene::load_kinds(scene_));
  const auto file = scene::response_path(folder.path(), identity);
  std::filesystem::create_directories(file.parent_path());
  scene::write_file(file, scene::response_bytes(test::synthetic_response(scene_, surface_), identity));
  const fast::Run run = fast::run(scene_), again = fast::run(scene_);
  EXPECT_EQ(status_text(run.status), "ok");
  EXPECT_EQ(run.regions_max, 2);
  for (std::size_t i = 0; i < run.instants.size(); ++i) {
    EXPECT_EQ(run.instants[i].force_n(), again.instants[i].force_n());
    EXPECT_EQ(run.instants[i].displacement_m, again.instants[i].displacement_m);
  }
  const scene::InstantRecord& last = run.instants.back();
  ASSERT_EQ(last.regions.size(), 2u);
  EXPECT_NEAR((last.regions[0].force_n + last.regions[1].force_n - last.support_force_n).norm(), 0.0, 1e-12);
  EXPECT_NE(last.regions[0].depth_m, last.regions[1].depth_m);
  EXPECT_EQ(last.regions[0].id, 0);
  EXPECT_EQ(last.regions[1].id, 1);
  // Pressure under both.
  for (const double side : {-1.0, 1.0}) {
    double largest_pa = 0.0;
    for (Eigen::Index i = 0; i < last.traction_pa.cols(); ++i) {
      if (side * surface_.points_m(0, i) > 0.0) largest_pa = std::max(largest_pa, last.traction_pa.col(i).norm());
    }
    EXPECT_GT(largest_pa, 1e5) << side;
    EXPECT_LE(largest_pa, 1.001 * last.pressure_peak_pa) << side;
  }
  bool planned = false;
  for (const scene::PlanLine& line : fast::plan(scene_)) {
    if (line.part == "contact detection") {
      EXPECT_THAT(line.reason, HasSubstr("2 balls"));
    }
    if (line.part != "several regions") continue;
    planned = line.modelled;
    EXPECT_THAT(line.reason, HasSubstr("2 parts of the tool touch on this track, 2 at its instants"));
    EXPECT_THAT(line.cost, HasSubstr("measured"));
  }
  EXPECT_TRUE(planned);
}

}  // namespace
}  // namespace touchstone::fast
