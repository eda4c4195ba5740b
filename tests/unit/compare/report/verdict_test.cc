#include "compare/report/verdict.h"

#include "compare/errors/compute_errors.h"
#include "compare/model/registry.h"
#include "compare/model/skeleton_model.h"
#include "fast/step/state.h"
#include "support/spring.h"
#include "support/synthetic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace touchstone::compare {
namespace {

using testing::set_force;

/// All paragraphs in one line, ordinary spaces.
std::string told(const testing::Sides& sides) {
  const Errors errors = compute_errors(sides.scene, sides.run, sides.result.instants);
  const Verdict all = verdict(sides.scene, sides.run, sides.result, errors, {}, fast_model(sides.scene));
  std::string text = all.force + "\n" + all.shape + "\n";
  for (const Reason& reason : all.reasons) text += reason.about + ": " + reason.text() + "\n";
  for (std::size_t at = text.find("\u00a0"); at != std::string::npos; at = text.find("\u00a0"))
    text.replace(at, 2, " ");
  return text;
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Verdict, HertzIsFourThirdsOfTheContactModulus) {
  scene::Scene scene = testing::ball_on_cube(2, 8);
  EXPECT_NEAR(hertz_force_n(scene, 0.001).value(), 4.0 / 3.0 * 4.0e6 * 0.1 * std::pow(0.001, 1.5), 1e-9);
  scene.body.shape = scene::BodyShape::sphere;
  scene.body.radius_m = 0.030;
  EXPECT_NEAR(hertz_force_n(scene, 0.001).value(), 4.0 / 3.0 * 4.0e6 * std::sqrt(0.0075) * std::pow(0.001, 1.5), 1e-9);
  const double on_ball_n = hertz_force_n(scene, 0.001).value();
  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = scene::Vec3::Constant(0.030);
  EXPECT_NEAR(hertz_force_n(scene, 0.001).value(), on_ball_n, 1e-12 * on_ball_n);
  scene.body.inclusions.emplace_back();
  EXPECT_FALSE(hertz_force_n(scene, 0.001));
}

TEST(Verdict, DoesNotTakeAnotherToolForABall) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.scene.tool.shape = scene::ToolShape::cylinder;
  sides.scene.tool.length_m = 0.02;
  EXPECT_FALSE(hertz_force_n(sides.scene, 0.001));
  const std::string text = told(sides);
  EXPECT_FALSE(says(text, "Hertz")) << text;
  EXPECT_TRUE(says(text, "too low")) << text;
}

TEST(Verdict, SaysHowWrongTheForceIsAndWhy) {
  const std::string text = told(testing::pressed(23, 200));
  EXPECT_TRUE(says(text,
                   "The fast model's force at the deepest instant (5 mm deep) is 77.8 % too low: 37.7 N against the "
                   "reference's 170 N ± 3 N."))
      << text;
  EXPECT_TRUE(says(text, "Likely cause: The contact constants do not describe the material")) << text;
  EXPECT_TRUE(says(text, "gives 37.7 N at D = 5 mm")) << text;
  EXPECT_TRUE(says(text, "Hertz's formula about 189 N.")) << text;
  EXPECT_TRUE(says(text, "the paper's Table I for rubber")) << text;
  EXPECT_TRUE(says(text, "no constant factor can correct it")) << text;
  EXPECT_TRUE(says(text, "The reference took 5.32 min for 23 instants on 3 meshes")) << text;
}

TEST(Verdict, BlamesNoConstantsOfAModelThatHasNone) {
  testing::Sides sides = testing::pressed(23, 200);
  sides.scene.fast.formulation = scene::Formulation::response;
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "too low")) << text;
  EXPECT_FALSE(says(text, "Likely cause")) << text;
  EXPECT_FALSE(says(text, "touchstone tune")) << text;
}

/// Both sides with the fast model's force multiplied by a factor.
testing::Sides with_force_times(double factor) {
  testing::Sides sides = testing::pressed(5, 200);
  for (std::size_t t = 0; t < 5; ++t) {
    if (!sides.result.instants[t].regions.empty()) {
      set_force(sides.run.instants[t], factor * sides.result.instants[t].force_n());
    }
  }
  return sides;
}

