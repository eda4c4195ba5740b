#include "compare/report/model_table.h"

#include "compare/errors/compute_errors.h"
#include "compare/gate/stored_reference.h"
#include "compare/input/tuning_study.h"
#include "compare/model/skeleton_model.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "support/synthetic.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ModelTable : public ::testing::Test {
 protected:
  ModelTable() { sides_.scene.fast.formulation = scene::Formulation::corrected; }

  [[nodiscard]] std::vector<JudgedModel> judge(const scene::Scene& judged, const std::string& tuned = "") const {
    const fast::Run run = fast::run(judged);
    return judge_models(sides_.scene, judged, run, compute_errors(judged, run, sides_.result.instants), sides_.result,
                        tuned);
  }
  [[nodiscard]] Errors errors_of(const scene::Scene& scene) const {
    return compute_errors(scene, fast::run(scene), sides_.result.instants);
  }
  static std::vector<std::string> keys(const std::vector<JudgedModel>& models) {
    std::vector<std::string> out;
    for (const JudgedModel& model : models) out.push_back(model.key);
    return out;
  }

  testing::Sides sides_ = testing::pressed(6, 400);
};

TEST_F(ModelTable, JudgesThePapersModelTheUntunedAreaLawAndTheScenesOwn) {
  const std::vector<JudgedModel> models = judge(sides_.scene);
  ASSERT_THAT(keys(models), ElementsAre("paper", "area_aware", "scene"));
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
}

TEST_F(ModelTable, TunedConstantsAreARowBesideTheScenesOwn) {
  scene::Scene tuned = with_untuned_area_law(sides_.scene);
  tuned.contact.k1_per_radius_n_per_m2 *= 1.3;
  const std::vector<JudgedModel> models = judge(tuned, "ball.toml");
  ASSERT_THAT(keys(models), ElementsAre("paper", "area_aware", "scene", "tuned"));
  EXPECT_THAT(models[3].name, HasSubstr("ball.toml"));
  EXPECT_EQ(models[3].method, "area-aware, corrected");
  EXPECT_EQ(models[2].method, "Duffing, corrected");
  EXPECT_EQ(models[3].force_nrmse.value, errors_of(tuned).force_nrmse.value);
  EXPECT_EQ(models[2].force_nrmse.value, errors_of(sides_.scene).force_nrmse.value);
}

TEST_F(ModelTable, AModelAppearsOnce) {
  sides_.scene.fast.formulation = scene::Formulation::published;
  EXPECT_THAT(keys(judge(sides_.scene)), ElementsAre("paper", "area_aware"));
  sides_.scene.fast.formulation = scene::Formulation::corrected;
  sides_.scene = with_untuned_area_law(sides_.scene);
  EXPECT_THAT(keys(judge(sides_.scene)), ElementsAre("area_aware"));
  sides_.scene.contact.k1_per_radius_n_per_m2 *= 0.9;
  EXPECT_THAT(keys(judge(sides_.scene)), ElementsAre("area_aware", "scene"));
}

TEST_F(ModelTable, TheUntunedLawFollowsFromTheMaterial) {
  const scene::Scene scene = with_untuned_area_law(as_printed(sides_.scene));
  EXPECT_EQ(scene.contact.law, scene::ContactLaw::area_aware);
  EXPECT_DOUBLE_EQ(scene.contact.k1_per_radius_n_per_m2, 2.0 * 3.0e6 / 0.75);
  EXPECT_EQ(scene.contact.k3_n_per_m3, 0.0);
  EXPECT_NEAR(scene.fast.s_c_m2, 10.0 * 0.06 * 0.06, 1e-12);
  EXPECT_DOUBLE_EQ(with_untuned_area_law(sides_.scene).contact.k1_per_radius_n_per_m2, 5.657e6);
}

TEST(ModelTableText, SaysWhatEachErrorIsRelativeToAndAlignsItsColumns) {
  const std::vector<JudgedModel> models = {
      {"paper", "paper as printed", "Duffing, published", {0.482, 0.0017}, {0.746, {}}, 11.8, 0},
      {"area_aware", "untuned", "area-aware, published", {0.001, 0.0017}, {{}, {}}, 9.0, 0}};
  const std::string text = model_table_text(models);
  EXPECT_THAT(text, HasSubstr("100 %"));
  EXPECT_THAT(text, HasSubstr("48.2"));
  EXPECT_THAT(text, HasSubstr("< 0.17"));
  const std::size_t begin = text.find('\n') + 1;
  const std::string head = text.substr(begin, text.find('\n', begin) - begin);
  EXPECT_TRUE(head.ends_with("step")) << head;
  EXPECT_THAT(model_table_html(models), HasSubstr("<td>paper as printed</td>"));
}

TEST(ModelFigures, HaveAKeyPerModel) {
  const scene::Figures figures = model_figures({{"paper", "", "", {0.482, 0.0017}, {0.746, {}}, 11.8, 0}});
  ASSERT_EQ(figures.size(), 5u);
  EXPECT_EQ(figures[0].key, "model.paper.force.nrmse");
  EXPECT_EQ(figures[0].number, 0.482);
  EXPECT_TRUE(std::isnan(figures[3].number)) << "an unknown uncertainty";
  EXPECT_EQ(figures[3].text, "unknown");
  EXPECT_EQ(figures[4].unit, "us");
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
