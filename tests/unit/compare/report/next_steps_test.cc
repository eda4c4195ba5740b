#include "compare/report/next_steps.h"

#include "compare/errors/compute_errors.h"
#include "compare/format/text.h"
#include "compare/input/tuning_study.h"
#include "compare/model/registry.h"
#include "fast/step/state.h"
#include "scene/base/files.h"
#include "support/source_folder.h"
#include "support/spring.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <regex>

namespace touchstone::compare {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::vector<NextStep> steps_of(const testing::Sides& sides, const ModelEntry& model) {
  return next_steps(sides.scene, sides.run, sides.result, compute_errors(sides.scene, sides.run, sides.result.instants),
                    sides.call, model);
}
std::vector<NextStep> steps_of(const testing::Sides& sides) { return steps_of(sides, fast_model(sides.scene)); }

/// The first step whose reason or command contains this part; an empty one if there is none.
NextStep find(const std::vector<NextStep>& steps, const std::string& part) {
  for (const NextStep& step : steps) {
    if (step.why.find(part) != std::string::npos || step.command.find(part) != std::string::npos) return step;
  }
  return {};
}

/// The synthetic reference with the real result of the fast model.
testing::Sides really_run() {
  testing::Sides sides = testing::pressed(5, 200);
  sides.run = fast::run(sides.scene);
  return sides;
}

TEST(NextSteps, CommandsCanBeTypedAsTheyStand) {
  const Call call{
      "a b/it's.toml", {"track[1].position_m[2]=0.06", "fast.C_n=0.1"}, {.levels = 3, .minutes = 20.0}, {}, {}};
  EXPECT_EQ(command_text(call, " --quiet"),
            "touchstone compare 'a b/it'\\''s.toml' --set 'track[1].position_m[2]=0.06' --set fast.C_n=0.1 --level 3 "
            "--minutes 20 --quiet");
}

TEST(NextSteps, CommandsRepeatEveryOption) {
  Call call{.scene_file = "a.toml"};
  call.reference = {.error = 0.02, .memory_gib = 4.0, .volume = true};
  call.compare = {.parameters = "tuned ball.toml", .models = {"compliance-1", "compliance-2"}, .plots = true};
  EXPECT_EQ(
      command_text(call, ""),
      "touchstone compare a.toml --parameters 'tuned ball.toml' --model compliance-1 --model compliance-2 --plots "
      "--error 0.02 --memory-gib 4 --volume");
}

TEST(NextSteps, OfferTheAreaAwareLawWhereItIsNearerAndSayByHowMuch) {
  const testing::Sides sides = really_run();
  const NextStep step = find(steps_of(sides), "area-aware law");
  EXPECT_EQ(step.command,
            "touchstone compare meshes/scenes/ball-on-cube-press.toml --parameters "
            "out/ball-on-cube-press-compare/area-aware.toml --level 3 --out "
            "out/ball-on-cube-press-compare-area-aware");
  // The command gives the errors that were promised.
  const testing::TemporaryFolder folder;
  scene::write_file(folder.path() / step.file_name, step.file_text);
  const scene::Scene changed = with_parameters(sides.scene, folder.path() / step.file_name);
  EXPECT_EQ(changed.contact.law, scene::ContactLaw::area_aware);
  EXPECT_NEAR(changed.fast.s_c_m2, 0.036, 1e-9);
  const Errors after = compute_errors(changed, fast::run(changed), sides.result.instants);
  EXPECT_THAT(step.why, HasSubstr("to " + percent_text(*after.force_nrmse.value) + ", shape error from "));
  EXPECT_THAT(step.why, HasSubstr("to " + percent_text(*after.shape_rel_l2.value) + "."));
}

TEST(NextSteps, DoNotOfferWhatIsNoBetter) {
  testing::Sides sides = really_run();
  for (std::size_t t = 0; t < sides.run.instants.size(); ++t) {
    static_cast<scene::InstantRecord&>(sides.result.instants[t]) = sides.run.instants[t];
  }
  EXPECT_EQ(find(steps_of(sides), "area-aware").command, "");
  EXPECT_EQ(find(steps_of(sides), "s_c_m2").command, "");
  EXPECT_EQ(find(steps_of(sides), "touchstone tune").command, "");
}

TEST(NextSteps, FindBeamsStiffEnough) {
  testing::Sides sides = really_run();
  sides.scene.fast.s_c_m2 = 1e-6;
  sides.run = fast::run(sides.scene);
  ASSERT_NE(sides.run.status & static_cast<std::uint32_t>(fast::StepStatus::anchors_limited), 0u);
  const NextStep step = find(steps_of(sides), "fast.s_c_m2");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(step.command, found, std::regex("fast.s_c_m2=([0-9.e-]+)$"))) << step.command;
  sides.scene.fast.s_c_m2 = std::stod(found[1]);
  EXPECT_EQ(fast::run(sides.scene).status & static_cast<std::uint32_t>(fast::StepStatus::anchors_limited), 0u);
  EXPECT_THAT(step.why, HasSubstr("Take stiffer beams."));
}

TEST(NextSteps, AskForThreeMeshesWhereTheUncertaintyIsUnknown) {
  testing::Sides sides = testing::pressed(5, 200);
  EXPECT_EQ(find(steps_of(sides), "uncertainty").why, "");
  sides.scene.reference.levels = 1;
  sides.call.reference.levels = 1;
  sides.result.levels.resize(1);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(find(steps_of(sides), "three meshes").command, "touchstone compare meshes/scenes/ball-on-cube-press.toml");
}