TEST(Verdict, DoesNotCompareTheAreaAwareLawWithHertz) {
  testing::Sides sides = with_force_times(0.8);
  sides.scene.contact.law = scene::ContactLaw::area_aware;
  sides.scene.contact.k1_n_per_m = sides.scene.contact.k3_n_per_m3 = 0.0;
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "not tuned to this contact")) << text;
  EXPECT_FALSE(says(text, "contact law gives")) << text;
}

TEST(Verdict, GivesNoReasonTheNumbersDoNotGive) {
  testing::Sides sides = with_force_times(0.8);
  // Constants that fit the material.
  sides.scene.contact.k1_n_per_m = hertz_force_n(sides.scene, 0.005).value() / 0.005;
  sides.scene.contact.k3_n_per_m3 = 0.0;
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "20 % too low")) << text;
  EXPECT_TRUE(says(text, "not tuned to this contact. The fast model gives 80 % to 80 %")) << text;
  EXPECT_FALSE(says(text, "material")) << text;
  EXPECT_FALSE(says(text, "Table I")) << text;
  EXPECT_FALSE(says(text, "constant factor")) << text;
}

TEST(Verdict, OtherConstantsAreNotCalledThePapers) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.scene.contact.k1_n_per_m = 41.0;
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "Likely cause")) << text;
  EXPECT_FALSE(says(text, "Table I")) << text;
}

TEST(Verdict, CallsAnErrorWithinTheBandNotDistinguishable) {
  testing::Sides sides = testing::pressed(5, 200);
  for (std::size_t t = 0; t < 5; ++t) {
    sides.run.instants[t] = sides.result.instants[t];
    if (!sides.run.instants[t].regions.empty()) sides.run.instants[t].regions[0].force_n *= 1.01;
    sides.run.instants[t].displacement_m *= 1.005;
  }
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "is not distinguishable from the reference's")) << text;
  EXPECT_TRUE(says(text, "The deformed shapes are not distinguishable")) << text;
  EXPECT_FALSE(says(text, "too high")) << text;
  EXPECT_FALSE(says(text, "Likely cause")) << text;
}

TEST(Verdict, SaysOnHowFewPointsAShapeRests) {
  testing::Sides sides = testing::pressed(5, 200);
  const std::string many = told(testing::pressed(5, 3952));
  EXPECT_FALSE(says(many, "It rests on")) << many;
  for (std::size_t t = 0; t < 5; ++t) {
    Eigen::Matrix3Xd& u_m = sides.result.instants[t].displacement_m;
    if (u_m.norm() == 0.0) continue;
    Eigen::Index most = 0;
    u_m.colwise().norm().maxCoeff(&most);
    const scene::Vec3 kept_m = u_m.col(most);
    u_m *= 0.0;
    u_m.col(most) = kept_m;
  }
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "It rests on 1 point of the surface")) << text;
  EXPECT_TRUE(says(text, "fast.triangles")) << text;
}

