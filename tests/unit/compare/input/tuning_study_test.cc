// Tuning studies: their meaning, and the messages about faulty ones.
#include "compare/input/tuning_study.h"

#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "unit/compare/input/study_file_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

using namespace scene;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string scenes = source_folder() + "/meshes/scenes/";
const std::string head = "kind = \"tuning\"\n";
const std::string training = "[[training]]\nname = \"middle\"\nscene = \"" + scenes + "ball-on-cube-press.toml\"\n";
const std::string held_out = "[[held_out]]\nname = \"larger\"\ndiffers = \"tool\"\nscene = \"" + scenes +
                             "ball-on-cube-press.toml\"\nset = { tool.radius_m = 0.0104 }\ndepth_m = [0.001, 0.003]\n";
const std::string stiffness = "[[parameter]]\nkey = \"contact.k1_n_per_m\"\nbounds = [1.0e3, 1.0e7]\n";

class TuningStudyTest : public StudyFileTest {
 protected:
  TuningStudy read(const std::string& text) { return load_tuning_study(written(text)); }
  std::string refusal(const std::string& text) {
    return refusal_of([&] { (void)read(text); });
  }
};

TEST_F(TuningStudyTest, HoldsContactsParametersAndWhatFollowsFromThem) {
  const TuningStudy study =
      read(head + "[set]\ncompare.instants = 7\n" + training + held_out + stiffness +
           "[[parameter]]\nkey = \"contact.k3_n_per_m3\"\nbounds = [-1.0e8, 3.0e8]\nstart = 1.0e7\n"
           "[[parameter]]\nkey = \"fast.r_R_m\"\nbounds = [0.005, 0.03]\nscale = \"linear\"\n");
  ASSERT_EQ(study.training.size(), 1u);
  ASSERT_EQ(study.held_out.size(), 1u);
  EXPECT_EQ(study.training[0].scene.compare.instants, 7);
  EXPECT_EQ(study.held_out[0].scene.compare.instants, 7);
  EXPECT_EQ(study.held_out[0].scene.tool.radius_m, 0.0104);
  EXPECT_EQ(study.held_out[0].differs, "tool");
  EXPECT_THAT(study.held_out[0].depth_m, ElementsAre(0.001, 0.003));
  EXPECT_THAT(study.formulations, ElementsAre(Formulation::corrected));
  EXPECT_THAT(study.laws, ElementsAre(ContactLaw::duffing));
  ASSERT_EQ(study.parameters.size(), 3u);
  EXPECT_TRUE(study.parameters[0].log);
  EXPECT_NEAR(study.parameters[0].start, 1.0e5, 1e-6);
  EXPECT_FALSE(study.parameters[1].log);
  EXPECT_EQ(study.parameters[1].start, 1.0e7);
  EXPECT_EQ(study.parameters[1].stage, TuningStage::force);
  EXPECT_EQ(study.parameters[2].stage, TuningStage::shape);
  EXPECT_TRUE(study.parameters[2].profile);
  EXPECT_FALSE(study.parameters[0].profile);
}