TEST(NextSteps, AskForMoreOfWhatWasShort) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.scene.reference.levels.reset();
  sides.call.reference = {};
  sides.result.levels.resize(2);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  sides.result.refinement.ended_by = reference::EndedBy::time;
  EXPECT_THAT(find(steps_of(sides), "more time").command, HasSubstr(" --minutes 240"));
  sides.call.reference.minutes = 300.0;
  EXPECT_THAT(find(steps_of(sides), "more time").command, HasSubstr(" --minutes 1200"));
  sides.result.refinement.ended_by = reference::EndedBy::memory;
  EXPECT_EQ(find(steps_of(sides), "more time").command, "");
  EXPECT_THAT(find(steps_of(sides), "--memory-gib").why, HasSubstr("reference.element_size_m"));
}

TEST(NextSteps, DoNotRefineWhereNoMeshHelps) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.scene.reference.levels.reset();
  sides.call.reference = {};
  sides.run.instants.assign(sides.result.instants.begin(),
                            sides.result.instants.end());  // then no error is larger than the uncertainty
  EXPECT_THAT(find(steps_of(sides), "Refine the reference").command, HasSubstr(" --error "));
  sides.result.refinement.ended_by = reference::EndedBy::sensitivity;
  EXPECT_EQ(find(steps_of(sides), "Refine the reference").command, "");
}

TEST(NextSteps, NameTheStudyThatTrainsOnTheScene) {
  const testing::TemporaryFolder folder;
  testing::Sides sides = really_run();
  sides.call.scene_file = folder.path() / "ball-on-cube-press.toml";
  EXPECT_THAT(find(steps_of(sides), "Tune").why, HasSubstr("a study of this scene"));
  sides.call.scene_file = source_folder() + "/meshes/scenes/ball-on-cube-press.toml";
  EXPECT_THAT(find(steps_of(sides), "Tune").command, ::testing::EndsWith("/meshes/studies/ball-on-cube.toml"));
  sides.call.compare.parameters = "tuned.toml";
  EXPECT_EQ(find(steps_of(sides), "Tune").why, "");
}

TEST(NextSteps, AreTheModelsOwn) {
  const testing::Sides sides = really_run();
  const std::vector<NextStep> steps = steps_of(sides, testing::springs({.scene = sides.scene}).front());
  EXPECT_THAT(find(steps, "another spring").command, HasSubstr(" --set contact.k1_n_per_m=80.0"));
  EXPECT_EQ(find(steps, "area-aware").command, "");
}

/// A run that is given.
class Given final : public ContactModel {
 public:
  explicit Given(fast::Run run) : run_(std::move(run)) {}
  void step(const scene::Pose&) override {}
  void answer(scene::Answer&) override {}
  [[nodiscard]] int size() const override { return 1; }
  [[nodiscard]] std::optional<fast::Run> track() override { return run_; }

 private:
  fast::Run run_;
};

TEST(NextSteps, TuneTheResponseModelsFalloffWhereOneGivesSmallerErrors) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.scene.fast.formulation = scene::Formulation::response;
  sides.scene.body.inclusions.emplace_back();
  sides.call.scene_file = source_folder() + "/meshes/scenes/ellipsoid-pvc-inside.toml";
  ModelEntry model = fast_model(sides.scene);
  model.set_up = [&](const scene::Scene& scene) {
    fast::Run run = sides.run;
    if (scene.fast.body_falloff_per_m > 500.0) {
      run.instants.assign(sides.result.instants.begin(), sides.result.instants.end());
    }
    return std::make_unique<Given>(run);
  };
  const NextStep step = find(steps_of(sides, model), "Tune");
  EXPECT_THAT(step.why, AllOf(HasSubstr("Tune fast.body_falloff_per_m to the reference on this and other contacts. "),
                              HasSubstr("% to 0\u00a0%, shape error from"), ::testing::EndsWith("% to 0\u00a0%.")));
  EXPECT_THAT(step.command, ::testing::EndsWith("/meshes/studies/soft-ball.toml"));
  // A study of the same scene that fits nothing of this model is not named.
  sides.call.scene_file = source_folder() + "/meshes/scenes/ball-on-cube-press.toml";
  EXPECT_THAT(find(steps_of(sides, model), "Tune").why, HasSubstr("meshes/studies/soft-ball.toml is an example."));
  model.set_up = [&](const scene::Scene&) { return std::make_unique<Given>(sides.run); };
  EXPECT_EQ(find(steps_of(sides, model), "Tune").why, "") << "no value is better";
  sides.scene.body.inclusions.clear();
  EXPECT_EQ(find(steps_of(sides, fast_model(sides.scene)), "Tune").why, "") << "it has no other constant";
}

TEST(NextSteps, SayHowFarTheTrackPassesTheBody) {
  testing::Sides sides = testing::pressed(2, 200);
  for (std::size_t t = 0; t < 2; ++t) {
    scene::InstantRecord& record = sides.run.instants[t];
    record.depth_m = 0.0;
    record.separation_m = 0.004 - 0.001 * static_cast<double>(t);
    record.regions.clear();
    static_cast<scene::InstantRecord&>(sides.result.instants[t]) = record;
    sides.result.instants[t].displacement_m.setZero();
  }
  const std::vector<NextStep> steps = steps_of(sides);
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_THAT(steps[0].why, HasSubstr("the tool is 3\u00a0mm away"));
}

TEST(NextSteps, NeedASceneFile) {
  testing::Sides sides = really_run();
  sides.call = {};
  EXPECT_TRUE(steps_of(sides).empty());
}

}  // namespace
}  // namespace touchstone::compare
