#include "compare/model/judge.h"

#include "compare/errors/compute_errors.h"
#include "compare/gate/stored_reference.h"
#include "compare/input/tuning_study.h"
#include "compare/model/registry.h"
#include "compare/model/skeleton_model.h"
#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "support/spring.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class JudgeModels : public ::testing::Test {
 protected:
  JudgeModels() { sides_.scene.fast.formulation = scene::Formulation::corrected; }

  [[nodiscard]] std::vector<JudgedModel> judge(const Contenders& contenders, const JudgedModel& own = {}) const {
    return judge_models(contenders, sides_.run.surface, sides_.result.instants, own);
  }
  /// Those of every comparison, but for the one that computes the body's response.
  [[nodiscard]] Contenders skeletons(const std::vector<std::filesystem::path>& parameters = {}) const {
    Contenders out = contenders(sides_.scene, parameters);
    std::erase_if(out.models, [](const ModelEntry& entry) { return entry.family == ModelFamily::response; });
    return out;
  }
  [[nodiscard]] std::vector<std::string> keys() const {
    std::vector<std::string> out;
    for (const ModelEntry& entry : contenders(sides_.scene).models) out.push_back(entry.key);
    return out;
  }
  [[nodiscard]] Errors errors_of(const scene::Scene& scene) const {
    return compute_errors(scene, fast::run(scene), sides_.result.instants);
  }

  testing::Sides sides_ = testing::pressed(6, 400);
  testing::TemporaryFolder folder_;
};

TEST_F(JudgeModels, ThePapersModelTheUntunedAreaLawAndTheScenesOwn) {
  Contenders all = skeletons();
  const std::vector<JudgedModel> with_own = judge(all, {.force_nrmse = {0.5, {}}, .trouble = "tired"});
  for (ModelEntry& entry : all.models) entry.own = false;
  const std::vector<JudgedModel> models = judge(all);
  ASSERT_THAT(keys(), ElementsAre("paper", "area_aware", "response", "scene"));
  const Errors paper = errors_of(as_printed(sides_.scene));
  const Errors area = errors_of(with_untuned_area_law(sides_.scene));
  EXPECT_EQ(models[0].force_nrmse.value, paper.force_nrmse.value);
  EXPECT_EQ(models[0].shape_rel_l2.value, paper.shape_rel_l2.value);
  EXPECT_EQ(models[1].force_nrmse.value, area.force_nrmse.value);
  EXPECT_EQ(models[1].force_nrmse.uncertainty, area.force_nrmse.uncertainty);
  EXPECT_EQ(models[1].shape_rel_l2.value, area.shape_rel_l2.value);
  EXPECT_NE(models[0].force_nrmse.value, models[1].force_nrmse.value);
  EXPECT_EQ(models[2].shape_rel_l2.value, errors_of(sides_.scene).shape_rel_l2.value);
  EXPECT_GT(models[1].step_p50_us, 0.0);
  // The page's own model is not judged again.
  EXPECT_EQ(with_own[2].key, "scene");
  EXPECT_EQ(*with_own[2].force_nrmse.value, 0.5);
  EXPECT_EQ(with_own[2].trouble, "tired");
  EXPECT_EQ(with_own[1].force_nrmse.value, models[1].force_nrmse.value);
}

TEST_F(JudgeModels, TunedConstantsAreARowBesideTheScenesOwn) {
  const std::filesystem::path file = folder_.path() / "ball.toml";
  scene::write_file(file, "[contact]\nlaw = \"area_aware\"\nk1_per_radius_n_per_m2 = 7.0e6\nk3_n_per_m3 = 0.0\n");
  Contenders all = skeletons({file});
  EXPECT_TRUE(all.models.back().own);
  all.models.back().own = false;
  const std::vector<JudgedModel> models = judge(all);
  ASSERT_EQ(models.size(), 4u);
  EXPECT_EQ(models[3].key, "tuned");
  EXPECT_EQ(models[3].name, "tuned: ball.toml");
  EXPECT_EQ(models[3].method, "area-aware, corrected");
  EXPECT_EQ(models[2].method, "Duffing, corrected");
  EXPECT_EQ(models[3].force_nrmse.value, errors_of(with_parameters(sides_.scene, file)).force_nrmse.value);
  EXPECT_EQ(models[2].force_nrmse.value, errors_of(sides_.scene).force_nrmse.value);
}

TEST_F(JudgeModels, AModelAppearsOnce) {
  sides_.scene.fast.formulation = scene::Formulation::published;
  EXPECT_THAT(keys(), ElementsAre("paper", "area_aware", "response"));
  sides_.scene.fast.formulation = scene::Formulation::corrected;
  sides_.scene = with_untuned_area_law(sides_.scene);
  EXPECT_THAT(keys(), ElementsAre("area_aware", "response"));
  sides_.scene.contact.k1_per_radius_n_per_m2 *= 0.9;
  EXPECT_THAT(keys(), ElementsAre("area_aware", "response", "scene"));
  sides_.scene.fast.formulation = scene::Formulation::response;
  EXPECT_THAT(keys(), ElementsAre("area_aware", "response"));
  EXPECT_TRUE(contenders(sides_.scene).models.back().own);
}