TEST_F(TuningStudyTest, TellsEveryFaultWithItsPlaceAndWhatWasExpected) {
  EXPECT_THAT(refusal("kind = \"sweep\"\n" + training + held_out + stiffness),
              HasSubstr("1:8: kind = \"sweep\"; expected \"tuning\""));
  EXPECT_THAT(refusal(head + held_out + stiffness), HasSubstr("expected at least one [[training]] row"));
  EXPECT_THAT(refusal(head + training + stiffness), HasSubstr("expected at least one [[held_out]] row"));
  EXPECT_THAT(refusal(head + training + held_out), HasSubstr("expected at least one [[parameter]] row"));
  EXPECT_THAT(refusal(head + training + held_out + "[[parameter]]\nkey = \"contact.k1\"\nbounds = [1.0, 2.0]\n"),
              HasSubstr("12:7: parameter.key = \"contact.k1\" cannot be tuned; did you mean \"contact.k1_n_per_m\"?"));
  EXPECT_THAT(
      refusal(head + training + held_out + "[[parameter]]\nkey = \"fast.C_n\"\nbounds = [-0.1, 0.2]\n"),
      HasSubstr("13:10: parameter.bounds = [-0.1, 0.2]; expected [low, high], low below high, each in [0, 1000]"));
  EXPECT_THAT(refusal(head + training + held_out + "[[parameter]]\nkey = \"fast.C_n\"\nbounds = [0.2, 0.1]\n"),
              HasSubstr("low below high"));
  EXPECT_THAT(refusal(head + training + held_out + stiffness + "start = 1.0\n"),
              HasSubstr("start = 1.0; expected a number in [1000, 1e+07]"));
  EXPECT_THAT(
      refusal(head + training + held_out + "[[parameter]]\nkey = \"fast.C_n\"\nbounds = [0.0, 0.1]\nscale = \"log\"\n"),
      HasSubstr("expected bounds above 0"));
  EXPECT_THAT(refusal(head + training + held_out + stiffness + stiffness), HasSubstr("stands for the same constant"));
  EXPECT_THAT(refusal(head + training + held_out + stiffness +
                      "[[parameter]]\nkey = \"contact.omega0_squared_per_s2\"\nbounds = [1.0, 2.0]\n"),
              HasSubstr("stands for the same constant"));
  EXPECT_THAT(refusal(head + training + held_out + stiffness +
                      "[[parameter]]\nkey = \"contact.friction.K\"\nbounds = [0.1, 2.0]\n"),
              HasSubstr("parameter.key = \"contact.friction.K\" only applies with [contact.friction] given; expected a "
                        "training contact with it"));
  EXPECT_THAT(refusal(head + training + held_out + "[[parameter]]\nkey = \"fast.r_th_m\"\nbounds = [0.001, 0.01]\n"),
              HasSubstr("12:7: parameter.key = \"fast.r_th_m\" cannot be tuned; fast.r_th_m is contact.r_th_m now"));
  for (const char* key : {"contact.r_th_m", "contact.law", "body.material.youngs_modulus_pa"}) {
    EXPECT_THAT(refusal(head + training + held_out + "[[parameter]]\nkey = \"" + key + "\"\nbounds = [0.1, 0.2]\n"),
                HasSubstr(std::string("parameter.key = \"") + key + "\" cannot be tuned; did you mean"));
  }
  EXPECT_THAT(refusal(head + "formulation = \"published\"\n" + training + held_out + stiffness +
                      "[[parameter]]\nkey = \"contact.friction.stiffness_ratio\"\nbounds = [0.1, 2.0]\n"),
              HasSubstr("has no meaning under the models of this study"));
  EXPECT_THAT(refusal(head + "law = \"area_aware\"\n" + training + held_out + stiffness),
              HasSubstr("2:7: law: the scenes have no linear constant for \"area_aware\""));
  EXPECT_THAT(refusal(head + "laws = \"duffing\"\n" + training + held_out + stiffness),
              HasSubstr("did you mean \"law\"?"));
  EXPECT_THAT(refusal(head + training + "set = { tool.radius_m = -1.0 }\n" + held_out + stiffness),
              HasSubstr("5:25: tool.radius_m = -1.0; expected a number in"));
}

TEST_F(TuningStudyTest, WritesAParameterWhereTheSceneKeepsIt) {
  Scene scene;
  scene.tool.mass_kg = 2.0;
  set_parameter(scene, "contact.omega0_squared_per_s2", 5.0);
  set_parameter(scene, "contact.epsilon_beta0_squared_per_m2_s2", 8.0);
  set_parameter(scene, "fast.s_c_m2", 0.5);
  EXPECT_EQ(scene.contact.k1_n_per_m, 10.0);
  EXPECT_EQ(scene.contact.k3_n_per_m3, 12.0);
  EXPECT_EQ(scene.fast.s_c_m2, 0.5);
}

TEST_F(TuningStudyTest, WritesNothingWhereTheKeyDoesNotApply) {
  Scene scene;
  set_parameter(scene, "contact.friction.K", 2.0);
  set_parameter(scene, "contact.k1_per_radius_n_per_m2", 2.0);
  EXPECT_FALSE(scene.contact.friction.has_value());
  EXPECT_EQ(scene.contact.k1_per_radius_n_per_m2, 0.0);
}

TEST_F(TuningStudyTest, AFileOfParametersGoesOverAScene) {
  const Scene scene = load_scene(scenes + "ball-on-cube-press.toml");
  const auto over = [&](const std::string& text) { return with_parameters(scene, written(text)); };
  // In any order: the law decides which constants apply. Friction's are ignored in a scene without friction.
  const Scene tuned = over(
      "[contact]\nk1_per_radius_n_per_m2 = 5.0e6\nlaw = \"area_aware\"\n[contact.friction]\n"
      "K = 0.3\n[fast]\nC_n = 0.1\nformulation = \"published\"\n");
  EXPECT_EQ(tuned.contact.law, ContactLaw::area_aware);
  EXPECT_EQ(tuned.contact.k1_per_radius_n_per_m2, 5.0e6);
  EXPECT_EQ(tuned.contact.k3_n_per_m3, scene.contact.k3_n_per_m3);
  EXPECT_FALSE(tuned.contact.friction.has_value());
  EXPECT_EQ(tuned.fast.formulation, Formulation::published);
  EXPECT_EQ(tuned.fast.C_n, 0.1);
  EXPECT_EQ(over("[contact]\nomega0_squared_per_s2 = 7.0\n").contact.k1_n_per_m, 7.0 * scene.tool.mass_kg);
  const auto refused = [&](const std::string& text) { return refusal_of([&] { (void)over(text); }); };
  EXPECT_THAT(refused("[contact]\nlaw = \"area_aware\"\nk1_n_per_m = 5.0\n"),
              HasSubstr("contact.law is not the scene's, and its constant is missing; expected "
                        "contact.k1_per_radius_n_per_m2"));
  EXPECT_THAT(refused("[contact]\nlaw = \"hertz\"\n"), HasSubstr("2:7: law = \"hertz\"; expected \"duffing\" or"));
  EXPECT_THAT(refused("[fast]\nC_n = -1.0\n"), HasSubstr("2:7: fast.C_n = -1.0; expected a number in [0, 1000]"));
  EXPECT_THAT(refused("[fast]\nC_n = 0.1\nr_th_m = 0.004\n"),
              HasSubstr("3:1: fast.r_th_m is contact.r_th_m now, because the reference reads it too: set it in the "
                        "scene"));
  for (const char* line : {"[contact]\nr_th_m = 0.004\n", "[body]\nsize_m = 1.0\n", "[fast]\ntriangles = 400\n"})
    EXPECT_THAT(refused(line), HasSubstr("2:1: \"")) << line;
}

