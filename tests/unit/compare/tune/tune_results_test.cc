#include "compare/tune/tune_results.h"

#include "compare/format/text.h"
#include "reference/solver.h"
#include "scene/base/files.h"
#include "support/temporary_folder.h"
#include "support/xml.h"
#include "unit/compare/tune/made_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

namespace touchstone::compare {
namespace {

using namespace testing;
using ::testing::HasSubstr;

TEST(TunedModelName, IsTheLawInWordsAndKeepsItsKeyForFiles) {
  scene::Scene scene = small();
  scene.contact.law = scene::ContactLaw::area_aware;
  TunedModel model;
  model.entry = fast_model(scene);
  EXPECT_EQ(model.name(), "corrected area-aware");
  EXPECT_EQ(model.entry.key, "corrected-area_aware");
}

TEST(TuningFigures, HeldOutFiguresAreTheWorstContactsAndNoneOfTraining) {
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

/// A model with one fitted value, for one contact.
std::string parameters_with(const std::string& scene, const std::string& key, double value) {
  Tuning tuning{study({}), {}, {}};
  for (const std::string& name : {std::string("ball-on-cube-press"), scene})
    tuning.data.push_back(
        {{name, "", scene::load_scene(source_folder() + "/meshes/scenes/" + name + ".toml"), {}}, {}, {}, {}});
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
  // Friction's table is complete, with the values of a contact that has friction.
  const std::string friction = parameters_with("ball-on-cube-slide", "contact.friction.stiffness_ratio", 0.5);
  EXPECT_THAT(friction, HasSubstr("\n[contact.friction]\nK = 1.0\nbeta = 0.75\nmu_D = 0.5\nstiffness_ratio = 0.5\n"));
  EXPECT_THAT(friction, HasSubstr("# The reference reads contact.friction.K, contact.friction.beta, "
                                  "contact.friction.mu_D too"));
}

TEST(Parameters, TakenOverLeaveTheStoredReferenceValidButForFrictionsLimits) {
  const TemporaryFolder folder;
  std::set<std::string_view> stale;
  for (const char* name : {"ball-on-cube-slide", "mallet-tail-on-cube", "compass-two-pins"}) {
    const scene::Scene scene = scene::load_scene(source_folder() + "/meshes/scenes/" + name + ".toml");
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
  const scene::Scene press = scene::load_scene(source_folder() + "/meshes/scenes/" + "ball-on-cube-press.toml");
  const scene::Scene tuned = with_parameters(press, source_folder() + "/meshes/parameters/ball-on-cube.toml");
  EXPECT_NE(scene::scene_hash(tuned), scene::scene_hash(press));
  EXPECT_EQ(reference::content_key(tuned), reference::content_key(press));
}

TEST(WriteTuning, LeavesAFolderWhoseParametersASceneTakesOver) {
  const TemporaryFolder folder;
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
  // The scene without the constants, and one more line.
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
  EXPECT_TRUE(is_well_formed(html));
  EXPECT_FALSE(shows_not_a_number(html));
  EXPECT_LT(html.find("On held-out contacts"), html.find("On training contacts"));
  for (const char* text_there :
       {"Made &amp; tuned", "Profile of fast.s_c_m2", "Regime map", "Correlation", "What limits"}) {
    EXPECT_THAT(html, HasSubstr(text_there));
  }
  // The findings do not refer to other models, and the first model's are on the page once.
  EXPECT_THAT(html, ::testing::Not(HasSubstr("prototype")));
  const std::string limit = escape_xml(tuning.models.front().limits.front());
  EXPECT_NE(html.find(limit), std::string::npos);
  EXPECT_EQ(html.find(limit), html.rfind(limit));
}

}  // namespace
}  // namespace touchstone::compare
