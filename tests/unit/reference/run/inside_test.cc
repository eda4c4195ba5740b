// Probes are read from stored solutions, and their uncertainty is known when the force's is.
#include "reference/run/inside.h"

#include "reference/solver.h"
#include "scene/base/error.h"
#include "scene/shape/surface.h"
#include "support/ball_on_ball.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <cmath>
#include <filesystem>

namespace touchstone::reference {
namespace {

class InsideTest : public testing::Test {
 protected:
  InsideTest() : root_(std::filesystem::temp_directory_path() / ("touchstone-inside-" + std::to_string(::getpid()))) {
    scene_ = ball_on_ball_scene({{0.0, 0.0705}, {1.0, 0.0680}}, 3);
    scene_.reference.levels = 3;
    points_m_ = scene::tessellate(*scene::body_shape(scene_.body), 64).points_m;
  }
  ~InsideTest() override { std::filesystem::remove_all(root_); }
  Result solved() { return solve(scene_, points_m_, {root_, {}, nullptr}); }

  std::filesystem::path root_;
  scene::Scene scene_;
  Eigen::Matrix3Xd points_m_;
};

TEST_F(InsideTest, ProbesOfAnOldStoreNeedNoSolve) {
  (void)solved();
  scene_.probes = {{"top", {0.0, 0.0, 0.06}}, {"below", {0.0, 0.0, 0.055}}, {"beside", {0.003, -0.004, 0.05}}};
  const Result result = solved();
  ASSERT_TRUE(result.from_store);
  const auto probes = inside(scene_, result, root_)->probes();
  ASSERT_EQ(probes.size(), 3u);
  // At rest nothing is stressed, and that is certain.
  EXPECT_EQ(probes[0].values.stress_pa.norm(), 0.0);
  const ProbeInstant& deepest = probes.back();
  EXPECT_GT(pressure_pa(deepest.values.stress_pa)[1], 1e4);
  EXPECT_LT(deepest.values.stress_pa(8, 1), -1e4);  // along z
  // On the surface it is the displacement of the rest point there, with at least its uncertainty of the meshes.
  Eigen::Index top = 0;
  ASSERT_LT((points_m_.colwise() - scene_.probes[0].position_m).colwise().norm().minCoeff(&top), 1e-9);
  const auto& instant = result.instants.back();
  EXPECT_LT((deepest.values.displacement_m.col(0) - instant.displacement_m.col(top)).norm(), 1e-12);
  EXPECT_NEAR(deepest.displacement_uncertainty_m[0], instant.displacement_uncertainty_m[top], 1e-12);
  // Under the tool its pressure acts on the body.
  EXPECT_NEAR(-deepest.values.stress_pa(8, 0), instant.pressure_peak_pa, 0.03 * instant.pressure_peak_pa);
  EXPECT_GT(deepest.stress_uncertainty_pa.minCoeff(), 0.0);
}

TEST_F(InsideTest, TheUncertaintyHoldsTheSensitivities) {
  scene_.probes = {{"deep", {0.0, 0.0, 0.02}}};
  Result result = solved();
  ASSERT_FALSE(result.sensitivities.empty());
  const double with_m = inside(scene_, result, root_)->probes().back().displacement_uncertainty_m[0];
  result.sensitivities.clear();
  EXPECT_LT(inside(scene_, result, root_)->probes().back().displacement_uncertainty_m[0], with_m);
}

TEST_F(InsideTest, TheUncertaintyIsUnknownBelowThreeMeshes) {
  scene_.probes = {{"below", {0.0, 0.0, 0.055}}};
  scene_.reference.levels = 2;
  const auto probes = inside(scene_, solved(), root_)->probes();
  EXPECT_TRUE(std::isnan(probes.back().displacement_uncertainty_m[0]));
  EXPECT_TRUE(std::isnan(probes.back().stress_uncertainty_pa[0]));
  EXPECT_TRUE(std::isnan(probes.back().pressure_uncertainty_pa()[0]));
}

TEST_F(InsideTest, ALostSolutionIsNamed) {
  scene_.probes = {{"below", {0.0, 0.0, 0.055}}};
  scene_.reference.levels = 1;
  const Result result = solved();
  std::filesystem::remove_all(root_);
  try {
    (void)inside(scene_, result, root_)->probes();
    FAIL() << "a solution that is not there was read";
  } catch (const scene::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("run the command again"), std::string::npos) << error.what();
  }
}

TEST(PointValues, PressureAndVonMisesOfAUniaxialStress) {
  Eigen::Matrix<double, 9, Eigen::Dynamic> stress_pa = Eigen::Matrix<double, 9, Eigen::Dynamic>::Zero(9, 2);
  stress_pa(8, 0) = -3.0;
  stress_pa(1, 1) = stress_pa(3, 1) = 2.0;
  EXPECT_DOUBLE_EQ(pressure_pa(stress_pa)[0], 1.0);
  EXPECT_DOUBLE_EQ(von_mises_pa(stress_pa)[0], 3.0);
  EXPECT_DOUBLE_EQ(pressure_pa(stress_pa)[1], 0.0);
  EXPECT_DOUBLE_EQ(von_mises_pa(stress_pa)[1], 2.0 * std::sqrt(3.0));
}

}  // namespace
}  // namespace touchstone::reference
