// The reported band must hold the true error, taken from a mesh sixteen times finer under the tool.
#include "reference/solver.h"

#include "scene/surface.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>

namespace touchstone::reference {
namespace {

scene::Scene ball_on_ball() {
  scene::Scene scene;
  scene.name = "ball-on-ball";
  scene.body.shape = scene::BodyShape::sphere;
  scene.body.radius_m = 0.03;
  scene.body.support_height_m = 0.006;
  scene.body.material = {3e6, 0.5};
  scene.tool.radius_m = 0.01;
  scene.track = {{0.0, {{0.0, 0.0, 0.0702}, Eigen::Quaterniond::Identity()}},
                 {1.0, {{0.0, 0.0, 0.0662}, Eigen::Quaterniond::Identity()}}};
  scene.compare.instants = 9;
  scene.reference.levels = 3;
  return scene;
}

TEST(UncertaintyBand, HoldsTheErrorAgainstAFinerSolution) {
  const auto store = std::filesystem::temp_directory_path() / ("touchstone-band-" + std::to_string(::getpid()));
  scene::Scene coarse = ball_on_ball();
  coarse.reference.element_size_m = 0.003;
  scene::Scene fine = ball_on_ball();
  fine.reference.element_size_m = 0.003 / 64.0;
  fine.reference.levels = 1;
  const auto points_m = scene::tessellate(*scene::body_shape(coarse.body), 200).points_m;
  const Result reported = solve(coarse, points_m, {store, {}, nullptr});
  const Result truth = solve(fine, points_m, {store, {}, nullptr});
  for (std::size_t i = 0; i < reported.instants.size(); ++i) {
    const double error_n = (reported.instants[i].force_n() - truth.instants[i].force_n()).norm();
    EXPECT_LE(error_n, reported.force_uncertainty_n[i]) << "instant " << i + 1;
    if (reported.instants[i].depth_m < 1e-3) continue;
    EXPECT_GT(error_n, 0.0);
    EXPECT_LT(reported.force_uncertainty_n[i], 0.03 * truth.instants[i].force_n().norm()) << "instant " << i + 1;
    // Of the points, the share whose error is inside its own band; the largest error is inside the largest band.
    const Eigen::VectorXd error_m =
        (reported.instants[i].displacement_m - truth.instants[i].displacement_m).colwise().norm().transpose();
    const Eigen::VectorXd& band_m = reported.displacement_uncertainty_m[i];
    const double inside = (error_m.array() <= band_m.array() + 1e-9).cast<double>().mean();
    EXPECT_GT(inside, 0.95) << "instant " << i + 1;
    EXPECT_LE(error_m.maxCoeff(), band_m.maxCoeff()) << "instant " << i + 1;
  }
  std::filesystem::remove_all(store);
}

}  // namespace
}  // namespace touchstone::reference
