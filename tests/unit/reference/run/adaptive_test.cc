// Meshes refined where the error is: found again, gone on with, and apart from the fixed family.
#include "reference/run/adaptive.h"

#include "reference/run/identity.h"
#include "reference/run/inside.h"
#include "reference/run/options.h"
#include "reference/solver.h"

#include "scene/shape/surface.h"
#include "support/press.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>

namespace touchstone::reference {
namespace {

/// A ball pressed on a ball: axisymmetric.
class AdaptiveTest : public testing::Test {
 protected:
  AdaptiveTest() {
    scene_.body.support_height_m = 0.006;
    scene_.contact = {};
    scene_.track = {{0.0, {{0.0, 0.0, 0.0702}, Eigen::Quaterniond::Identity()}},
                    {1.0, {{0.0, 0.0, 0.0662}, Eigen::Quaterniond::Identity()}}};
    scene_.compare.instants = 5;
    scene_.reference.element_size_m = 0.003;
    scene_.reference.levels = 3;
    scene_.reference.adaptive_share = 0.3;
    scene_.probes = {{"below", {0.0, 0.0, 0.045}}};
    surface_ = scene::tessellate(*scene::body_shape(scene_.body), 128);
  }

  Result run(const std::atomic<bool>* stop = nullptr) {
    solved_ = 0;
    return solve(scene_, surface_.points_m,
                 {.store = root_,
                  .progress =
                      [&](const Progress& progress) {
                        if (progress.step_finished) ++solved_;
                        if (watch_) watch_(progress);
                      },
                  .stop = stop,
                  .rest_area_m2 = surface_.vertex_area_m2});
  }
  [[nodiscard]] std::filesystem::path folder() const { return root_ / content_key(scene_); }

