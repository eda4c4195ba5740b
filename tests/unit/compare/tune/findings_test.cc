#include "compare/tune/findings.h"

#include "compare/tune/tune_results.h"
#include "support/spring.h"
#include "unit/compare/tune/made_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

using namespace testing;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(Findings, SayWhatTheDataCannotDetermine) {
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

TEST(Findings, NameAnActiveBoundInEveryAnswer) {
  const Tuning tuning = tune(study({free("contact.k1_n_per_m", 1e2, 1e4), free("contact.k3_n_per_m3", 1e7, 1e11)}),
                             made_with({{"contact.k1_n_per_m", 3.0e4}, {"contact.k3_n_per_m3", 2.0e9}}));
  const TunedModel& model = tuning.models.at(0);
  EXPECT_EQ(found(model, "contact.k1_n_per_m").at_bound, AtBound::high);
  EXPECT_THAT(model.stages.at(0).notes, Contains(HasSubstr("contact.k1_n_per_m ended at its upper bound")));
  const scene::Figures figures = tuning_figures(tuning);
  const scene::Figure* error = scene::find_figure(figures, "parameter.contact.k1_n_per_m.error_rel");
  ASSERT_NE(error, nullptr);
  EXPECT_EQ(error->text, "none: at its upper bound");
}

TEST(Findings, SayWhatThePartsOfTheShapeAreGoodFor) {
  const auto constants = std::map<std::string, double>{{"contact.k1_n_per_m", 900.0}, {"fast.s_c_m2", 6.0e-3}};
  const Tuning tuning =
      tune(study({free("contact.k1_n_per_m", 1e1, 1e5), free("fast.s_c_m2", 1e-4, 1e-1, TuningStage::shape)}),
           made_with(constants));
  const TunedModel& model = tuning.models.at(0);
  ASSERT_EQ(model.shape_parts.size(), 4u);
  const double whole = model.shape_parts[0];
  EXPECT_NEAR(whole, *model.outcomes.at(0).errors.shape_rel_l2.value, 1e-9);
  // The reference has both parts.
  for (std::size_t k = 1; k < 4; ++k) EXPECT_GT(model.shape_parts[k], whole + 0.01) << k;
  EXPECT_THAT(model.limits.back(), HasSubstr("Shape error by parts of the model, on the training contact \"pole\""));
}

TEST(Findings, AreInTheWordsOfTheModel) {
  const Tuning tuning = tune(study({free("contact.k1_n_per_m", 1e1, 1e5)}), made_with({}), {},
                             [](const scene::Scene& scene) { return springs({.scene = scene}).front(); });
  const TunedModel& model = tuning.models.at(0);
  EXPECT_THAT(model.limits, Contains(HasSubstr("of the squared error lies, and a spring is nowhere else.")));
  EXPECT_THAT(model.limits.back(), HasSubstr("on the training contact \"pole\": 100\u00a0% with the spring."));
  EXPECT_NE(scene::find_figure(tuning_figures(tuning), "spring.training.shape_parts.whole"), nullptr);
}

}  // namespace
}  // namespace touchstone::compare
