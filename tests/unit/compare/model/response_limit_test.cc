// As the depth goes to zero the response model is the body's linear finite-element answer.
#include "compare/errors/compute_errors.h"
#include "compare/model/engine_model.h"
#include "compare/model/response_model.h"
#include "fast/run/run.h"
#include "reference/solver.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace touchstone::compare {
namespace {

class ResponseLimit : public ::testing::TestWithParam<double> {};

// A flat pin of 6 mm on a cylinder of 40 mm height: the body yields by a tenth of what the contact does.
TEST_P(ResponseLimit, AsTheDepthGoesToZeroItIsTheLinearAnswer) {
  const testing::TemporaryFolder folder;
  scene::Scene scene = with_response(scene::load_scene(
      source_folder() + "/meshes/scenes/pin-on-cylinder.toml",
      {"track[1].position_m[2]=0.054995", "compare.instants=2", "fast.triangles=800", "reference.kinematics=small",
       "reference.levels=4", fmt::format("body.material.poissons_ratio={}", GetParam())}));
  scene.fast.store = folder.path();
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  reference::Options options;
  options.store = folder.path();
  const reference::Result linear = reference::solve(scene, surface.points_m, options);
  prepare_missing(scene);
  const Errors errors = compute_errors(scene, fast::run(scene), linear.instants);
  EXPECT_GT(linear.instants.back().force_n().z(), 0.1);
  EXPECT_LT(errors.force_nrmse.value.value(), 0.005);
  EXPECT_LT(errors.shape_rel_l2.value.value(), 0.03);
}

INSTANTIATE_TEST_SUITE_P(PoissonsRatios, ResponseLimit, ::testing::Values(0.0, 0.5));
INSTANTIATE_TEST_SUITE_P(PoissonsRatioBetween, ResponseLimit, ::testing::Values(0.3));

}  // namespace
}  // namespace touchstone::compare