  compare::testing::TemporaryFolder temporary_;
  std::filesystem::path root_ = temporary_.path();
  scene::Scene scene_ = test::ball_on_sphere();
  scene::Surface surface_;
  int solved_ = 0;
  std::function<void(const Progress&)> watch_;
};

TEST_F(AdaptiveTest, EveryMeshHasAboutTheUnknownsThatItsShareSays) {
  const Result result = run();
  ASSERT_EQ(result.levels.size(), 3u);
  EXPECT_TRUE(std::isfinite(*result.force_uncertainty_rel));
  for (int level = 1; level < 3; ++level) {
    const double growth = static_cast<double>(result.levels[level].unknowns) / result.levels[level - 1].unknowns;
    EXPECT_GT(growth, 1.6) << level;
    EXPECT_LT(growth, 3.0) << level;
  }
  for (const Sensitivity& one : result.sensitivities) EXPECT_NE(one.part, "far_field");
}

TEST_F(AdaptiveTest, HasAKeyOfItsOwnAndLeavesTheFixedFamilysAlone) {
  const std::string adaptive = identity_text(scene_);
  EXPECT_NE(adaptive.find("adaptive"), std::string::npos);
  scene_.reference.adaptive_share.reset();
  const std::string fixed = identity_text(scene_);
  EXPECT_EQ(fixed.find("adaptive"), std::string::npos);
  // Of a store written before there were adaptive meshes.
  EXPECT_EQ(content_key(scene_), "c6cf340ece369038a40277811e61418d");
}

TEST_F(AdaptiveTest, IsFoundAgainWithItsMeshes) {
  const Result first = run();
  const Result again = run();
  EXPECT_TRUE(again.from_store);
  EXPECT_EQ(solved_, 0);
  for (std::size_t i = 0; i < first.instants.size(); ++i) {
    EXPECT_EQ(again.instants[i].displacement_m, first.instants[i].displacement_m);
    EXPECT_EQ(again.instants[i].force_uncertainty_n, first.instants[i].force_uncertainty_n);
  }
  // The solutions inside the body, on meshes that are made from the store alone.
  const auto probe = inside(scene_, again, root_)->probes().back();
  EXPECT_LT(probe.values.displacement_m(2, 0), -1e-4);
  EXPECT_GT(probe.displacement_uncertainty_m[0], 0.0);
}

/// The fixed family's rule stays, in the plane the order too, and only deep instants count as refined for.
TEST_F(AdaptiveTest, TheForceHasARuleOfItsOwn) {
  std::vector<scene::ReferenceInstant> instants(3);
  for (std::size_t i = 0; i < 3; ++i) instants[i].depth_m = std::vector{0.0, 0.0003, 0.004}[i];
  EXPECT_EQ(force_rule(scene_, 2, instants).most_order, 1.0);
  EXPECT_GT(force_rule(scene_, 3, instants).most_order, 1.0);
  EXPECT_LT(force_rule(scene_, 3, instants).most_order, 1.5) << "the ball on a ball in space is missed by N^-1";
  EXPECT_EQ(force_rule(scene_, 3, instants).refined_for, (std::vector<bool>{false, false, true}));
  scene_.reference.adaptive_share.reset();
  EXPECT_EQ(force_rule(scene_, 3, instants).most_order, 1.0);
  EXPECT_TRUE(force_rule(scene_, 3, instants).refined_for.empty());
}

/// Neither where a run was stopped nor what it left of the cells to divide matters to the answer.
TEST_F(AdaptiveTest, GoesOnWhereItWasStopped) {
  std::atomic<bool> stop = false;
  watch_ = [&](const Progress& progress) {
    stop = progress.level == 2 && progress.step_finished && progress.instant == 3;
  };
  EXPECT_THROW((void)run(&stop), Interrupted);
  watch_ = nullptr;
  const Result resumed = run();
  EXPECT_EQ(solved_, 2 + 5) << "the rest of the second mesh and the third";
  std::filesystem::remove(folder() / "divided-2.step");
  EXPECT_EQ(run().levels[2].force_n, resumed.levels[2].force_n);
  EXPECT_EQ(solved_, 0) << "the same cells are found from the same solutions";
  std::filesystem::remove_all(root_);
  const Result in_one = run();
  for (int level = 0; level < 3; ++level) {
    EXPECT_EQ(in_one.levels[level].unknowns, resumed.levels[level].unknowns) << level;
    for (std::size_t i = 0; i < in_one.instants.size(); ++i)
      EXPECT_NEAR(in_one.levels[level].force_n[i], resumed.levels[level].force_n[i], 1e-7) << level << ' ' << i;
  }
}

/// On a thin bonded body, where the far field matters most, and where the fixed family's force is 0.19 % off.
TEST_F(AdaptiveTest, UncertaintyHoldsTheErrorOnAThinBody) {
  scene_.body.shape = scene::BodyShape::revolution;
  scene_.body.profile = {{{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.006}, {0.0, 0.006}}, {}};
  scene_.body.material = {1e6, 0.45};
  scene_.tool.radius_m = 0.02;
  scene_.track = {{0.0, {{0.0, 0.0, 0.0262}, Eigen::Quaterniond::Identity()}},
                  {1.0, {{0.0, 0.0, 0.0252}, Eigen::Quaterniond::Identity()}}};
  scene_.compare.instants = 3;
  scene_.reference.element_size_m.reset();
  scene_.probes.clear();
  surface_ = scene::tessellate(*scene::body_shape(scene_.body), 128);
  const Result adaptive = run();
  scene_.reference.levels = 4;
  const Result finer = run();
  scene_.reference.levels = 3;
  scene_.reference.adaptive_share.reset();
  const Result fixed = run();
  const auto error_n = [&](const Result& result, std::size_t i) {
    return (result.instants[i].force_n() - finer.instants[i].force_n()).norm();
  };
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(error_n(adaptive, i), adaptive.instants[i].force_uncertainty_n) << i;
    const Eigen::VectorXd error_m =
        (adaptive.instants[i].displacement_m - finer.instants[i].displacement_m).colwise().norm().transpose();
    EXPECT_LE(error_m.norm(), adaptive.instants[i].displacement_uncertainty_m.norm()) << i;
  }
  EXPECT_LT(adaptive.force_uncertainty_rel.value(), 0.02) << "one that is too large says nothing";
  EXPECT_GT(error_n(adaptive, 2), 0.0);
  EXPECT_LT(error_n(adaptive, 2), 0.3 * error_n(fixed, 2));
}

}  // namespace
}  // namespace touchstone::reference
