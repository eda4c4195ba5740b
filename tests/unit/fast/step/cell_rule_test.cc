#include "fast/step/cell_rule.h"

#include "fast/step/step.h"
#include "support/press.h"
#include "support/shipped_scenes.h"

#include <gtest/gtest.h>

namespace touchstone::fast {
namespace {

scene::Scene press() {
  scene::Scene scene = test::ball_on_cube();
  scene.track = {{0.0, test::pressed(-0.001, 0.0, 0.0)}, {1.0, test::pressed(0.004, 0.0, 0.0)}};
  return scene;
}

TEST(ChooseCells, TakesTheFewestPointsThatAreFineEnough) {
  scene::Scene scene = press();
  const FastModel model = model_of(scene);
  EXPECT_LE(model.cells->error_rel, cell_tolerance_rel);
  EXPECT_GT(model.cells->error_rel, 0.0);
  // A ball so large that the contact spans few of its cells and the body's edges needs more of them.
  scene.tool.radius_m = 0.3;
  for (scene::Waypoint& at : scene.track) at.pose.position_m += scene::Vec3(0.02, 0.013, 0.29);
  const FastModel large = model_of(scene);
  EXPECT_GT(large.cells->rule.points, model.cells->rule.points);
  EXPECT_GE(large.cells->rule.room, 16 * large.cells->rule.points);
}

TEST(ChooseCells, DoesNotDependOnConstantsThatAreFitted) {
  // Of several contact regions each deforms the body where the others press.
  for (scene::Scene scene : {press(), test::shipped_scene("compass-two-pins", scene::Formulation::corrected)}) {
    const FastModel model = model_of(scene);
    scene.contact.k1_n_per_m *= 30.0;
    scene.contact.k3_n_per_m3 = -scene.contact.k3_n_per_m3;
    scene.contact.friction = scene::Friction{};
    scene.fast.C_n *= 0.5;
    const FastModel other = model_of(scene);
    EXPECT_EQ(other.cells->rule.points, model.cells->rule.points);
    EXPECT_EQ(other.cells->error_rel, model.cells->error_rel);
  }
}

TEST(ChooseCells, LeavesTheModelAsItWas) {
  scene::Scene scene = press();
  scene.contact.friction = scene::Friction{};
  FastModel model = model_of(scene);
  const auto friction = model.formulas.resolve_friction;
  const int points = model.cells->rule.points;
  const double force_n = model.law.at(0.001).force_n(0.002);
  const ContactCells again = choose_cells(scene.track, model);
  EXPECT_EQ(again.rule.points, points);
  EXPECT_EQ(model.cells->rule.points, points);
  EXPECT_EQ(model.formulas.resolve_friction, friction);
  EXPECT_NE(friction, nullptr);
  EXPECT_EQ(model.law.at(0.001).force_n(0.002), force_n);
}

TEST(ChooseCells, MakesTheHalvesOfTheTrackAtSetUp) {
  const scene::Scene scene = press();
  const FastModel model = model_of(scene);
  FastModel unprepared = model_of(scene);
  unprepared.cells->halves = CellHalves(unprepared.tool.count(), unprepared.cells->rule.room);
  FastState state(model), other(unprepared);
  const std::size_t kept = state.cells.halves.kept();
  EXPECT_GT(kept, 48U);
  for (int k = 0; k < 256; ++k) {
    const scene::Pose pose = scene::pose_at(scene.track, k / 255.0);
    step(model, pose, state);
    step(unprepared, pose, other);
    ASSERT_EQ(total_force_n(state), total_force_n(other)) << k;
  }
  EXPECT_EQ(state.cells.halves.kept(), kept) << "made in a tick";
  EXPECT_EQ(other.cells.halves.kept(), kept);
}

TEST(ChooseCells, WithoutContactOnTheTrackHasAFixedNumber) {
  scene::Scene scene = press();
  scene.track = {{0.0, test::pressed(-0.002, 0.0, 0.0)}, {1.0, test::pressed(-0.001, 0.0, 0.0)}};
  const FastModel model = model_of(scene);
  EXPECT_EQ(model.cells->rule.points, 48);
  EXPECT_EQ(model.cells->error_rel, 0.0);
}

}  // namespace
}  // namespace touchstone::fast