TEST(Verdict, DoesNotTakeAnUnknownBandForAnExcuse) {
  testing::Sides sides = testing::pressed(5, 200);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  for (scene::ReferenceInstant& instant : sides.result.instants) {
    Eigen::VectorXd& u = instant.displacement_uncertainty_m;
    u.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  const std::string text = told(sides);
  EXPECT_FALSE(says(text, "not distinguishable")) << text;
  EXPECT_TRUE(says(text, "170 N (uncertainty unknown)")) << text;
  EXPECT_TRUE(says(text, "% (uncertainty unknown) of the displacement")) << text;
}

TEST(Verdict, SaysTooHighAndHowManyTimes) {
  testing::Sides sides = testing::pressed(5, 200);
  set_force(sides.run.instants[4], 1.25 * sides.result.instants[4].force_n());
  EXPECT_TRUE(says(told(sides), "25 % too high")) << told(sides);
  set_force(sides.run.instants[4], 3.0 * sides.result.instants[4].force_n());
  EXPECT_TRUE(says(told(sides), "is 3 times the reference's")) << told(sides);
}

TEST(Verdict, NoticesAForceInTheWrongDirection) {
  testing::Sides sides = testing::pressed(5, 200);
  const double size_n = sides.result.instants[4].force_n().norm();
  set_force(sides.run.instants[4], 1.05 * size_n * scene::Vec3(1.0, 0.0, 1.0).normalized());
  EXPECT_TRUE(says(told(sides), "the error is mostly one of direction")) << told(sides);
}

TEST(Verdict, NoticesASurfaceLeftInsideTheTool) {
  testing::Sides sides = testing::pressed(5, 200);
  for (std::size_t t = 0; t < 5; ++t) sides.run.instants[t].displacement_m = sides.result.instants[t].displacement_m;
  EXPECT_FALSE(says(told(sides), "still penetrates")) << told(sides);
  for (std::size_t t = 0; t < 5; ++t) sides.run.instants[t].displacement_m.setZero();
  EXPECT_TRUE(says(told(sides), "still penetrates it by up to 100 % of the depth")) << told(sides);
}

TEST(Verdict, SaysWhenTheForceIsLessThanTheLawAtTheDepth) {
  testing::Sides sides = testing::pressed(5, 200);
  EXPECT_FALSE(says(told(sides), "is less than that")) << told(sides);
  set_force(sides.run.instants[4], scene::Vec3(0.0, 0.0, 17.5));
  EXPECT_TRUE(says(told(sides), "The model's force of 17.5 N is less than that")) << told(sides);
}

TEST(Verdict, SaysWhenTheShapeIsWorseThanNoDeformation) {
  testing::Sides sides = testing::pressed(5, 200);
  EXPECT_TRUE(says(told(sides), "a surface that never moves has an error of 100 %")) << told(sides);
  EXPECT_FALSE(says(told(sides), "worse than no deformation")) << told(sides);
  for (std::size_t t = 0; t < 5; ++t) {
    sides.run.instants[t].displacement_m = 3.0 * sides.result.instants[t].displacement_m;
  }
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "shape error is 200 % ± 1")) << text;
  EXPECT_TRUE(says(text, "That is worse than no deformation")) << text;
  EXPECT_TRUE(says(text, "On average the surface moves 3 times as far as the reference's.")) << text;
}

TEST(Verdict, PassesOnWhatTheFastModelSaysOfItsSteps) {
  testing::Sides sides = testing::pressed(5, 200);
  EXPECT_FALSE(says(told(sides), "Status:")) << told(sides);
  for (const auto& [bit, words] :
       {std::pair(fast::StepStatus::not_finite, "Status: The tool's pose was not finite, "),
        std::pair(fast::StepStatus::contact_missed, "raise fast.tool_samples"),
        std::pair(fast::StepStatus::depth_limited, "half of the body's thickness"),
        std::pair(fast::StepStatus::law_saturated, "exceeded the peak of the contact law"),
        std::pair(fast::StepStatus::regions_full, "fast.max_regions, and the smallest were left out."),
        std::pair(fast::StepStatus::anchors_limited, "(raise fast.s_c_m2).")}) {
    sides.run.status = static_cast<std::uint32_t>(bit);
    EXPECT_TRUE(says(told(sides), words)) << told(sides);
  }
}

TEST(Verdict, TellsOfFrictionWhereThereIsSome) {
  testing::Sides sides = testing::pressed(5, 200);
  EXPECT_FALSE(says(told(sides), "Friction:")) << told(sides);
  sides.scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  for (std::size_t t = 1; t < 5; ++t) {
    if (sides.result.instants[t].regions.empty()) continue;
    sides.result.instants[t].regions[0].friction_n = scene::Vec3(-10.0, 0.0, 0.0);
    sides.result.instants[t].regions[0].sliding = true;
    sides.run.instants[t].regions[0].friction_n = scene::Vec3(-5.0, 0.0, 0.0);
  }
  const std::string text = told(sides);
  EXPECT_TRUE(says(text, "Friction: The error is ")) << text;
  EXPECT_TRUE(says(text, "of the reference's peak friction")) << text;
  EXPECT_TRUE(says(text, "The fast model never slips, the reference slips after ")) << text;
  for (std::size_t t = 1; t < 5; ++t) {
    if (!sides.run.instants[t].regions.empty()) sides.run.instants[t].regions[0].sliding = true;
  }
  EXPECT_TRUE(says(told(sides), "Slip begins after ")) << told(sides);
}

