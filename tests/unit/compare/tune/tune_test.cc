// Tuning against references computed by a model: the constants are recovered.
#include "compare/tune/tune.h"

#include "compare/model/usual_models.h"
#include "compare/tune/tune_results.h"
#include "fast/run/replay.h"
#include "fast/run/run.h"
#include "scene/base/files.h"
#include "scene/response/response_file.h"
#include "support/bounded_memory.h"
#include "support/press.h"
#include "support/spring.h"
#include "support/synthetic_response.h"
#include "support/temporary_folder.h"
#include "unit/compare/tune/made_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace touchstone::compare {
namespace {

using namespace testing;
using scene::Vec3;

scene::Scene coarse(const std::string& name) {
  return scene::load_scene(
      source_folder() + "/meshes/scenes/" + name + ".toml",
      {"compare.instants=7", "fast.triangles=200", "fast.rate_hz=100.0", "fast.tool_samples=2000"});
}

/// Down, up and out, and down again.
scene::Scene twice(scene::Scene scene) {
  const std::vector<scene::Waypoint> once = scene.track;
  const double end_s = once.back().time_s;
  scene.track.push_back({end_s + 0.2, once.front().pose});
  scene.track.push_back({end_s + 0.5, once.back().pose});
  return scene;
}

class Replays : public ::testing::TestWithParam<std::tuple<std::string, bool, bool>> {};

TEST_P(Replays, EqualTheRunBitForBitWithTheConstantsOfTheCall) {
  const auto& [name, again, recorded] = GetParam();
  const scene::Scene scene = again ? twice(coarse(name)) : coarse(name);
  scene::Scene other = scene;
  other.fast.C_n = 0.1;
  other.fast.s_c_m2 *= 2.0;
  other.contact.k3_n_per_m3 += 1.0e7;
  fast::Replay replay(scene);
  EXPECT_EQ(replay.recorded(), recorded);
  for (const scene::Scene& now : {other, scene}) {
    const fast::Run run = fast::run(now);
    const std::vector<Vec3> force_n = replay.forces_n(now);
    ASSERT_EQ(force_n.size(), run.instants.size());
    std::vector<std::size_t> instants;
    for (std::size_t t = 0; t < force_n.size(); ++t) {
      EXPECT_EQ(force_n[t], run.instants[t].force_n()) << t;
      if (t % 2 == 0) instants.push_back(t);
    }
    std::size_t visited = 0;
    replay.displacements(now, instants, [&](std::size_t k, const fast::Columns3& displacement_m) {
      EXPECT_EQ(k, visited++);
      EXPECT_EQ(fast::matrix_of(displacement_m), run.instants[instants[k]].displacement_m) << k;
    });
    EXPECT_EQ(visited, instants.size());
    EXPECT_GT(force_n.back().norm(), 0.0);
  }
}

// A tool that may have several regions is recorded only while its number of regions does not depend on its constants.
INSTANTIATE_TEST_SUITE_P(
    Scenes, Replays,
    ::testing::Values(std::tuple("sphere-on-sphere-body", false, true), std::tuple("sphere-on-sphere-body", true, true),
                      std::tuple("ball-on-cube-slide", false, true), std::tuple("ball-on-cube-slide", true, true),
                      std::tuple("mallet-tail-on-cube", false, true), std::tuple("mallet-tail-on-cube", true, true),
                      std::tuple("compass-two-pins", false, false)));

TEST(Replay, AnotherClusterDistanceIsNotTheRecordedOne) {
  const scene::Scene scene = coarse("mallet-tail-on-cube");
  scene::Scene finer = scene;
  finer.contact.r_th_m = 0.0005;
  fast::Replay replay(scene);
  ASSERT_TRUE(replay.recorded());
  const std::vector<Vec3> force_n = replay.forces_n(finer);
  EXPECT_FALSE(replay.recorded());
  const fast::Run run = fast::run(finer);
  for (std::size_t t = 0; t < force_n.size(); ++t) EXPECT_EQ(force_n[t], run.instants[t].force_n()) << t;
}

TEST(Replay, ATrackOfManyTicksIsSteppedThroughAnewInsteadOfKept) {
  const scene::Scene scene = coarse("ball-on-cube-slide");
  fast::Replay kept(scene), stepped(scene, 64 << 10);
  ASSERT_TRUE(kept.recorded());
  EXPECT_FALSE(stepped.recorded());
  EXPECT_EQ(stepped.forces_n(scene), kept.forces_n(scene));
}

TEST(Replay, MemoryDoesNotHangOnTheTicks) {
  if (TOUCHSTONE_SANITIZED) GTEST_SKIP() << "the sanitizer keeps memory of its own";
  scene::Scene scene = coarse("ball-on-cube-slide");
  // Far away, where a tick takes least time.
  for (scene::Waypoint& row : scene.track) row.pose.position_m.z() += 0.5;
  scene.track.back().time_s = 1e4;
  EXPECT_TRUE(done_within(std::size_t{32} << 20, [&] {
    fast::Replay replay(scene, 1 << 20);
    return replay.forces_n(scene).size() == 7;
  }));
}

TEST(Tune, BringsBackTheConstantsOfForceAndShape) {
  const Tuning tuning = tune(
      study({free("contact.k1_n_per_m", 1e1, 1e5), free("contact.k3_n_per_m3", 1e7, 1e11),
             free("fast.s_c_m2", 1e-4, 1e-1, TuningStage::shape), free("fast.C_n", 1e-2, 0.4, TuningStage::shape)}),
      made_with(
          {{"contact.k1_n_per_m", 900.0}, {"contact.k3_n_per_m3", 2.0e9}, {"fast.s_c_m2", 6.0e-3}, {"fast.C_n", 0.1}}));
  const TunedModel& model = tuning.models.at(0);
  EXPECT_NEAR(found(model, "contact.k1_n_per_m").value, 900.0, 0.5);
  EXPECT_NEAR(found(model, "contact.k3_n_per_m3").value, 2.0e9, 1e6);
  EXPECT_NEAR(found(model, "fast.s_c_m2").value, 6.0e-3, 1e-5);
  EXPECT_NEAR(found(model, "fast.C_n").value, 0.1, 1e-3);
  // The true constants are right for every contact.
  for (const TuningOutcome& outcome : model.outcomes) {
    EXPECT_LT(*outcome.errors.force_nrmse.value, 1e-3);
    EXPECT_LT(*outcome.errors.shape_rel_l2.value, 1e-2);
  }
}

TEST(Tune, BringsBackTheConstantOfAModelThatNobodyHereKnows) {
  const ModelEntry spring = testing::springs({.scene = small()}).front();
  const ModelOf springs = [&](const scene::Scene&) { return spring; };
  const Tuning tuning = tune(study({free("contact.k1_n_per_m", 1e1, 1e5)}),
                             made_with({{"contact.k1_n_per_m", 900.0}}, springs), {}, springs);
  const TunedModel& model = tuning.models.at(0);
  EXPECT_NEAR(found(model, "contact.k1_n_per_m").value, 900.0, 0.5);
  for (const TuningOutcome& outcome : model.outcomes) EXPECT_LT(*outcome.errors.force_nrmse.value, 1e-3);
  EXPECT_EQ(model.name(), "one spring");
}

TEST(Tune, BringsBackTheResponseModelsFalloffAndNothingElse) {
  const testing::TemporaryFolder folder;
  const auto contact = [&](double radius_m) {
    scene::Scene scene = test::ball_on_cube();
    scene.body.inclusions.emplace_back();
    scene.body.inclusions[0].material = scene.body.material;
    scene.track.back().pose.position_m.z() += radius_m - scene.tool.radius_m;
    scene.tool.radius_m = radius_m;
    scene.fast.formulation = scene::Formulation::response;
    scene.fast.triangles = 400;
    scene.fast.store = folder.path();
    const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
    const std::string identity =
        scene::response_identity(scene.body, scene::load_grid(scene).grid.value(), surface, scene::load_kinds(scene));
    const std::filesystem::path file = scene::response_path(folder.path(), identity);
    std::filesystem::create_directories(file.parent_path());
    scene::write_file(file, scene::response_bytes(test::synthetic_response(scene, surface), identity));
    return scene;
  };
  TuningStudy made = study({free("fast.body_falloff_per_m", 20.0, 2e3), free("contact.k1_n_per_m", 1e3, 1e6)});
  made.formulations = {scene::Formulation::response};
  made.laws = {scene::ContactLaw::duffing, scene::ContactLaw::area_aware};  // it has neither
  made.training = {{"ball", "", contact(0.010), {0.0, 1.0}}};
  made.held_out = {{"smaller ball", "tool", contact(0.006), {0.0, 1.0}}};
  const Tuning tuning = tune(made, made_with({{"fast.body_falloff_per_m", 230.0}}));
  ASSERT_EQ(tuning.models.size(), 1u);
  const TunedModel& model = tuning.models.front();
  EXPECT_EQ(model.name(), "response");
  EXPECT_TRUE(model.shape_parts.empty());
  ASSERT_EQ(model.stages.size(), 1u);
  ASSERT_EQ(model.stages[0].parameters.size(), 1u);
  const Determination& falloff = found(model, "fast.body_falloff_per_m");
  EXPECT_NEAR(falloff.value, 230.0, 0.01);
  EXPECT_TRUE(falloff.error.has_value());
  for (const TuningOutcome& outcome : model.outcomes) {
    EXPECT_LT(*outcome.errors.force_nrmse.value, 1e-5);
    EXPECT_LT(*outcome.errors.shape_rel_l2.value, 1e-5);
  }
  // The file holds what makes it this model, and a scene takes it.
  const std::string text = parameters_toml(tuning, model);
  EXPECT_EQ(text.find("[contact]"), std::string::npos) << text;
  const std::filesystem::path file = folder.path() / "parameters.toml";
  scene::write_file(file, text);
  scene::Scene plain = made.training[0].scene;
  plain.fast.formulation = scene::Formulation::corrected;
  const scene::Scene tuned = with_parameters(plain, file);
  EXPECT_EQ(tuned.fast.formulation, scene::Formulation::response);
  EXPECT_NEAR(tuned.fast.body_falloff_per_m, 230.0, 0.01);
  // Beside the untuned one in the table of a comparison.
  const std::vector<ModelEntry> models = usual_models({.scene = plain, .parameters = {file}});
  const auto row = std::ranges::find(models, "tuned", &ModelEntry::key);
  ASSERT_NE(row, models.end());
  EXPECT_EQ(row->method, "half space, response");
  EXPECT_EQ(std::ranges::count(models, "response", &ModelEntry::key), 1);
  scene::Answer answer = unanswered(plain);
  row->set_up(plain)->answer(answer);
  EXPECT_NEAR(answer.instants.back().force_n().norm(), model.outcomes[0].errors.instants.back().force_fast_n, 1e-9);
}

TEST(Tune, JudgesOnlyTheInstantsOfTheAskedDepths) {
  const Tuning tuning = tune(study({free("contact.k1_n_per_m", 1e1, 1e5)}), made_with({}));
  ASSERT_EQ(tuning.data.size(), 3u);
  const auto depths = [&](std::size_t k) {
    std::vector<double> list;
    for (const InstantErrors& e : tuning.models[0].outcomes[k].errors.instants) list.push_back(e.depth_m);
    return list;
  };
  for (const double depth_m : depths(0)) EXPECT_LE(depth_m, 0.003);
  for (const double depth_m : depths(1)) EXPECT_GT(depth_m, 0.003);
  EXPECT_EQ(depths(0).size() + depths(1).size(), 9u);
  EXPECT_EQ(depths(2).size(), 9u);
}

TEST(Tune, RefusesAContactWithoutAnInstantThatCounts) {
  TuningStudy asked = study({free("contact.k1_n_per_m", 1e1, 1e5)});
  asked.held_out[0].depth_m = {0.1, 1.0};
  EXPECT_THROW((void)tune(asked, made_with({})), scene::InputError);
}

}  // namespace
}  // namespace touchstone::compare
