// As the depth goes to zero the response model is the body's linear finite-element answer; and what computing the
// body's response says.
#include "compare/errors/compute_errors.h"
#include "compare/model/registry.h"
#include "compare/model/response_model.h"
#include "fast/run/run.h"
#include "reference/run/options.h"
#include "reference/solver.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <csignal>

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

INSTANTIATE_TEST_SUITE_P(Incompressible, ResponseLimit, ::testing::Values(0.5));
INSTANTIATE_TEST_SUITE_P(PoissonsRatioZero, ResponseLimit, ::testing::Values(0.0));
INSTANTIATE_TEST_SUITE_P(PoissonsRatioBetween, ResponseLimit, ::testing::Values(0.3));

TEST(Prepare, SaysWhatItDoesAndAfterASignalGoesOnWithItsColumns) {
  using ::testing::ContainsRegex;
  using ::testing::ElementsAre;
  using ::testing::HasSubstr;
  using ::testing::IsEmpty;
  const testing::TemporaryFolder folder;
  const scene::Scene scene =
      scene::load_scene(source_folder() + "/meshes/scenes/ball-on-cube-press.toml", {"fast.triangles=200"});
  std::vector<std::string> lines;
  const auto prepare_and_stop = [&](const std::string& at) {
    lines.clear();
    return prepare(scene, folder.path(), [&](const std::string& line, bool marked) {
      if (marked) lines.push_back(line);
      if (!at.empty() && line.find(at) != std::string::npos) std::raise(SIGTERM);
    });
  };
  EXPECT_THAT([&] { (void)prepare_and_stop("2 of 20 columns"); },
              ::testing::ThrowsMessage<reference::Interrupted>(HasSubstr("interrupted; 3 of 20 columns")));
  EXPECT_THAT(lines,
              ElementsAre(HasSubstr("computed once: mesh"), ContainsRegex("[0-9]+ unknowns, about .* 20 columns"),
                          ContainsRegex("2 of 20 columns, about .* left")));
  const reference::Prepared rest = prepare_and_stop("");
  EXPECT_TRUE(rest.computed);
  EXPECT_THAT(lines, ElementsAre(HasSubstr("mesh"), HasSubstr("then 17 of 20 columns"), HasSubstr("5 of 20 columns")));
  EXPECT_FALSE(prepare_and_stop("").computed);
  EXPECT_THAT(lines, IsEmpty());
}

}  // namespace
}  // namespace touchstone::compare