TEST(Verdict, SaysWhyRefinementEnded) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.result.refinement.why_ended = "there is no level 4: the time was up";
  EXPECT_TRUE(says(told(sides), "The reference's force is known to 2 %, its shape to ")) << told(sides);
  EXPECT_TRUE(says(told(sides), "Refinement ended: there is no level 4: the time was up.")) << told(sides);
}

TEST(Verdict, SaysOnceThatAnUncertaintyNeedsThreeMeshes) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.result.levels.resize(1);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  sides.result.refinement.why_ended = "1 mesh was asked for; an uncertainty needs 3";
  EXPECT_TRUE(says(told(sides),
                   "Reference: The reference's uncertainty is unknown. Refinement ended: 1 mesh was asked for; an "
                   "uncertainty needs 3.\n"))
      << told(sides);
}

TEST(Verdict, GivesABandOneDigitAndTheForceFourAtMost) {
  testing::Sides sides = testing::pressed(5, 200);
  sides.result.instants[4].force_uncertainty_n = 3.21e-5;
  EXPECT_TRUE(says(told(sides), "against the reference's 170.0 N ± 3 × 10⁻⁵ N")) << told(sides);
  sides.result.instants[4].force_uncertainty_n = 0.21;
  EXPECT_TRUE(says(told(sides), "against the reference's 170.0 N ± 0.2 N")) << told(sides);
}

TEST(Verdict, IsWrappedForATerminalWithCommandsOnLinesOfTheirOwn) {
  Verdict all;
  all.force = std::string(50, 'a') + " " + std::string(50, 'b');
  all.reasons = {{"Status", "Held.", "At length."}, {.about = "Cost", .detail = "Much."}};
  all.next = {{"Tune it.", "touchstone tune " + std::string(90, 'c')}};
  EXPECT_EQ(all.text(), std::string(50, 'a') + "\n" + std::string(50, 'b') +
                            "\nStatus: Held.\n\nNext: Tune it.\n  touchstone tune " + std::string(90, 'c') + "\n\n");
  all.next.resize(3, all.next.front());
  EXPECT_TRUE(all.text().ends_with("\nMore to do next is in the report.\n\n"));
}

TEST(Verdict, IsShortOnATerminal) {
  testing::Sides sides = testing::pressed(23, 200);
  sides.run.status = static_cast<std::uint32_t>(fast::StepStatus::anchors_limited);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  sides.scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  for (std::size_t t = 1; t < 23; ++t) {
    if (!sides.result.instants[t].regions.empty())
      sides.result.instants[t].regions[0].friction_n = scene::Vec3(-10.0, 0.0, 0.0);
  }
  const Verdict all =
      verdict(sides.scene, sides.run, sides.result, compute_errors(sides.scene, sides.run, sides.result.instants),
              sides.call, fast_model(sides.scene));
  const std::string text = all.text();
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 20) << text;
  for (const char* part : {"Status: ", "Likely cause: ", "Friction: ", "Next: "}) EXPECT_TRUE(says(text, part)) << part;
  EXPECT_FALSE(says(text, "Cost: ")) << text;
}

TEST(Verdict, CauseIsTheModelsOwn) {
  const testing::Sides sides = testing::pressed(3, 200);
  const Verdict all =
      verdict(sides.scene, sides.run, sides.result, compute_errors(sides.scene, sides.run, sides.result.instants), {},
              testing::springs({.scene = sides.scene}).front());
  EXPECT_TRUE(says(all.text(), "Likely cause: It is a spring.")) << all.text();
}

TEST(Verdict, WithoutContactSaysSo) {
  testing::Sides sides = testing::small();
  for (std::size_t t = 0; t < 2; ++t) {
    sides.run.instants[t].depth_m = sides.result.instants[t].depth_m = 0.0;
  }
  EXPECT_TRUE(says(told(sides), "never touches the body")) << told(sides);
  set_force(sides.run.instants[1], scene::Vec3(0.0, 0.0, 2.0));
  EXPECT_TRUE(says(told(sides), "Yet the fast model reports a force of up to 2 N")) << told(sides);
}

}  // namespace
}  // namespace touchstone::compare