TEST(TuningStudyModels, OnlyTheCorrectedOneHasFrictionsStiffnessRatio) {
  TuningParameter ratio, limit;
  ratio.key = "contact.friction.stiffness_ratio";
  limit.key = "contact.friction.K";
  EXPECT_TRUE(applies(ratio, Formulation::corrected, ContactLaw::area_aware));
  EXPECT_FALSE(applies(ratio, Formulation::published, ContactLaw::area_aware));
  EXPECT_TRUE(applies(limit, Formulation::published, ContactLaw::duffing));
}

TEST_F(TuningStudyTest, OfTheResponseModelOnlyTheBodysFalloffIsTuned) {
  const auto contact = [](const std::string& row, const std::string& scene, const std::string& set = "") {
    return row + "scene = \"" + scenes + scene + "\"\nset = { compare.instants = 5" + set + " }\n";
  };
  const std::string train = "[[training]]\nname = \"above\"\n",
                    judge = "[[held_out]]\nname = \"plain\"\ndiffers = \"body\"\n";
  const std::string falloff = "[[parameter]]\nkey = \"fast.body_falloff_per_m\"\nbounds = [50.0, 1.0e3]\n";
  const std::string response = head + "formulation = \"response\"\n", soft = "ellipsoid-pvc-inside.toml",
                    rubber = "ellipsoid-rubber.toml";
  const TuningStudy study = read(response + contact(train, soft) + contact(judge, rubber) + falloff);
  EXPECT_THAT(study.formulations, ElementsAre(Formulation::response));
  ASSERT_EQ(study.parameters.size(), 1u);
  EXPECT_EQ(study.parameters[0].unit, "1/m");
  EXPECT_TRUE(applies(study.parameters[0], Formulation::response, ContactLaw::duffing));
  EXPECT_FALSE(applies(study.parameters[0], Formulation::corrected, ContactLaw::duffing));
  TuningParameter other = study.parameters[0];
  other.key = "contact.k1_n_per_m";
  EXPECT_FALSE(applies(other, Formulation::response, ContactLaw::duffing));
  // It is not the plain body's.
  Scene written = study.held_out[0].scene;
  set_parameter(written, "fast.body_falloff_per_m", 200.0);
  EXPECT_EQ(written.fast.body_falloff_per_m, 0.0);

  const auto with = [&](const std::string& set, const std::string& parameter) {
    return refusal(response + contact(train, soft, set) + contact(judge, rubber) + parameter);
  };
  EXPECT_THAT(with("", stiffness), HasSubstr("has no meaning under the models of this study"));
  EXPECT_THAT(with(", \"track[0].position_m[2]\" = 0.2, \"track[1].position_m[2]\" = 0.2", falloff),
              HasSubstr("the response model needs that the tool touches the body; contact \"above\""));
  EXPECT_THAT(refusal(response + contact(train, rubber) + contact(judge, rubber) + falloff),
              HasSubstr("only applies with at least one [[body.inclusion]]; expected a training contact with it"));
  EXPECT_THAT(refusal(head + contact(train, soft) + contact(judge, rubber) + falloff),
              HasSubstr("has no meaning under the models of this study"));
  EXPECT_THAT(refusal(head + "formulation = \"exact\"\n" + contact(train, soft) + contact(judge, rubber) + falloff),
              HasSubstr("expected \"published\" or \"corrected\" or \"response\""));
}

TEST(ShippedTuningStudies, HaveScenesWithoutFaultAndContactsHeldOut) {
  for (const char* name : {"ball-on-cube", "ellipsoid", "friction", "mallet", "inclusion", "soft-ball"}) {
    const TuningStudy study = load_tuning_study(source_folder() + "/meshes/studies/" + std::string(name) + ".toml");
    EXPECT_FALSE(study.training.empty()) << name;
    EXPECT_FALSE(study.held_out.empty()) << name;
  }
}

}  // namespace
}  // namespace touchstone::compare
