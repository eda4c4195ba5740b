// Tuning against references that the fast model itself made: the constants come back, and what cannot be known is said.
#include "compare/tune/tune.h"

#include "compare/format/text.h"
#include "fast/run/replay.h"
#include "scene/base/files.h"
#include "scene/input/scene_io.h"
#include "support/bounded_memory.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <set>
#include <tuple>

namespace touchstone::compare {
namespace {

using scene::Vec3;
using ::testing::Contains;
using ::testing::HasSubstr;

const std::string scenes = source_folder() + "/meshes/scenes/";

scene::Scene small(const std::vector<std::string>& more = {}) {
  std::vector<std::string> settings = {"compare.instants=9", "fast.triangles=400", "fast.rate_hz=200.0",
                                       "contact.k1_n_per_m=20000.0"};
  settings.insert(settings.end(), more.begin(), more.end());
  return scene::load_scene(scenes + "sphere-on-sphere-body.toml", settings);
}

/// What a fast model with these constants answers, as a reference with narrow bands.
SolveReference made_with(const std::map<std::string, double>& constants) {
  return [constants](const scene::Scene& asked, const scene::Surface&) {
    scene::Scene scene = asked;
    for (const auto& [key, value] : constants) set_parameter(scene, key, value);
    reference::Result result;
    const fast::Run run = fast::run(scene);
    result.levels.push_back({});
    for (const scene::InstantRecord& record : run.instants) {
      result.levels[0].force_n.push_back(record.force_n().norm());
      scene::ReferenceInstant& instant = result.instants.emplace_back(scene::ReferenceInstant{record});
      if (!record.regions.empty()) instant.region_middles_m = {Vec3(0.0, 0.0, 0.06)};
      instant.displacement_uncertainty_m.setConstant(run.surface.points_m.cols(), 1e-6);
      instant.force_uncertainty_n = 0.01;
    }
    result.shape_uncertainty_rel = 1e-4;
    result.model = "made by the fast model";
    return result;
  };
}

TuningParameter free(const std::string& key, double low, double high, TuningStage stage = TuningStage::force) {
  return {key, "", stage, low, high, std::sqrt(low * high), true, false};
}

TuningStudy study(std::vector<TuningParameter> parameters) {
  TuningStudy out;
  out.name = "made";
  out.formulations = {scene::Formulation::corrected};
  out.laws = {scene::ContactLaw::duffing};
  out.starts = 2;
  out.shape_floor = 1e-4;
  out.training = {{"pole", "", small(), {0.0, 0.003}}};
  out.held_out = {{"deeper", "depth", small(), {0.003, 1.0}},
                  {"Larger ball", "tool", small({"tool.radius_m=0.0104"}), {0.0, 1.0}}};
  out.parameters = std::move(parameters);
  return out;
}

const Determination& found(const TunedModel& model, const std::string& key) {
  for (const StageFit& stage : model.stages) {
    for (std::size_t k = 0; k < stage.parameters.size(); ++k) {
      if (stage.parameters[k].key == key) return stage.fit.parameters[k];
    }
  }
  throw std::out_of_range(key);
}

scene::Scene coarse(const std::string& name) {
  return scene::load_scene(scenes + name + ".toml", {"compare.instants=7", "fast.triangles=200", "fast.rate_hz=100.0",
                                                     "fast.tool_samples=2000"});
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

// A tool that may have several regions is recorded only while its constants cannot say how many.
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
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer keeps memory of its own";
#endif
  scene::Scene scene = coarse("ball-on-cube-slide");
  // A long way off, where a tick costs least.
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
  // What made the reference is right everywhere.
  for (const TuningOutcome& outcome : model.outcomes) {
    EXPECT_LT(*outcome.errors.force_nrmse.value, 1e-3);
    EXPECT_LT(*outcome.errors.shape_rel_l2.value, 1e-2);
  }
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

TEST(Tune, SaysWhatTheDataCannotDetermine) {
  // A local factor of strength zero has no radius.
  TuningStudy asked =
      study({free("fast.s_c_m2", 1e-2, 1.0, TuningStage::shape), free("fast.r_R_m", 0.005, 0.03, TuningStage::shape)});
  for (auto* list : {&asked.training, &asked.held_out}) {
    for (TuningContact& contact : *list) contact.scene.fast.C_n = 0.0;
  }
  const Tuning tuning = tune(asked, made_with({{"fast.s_c_m2", 0.1}}));
  const TunedModel& model = tuning.models.at(0);
  EXPECT_TRUE(found(model, "fast.r_R_m").open);
  EXPECT_FALSE(found(model, "fast.s_c_m2").open);
  EXPECT_THAT(model.stages.at(0).notes, Contains(HasSubstr("cannot determine fast.r_R_m")));
}

TEST(Tune, NamesAnActiveBoundInEveryAnswer) {
  const Tuning tuning = tune(study({free("contact.k1_n_per_m", 1e2, 1e4), free("contact.k3_n_per_m3", 1e7, 1e11)}),
                             made_with({{"contact.k1_n_per_m", 3.0e4}, {"contact.k3_n_per_m3", 2.0e9}}));
  const TunedModel& model = tuning.models.at(0);
  EXPECT_EQ(found(model, "contact.k1_n_per_m").at_bound, AtBound::high);
  EXPECT_THAT(model.stages.at(0).notes, Contains(HasSubstr("contact.k1_n_per_m ended at its upper bound")));
  const scene::Figures figures = tuning_figures(tuning);
  const auto error = std::find_if(figures.begin(), figures.end(), [](const scene::Figure& figure) {
    return figure.key == "parameter.contact.k1_n_per_m.error_rel";
  });
  ASSERT_NE(error, figures.end());
  EXPECT_EQ(error->text, "none: at its upper bound");
}

TEST(Tune, SaysWhatThePartsOfTheShapeAreGoodFor) {
  const auto constants = std::map<std::string, double>{{"contact.k1_n_per_m", 900.0}, {"fast.s_c_m2", 6.0e-3}};
  const Tuning tuning =
      tune(study({free("contact.k1_n_per_m", 1e1, 1e5), free("fast.s_c_m2", 1e-4, 1e-1, TuningStage::shape)}),
           made_with(constants));
  const TunedModel& model = tuning.models.at(0);
  const ShapeParts& parts = model.shape_parts;
  EXPECT_NEAR(parts.whole, *model.outcomes.at(0).errors.shape_rel_l2.value, 1e-9);
  // The reference has both parts.
  EXPECT_GT(parts.without_local_factor, parts.whole + 0.01);
  EXPECT_GT(parts.anchors_at_rest, parts.whole + 0.01);
  EXPECT_GT(parts.hat_alone, parts.whole + 0.01);
  EXPECT_THAT(model.limits.back(), HasSubstr("What its parts are good for, on the training contact pole"));
}

TEST(Tune, NamesTheLawInWordsAndKeepsItsKeyForFiles) {
  TunedModel model;
  model.law = scene::ContactLaw::area_aware;
  EXPECT_EQ(model.name(), "corrected area-aware");
  EXPECT_EQ(model.key(), "corrected-area_aware");
}

TEST(Tune, HeldOutFiguresAreTheWorstContactsAndNoneOfTraining) {
  const Tuning tuning =
      tune(study({free("contact.k1_n_per_m", 1e1, 1e5)}), made_with({{"contact.k3_n_per_m3", 2.0e9}}));
  std::map<std::string, double> figures;
  for (const scene::Figure& figure : tuning_figures(tuning)) figures[figure.key] = figure.number;
  const auto nrmse = [&](std::size_t k) { return *tuning.models[0].outcomes[k].errors.force_nrmse.value; };
  EXPECT_EQ(figures.at("training.force.nrmse"), nrmse(0));
  EXPECT_EQ(figures.at("held_out.force.nrmse"), std::max(nrmse(1), nrmse(2)));
  EXPECT_EQ(figures.at("held_out.deeper.force.nrmse"), nrmse(1));
  EXPECT_EQ(figures.at("held_out.larger-ball.force.nrmse"), nrmse(2));
  EXPECT_EQ(figures.at("corrected-duffing.held_out.force.nrmse"), figures.at("held_out.force.nrmse"));
  EXPECT_GT(nrmse(1), nrmse(0));
}

TEST(Tune, RefusesAContactWithoutAnInstantThatCounts) {
  TuningStudy asked = study({free("contact.k1_n_per_m", 1e1, 1e5)});
  asked.held_out[0].depth_m = {0.1, 1.0};
  EXPECT_THROW((void)tune(asked, made_with({})), scene::InputError);
}

/// A model with one value found by the fit of one contact.
std::string parameters_with(const std::string& scene, const std::string& key, double value) {
  Tuning tuning{study({}), {}, {}};
  for (const std::string& name : {std::string("ball-on-cube-press"), scene})
    tuning.data.push_back({{name, "", scene::load_scene(scenes + name + ".toml"), {}}, {}, {}, {}});
  TunedModel model;
  StageFit& stage = model.stages.emplace_back();
  stage.parameters = {free(key, 0.1, 10.0)};
  stage.fit.value = Eigen::VectorXd::Constant(1, value);
  return parameters_toml(tuning, model);
}

TEST(Parameters, HoldTheModelItsLawAndWhatWasTuned) {
  const std::string force = parameters_with("hertz-sphere", "contact.omega0_squared_per_s2", 7.0);
  EXPECT_THAT(force, HasSubstr("\n\n[contact]\nlaw = \"duffing\"\nk1_n_per_m = 7.0\nk3_n_per_m3 = 3e+08\n\n[fast]\n"
                               "formulation = \"corrected\"\n"));
  EXPECT_THAT(force, ::testing::Not(HasSubstr("reference reads")));
  // Friction's table is whole, with the values of a contact that has it.
  const std::string friction = parameters_with("ball-on-cube-slide", "contact.friction.stiffness_ratio", 0.5);
  EXPECT_THAT(friction, HasSubstr("\n[contact.friction]\nK = 1.0\nbeta = 0.75\nmu_D = 0.5\nstiffness_ratio = 0.5\n"));
  EXPECT_THAT(friction, HasSubstr("# The reference reads contact.friction.K, contact.friction.beta, "
                                  "contact.friction.mu_D too"));
}

TEST(Parameters, TakenOverLeaveTheStoredReferenceValidButForFrictionsLimits) {
  const testing::TemporaryFolder folder;
  std::set<std::string_view> stale;
  for (const char* name : {"ball-on-cube-slide", "mallet-tail-on-cube", "compass-two-pins"}) {
    const scene::Scene scene = scene::load_scene(scenes + name + ".toml");
    for (const auto& field : scene::scene_fields()) {
      if (!field.tunable || field.tunable->stage == scene::TuningStage::model || !scene::applies(field, scene))
        continue;
      scene::Scene taken = scene;
      set_parameter(taken, std::string(field.key), 0.9);
      EXPECT_NE(scene::scene_hash(taken), scene::scene_hash(scene)) << field.key;
      if (reference::content_key(taken) != reference::content_key(scene)) stale.insert(field.key);
    }
  }
  EXPECT_THAT(stale, ::testing::ElementsAre("contact.friction.K", "contact.friction.beta", "contact.friction.mu_D"));
  const scene::Scene press = scene::load_scene(scenes + "ball-on-cube-press.toml");
  const scene::Scene tuned = with_parameters(press, source_folder() + "/meshes/parameters/ball-on-cube.toml");
  EXPECT_NE(scene::scene_hash(tuned), scene::scene_hash(press));
  EXPECT_EQ(reference::content_key(tuned), reference::content_key(press));
}

TEST(Tune, LeavesAFolderWhoseParametersASceneTakesOver) {
  const testing::TemporaryFolder folder;
  TuningStudy asked = study({free("contact.k3_n_per_m3", 1e7, 1e11), free("contact.k1_n_per_m", 1e1, 1e5),
                             free("fast.s_c_m2", 1e-4, 1e-1, TuningStage::shape)});
  asked.parameters[2].profile = true;
  asked.title = "Made & tuned";
  const Tuning tuning = tune(asked, made_with({{"contact.k1_n_per_m", 900.0}}));
  write_tuning(folder.path(), tuning, scene::make_manifest(asked.training[0].scene, "touchstone tune"));
  for (const char* name : {"parameters.toml", "parameters-corrected-duffing.toml", "summary.json", "curve.csv",
                           "manifest.json", "report.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / name)) << name;
  }
  // The scene without the constants, and one line more.
  std::string text = scene::resolved_toml(asked.training[0].scene);
  for (const char* key : {"k1_n_per_m", "k3_n_per_m3", "s_c_m2", "formulation", "law"}) {
    const std::size_t at = text.find(std::string("\n") + key + " = ");
    ASSERT_NE(at, std::string::npos) << key;
    text.erase(at, text.find('\n', at + 1) - at);
  }
  const scene::Scene taken = scene::parse_scene("include = \"parameters.toml\"\n" + text, folder.path() / "scene.toml");
  const scene::Scene wanted = tuned_scene(asked.training[0].scene, tuning.models[0]);
  EXPECT_EQ(taken.contact.k1_n_per_m, wanted.contact.k1_n_per_m);
  EXPECT_EQ(taken.fast.s_c_m2, wanted.fast.s_c_m2);
  EXPECT_EQ(scene::scene_hash(taken), scene::scene_hash(wanted));

  const std::string html = *scene::read_file(folder.path() / "report.html");
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(html));
  EXPECT_LT(html.find("On held-out contacts"), html.find("On training contacts"));
  for (const char* text_there :
       {"Made &amp; tuned", "Profile of fast.s_c_m2", "Regime map", "Correlation", "What limits"}) {
    EXPECT_THAT(html, HasSubstr(text_there));
  }
  // Nobody's material is judged by what another model once reached, and what limits the first model stands there once.
  EXPECT_THAT(html, ::testing::Not(HasSubstr("prototype")));
  const std::string limit = escape_xml(tuning.models.front().limits.front());
  EXPECT_NE(html.find(limit), std::string::npos);
  EXPECT_EQ(html.find(limit), html.rfind(limit));
}

}  // namespace
}  // namespace touchstone::compare