TEST_F(JudgeModels, TheResponseModelIsOneOfThem) {
  sides_.scene.fast.store = folder_.path();
  Contenders all = contenders(sides_.scene, {}, {"response"});
  EXPECT_EQ(std::ranges::count(all.models, "response", &ModelEntry::key), 1);
  std::erase_if(all.models, [](const ModelEntry& entry) { return entry.family != ModelFamily::response; });
  const JudgedModel model = judge(all).front();
  EXPECT_EQ(model.absent, "");
  EXPECT_EQ(model.name, "response, untuned");
  EXPECT_TRUE(model.force_nrmse.value && model.shape_rel_l2.value);
  EXPECT_GT(model.step_p50_us, 0.0);
  // A scene that it cannot answer.
  sides_.scene.tool.shape = scene::ToolShape::box;
  all.scene = sides_.scene;
  EXPECT_THAT(judge(all).front().absent, HasSubstr("its tool is a ball"));
}

TEST_F(JudgeModels, AModelThatNobodyHereKnows) {
  const std::vector<JudgedModel> models =
      judge({sides_.scene, list_models({.scene = sides_.scene}, {testing::springs})});
  ASSERT_EQ(models.size(), 2u);
  EXPECT_EQ(models[0].key, "spring");
  EXPECT_DOUBLE_EQ(*models[0].shape_rel_l2.value, 1.0);  // a body that never moves
  EXPECT_GT(*models[0].force_nrmse.value, 0.0);
  EXPECT_TRUE(models[0].force_nrmse.uncertainty);
  EXPECT_GT(models[0].step_p50_us, 0.0);
  EXPECT_EQ(models[1].absent, "it broke");
  EXPECT_FALSE(models[1].force_nrmse.value);
}

TEST_F(JudgeModels, ForcesOfAModelThatGivesNoneAreNotJudged) {
  ModelEntry spring = testing::springs({.scene = sides_.scene}).front();
  spring.gives_force = false;
  const JudgedModel model = judge({sides_.scene, {spring}}).front();
  EXPECT_FALSE(model.force_nrmse.value);
  EXPECT_TRUE(model.shape_rel_l2.value);
}

TEST_F(JudgeModels, FurtherModelsAreNamedByTheirKeys) {
  EXPECT_EQ(contenders(sides_.scene, {}, {"compliance-2"}).models.back().name, "compliance 2");
  EXPECT_THAT([&] { (void)contenders(sides_.scene, {}, {"compliance-3"}); },
              ThrowsMessage<scene::InputError>(AllOf(HasSubstr("no model has the key \"compliance-3\""),
                                                     HasSubstr("published-duffing, "), HasSubstr("did you mean"))));
  EXPECT_THAT([&] { (void)contenders(sides_.scene, {}, {"anchors"}); },
              ThrowsMessage<scene::InputError>(HasSubstr("model \"anchors\" is absent: the anchor points follow")));
}

TEST_F(JudgeModels, TheUntunedLawFollowsFromTheMaterial) {
  const scene::Scene scene = with_untuned_area_law(as_printed(sides_.scene));
  EXPECT_EQ(scene.contact.law, scene::ContactLaw::area_aware);
  EXPECT_DOUBLE_EQ(scene.contact.k1_per_radius_n_per_m2, 2.0 * 3.0e6 / 0.75);
  EXPECT_EQ(scene.contact.k3_n_per_m3, 0.0);
  EXPECT_NEAR(scene.fast.s_c_m2, 10.0 * 0.06 * 0.06, 1e-12);
  EXPECT_DOUBLE_EQ(with_untuned_area_law(sides_.scene).contact.k1_per_radius_n_per_m2, 5.657e6);
}

TEST(FastModel, TellsAllOfItsRun) {
  const scene::Scene scene = testing::ball_on_cube(3, 200);
  const std::unique_ptr<ContactModel> model = fast_model(scene).set_up(scene);
  const std::optional<fast::Run> run = model->track();
  scene::Answer answer = unanswered(scene);
  model->answer(answer);
  ASSERT_TRUE(run);
  ASSERT_EQ(answer.instants.size(), run->instants.size());
  for (std::size_t t = 0; t < answer.instants.size(); ++t) {
    EXPECT_EQ(answer.instants[t].force_n(), run->instants[t].force_n());
    EXPECT_EQ(answer.instants[t].displacement_m, run->instants[t].displacement_m);
  }
  EXPECT_NE(scene::find_figure(model->figures(), "fast.step_us.p50"), nullptr);
  EXPECT_GT(*model->step_p50_us(), 0.0);
  EXPECT_FALSE(testing::Spring(1.0).track());
}

TEST(ShippedParameters, AreTunedToTheBallOnTheCube) {
  const std::filesystem::path source = source_folder();
  const scene::Scene scene = with_parameters(scene::load_scene(source / "meshes/scenes/ball-on-cube-press.toml", {}),
                                             source / "meshes/parameters/ball-on-cube.toml");
  const fast::Run run = fast::run(scene);
  const Errors errors = compute_errors(
      scene, run, stored_reference(source / "tests/gates/reference/ball-on-cube-press", scene, run.surface).instants);
  EXPECT_LT(*errors.force_nrmse.value, 0.02);
  EXPECT_LT(*errors.shape_rel_l2.value, 0.67);
}

}  // namespace
}  // namespace touchstone::compare
