#include "fast/step/skeleton_engine.h"

#include "fast/run/run.h"
#include "fast/run/ticks.h"
#include "support/press.h"
#include "support/shipped_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

namespace touchstone::fast {
namespace {

using scene::Formulation;

/// A press followed by sliding, with a friction state.
const std::vector<scene::Pose> poses{test::pressed(-0.001), test::pressed(0.002), test::pressed(0.003, 0.001),
                                     test::pressed(0.003, 0.004)};

scene::Scene rubbed() {
  scene::Scene scene = test::ball_on_cube();
  scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  scene.fast.triangles = 400;
  return scene;
}

TEST(Engine, EqualPosesGiveEqualHashesHoweverTheyAreStepped) {
  SkeletonEngine whole(rubbed()), timed(rubbed()), halves(rubbed());
  halves.time_stages(true);
  std::uint64_t before = whole.answer_hash();
  for (const scene::Pose& pose : poses) {
    EXPECT_EQ(whole.step(pose), StepStatus::ok);
    const TimedStep step = timed.step_timed(pose);
    EXPECT_EQ(step.status, StepStatus::ok);
    EXPECT_GT(step.force_ns, 0);
    EXPECT_GE(step.step_ns, step.force_ns);
    halves.step_force(pose);
    halves.step_shape();
    EXPECT_NE(whole.answer_hash(), before);
    before = whole.answer_hash();
    EXPECT_EQ(timed.answer_hash(), before);
    EXPECT_EQ(halves.answer_hash(), before);
  }
  EXPECT_GT(halves.stages().spent_ns(Stage::friction), 0);
  EXPECT_EQ(whole.stages().spent_ns(Stage::friction), 0);
}

TEST(Engine, ABadPoseHoldsTheAnswer) {
  SkeletonEngine engine(rubbed());
  engine.step(poses[1]);
  const scene::Wrench before = engine.wrench();
  scene::Pose bad = poses[2];
  bad.position_m.y() = std::nan("");
  EXPECT_EQ(engine.step(bad), StepStatus::not_finite);
  EXPECT_EQ(engine.step_timed(bad).status, StepStatus::not_finite);
  EXPECT_EQ(engine.wrench().force_n, before.force_n);
  EXPECT_EQ(engine.wrench().torque_nm, before.torque_nm);
}

TEST(Engine, RestartsFromBeforeTheFirstStep) {
  SkeletonEngine engine(rubbed());
  std::uint64_t first = 0;
  for (int times = 0; times < 2; ++times) {
    for (const scene::Pose& pose : poses) engine.step(pose);
    if (times == 0) first = engine.answer_hash();
    if (times == 0) engine.restart();
  }
  EXPECT_EQ(engine.answer_hash(), first);
}

TEST(Engine, RecordsWhatTheRunLeaves) {
  for (const char* name : {"ball-on-cube-slide", "compass-two-pins"}) {
    const scene::Scene scene = test::shipped_scene(name, Formulation::corrected);
    const auto result = run(scene);
    SkeletonEngine engine(scene);
    Ticks ticks(scene);
    while (const std::optional<Tick> tick = ticks.next()) {
      const scene::Pose pose = scene::pose_at(scene.track, tick->time_s);
      engine.step(pose);
      if (tick->instant < 0) continue;
      const scene::InstantRecord& left = result.instants[static_cast<std::size_t>(tick->instant)];
      const scene::InstantRecord made = engine.record(tick->time_s, pose, left.depth_m);
      EXPECT_EQ(made.time_s, left.time_s);
      EXPECT_EQ(made.tool.position_m, left.tool.position_m);
      EXPECT_EQ(made.depth_m, left.depth_m);
      EXPECT_EQ(made.displacement_m, left.displacement_m);
      EXPECT_EQ(made.support_force_n, left.support_force_n);
      EXPECT_EQ(made.force_n(), engine.wrench().force_n);
      ASSERT_EQ(made.regions.size(), left.regions.size());
      for (std::size_t i = 0; i < made.regions.size(); ++i) {
        const scene::RegionRecord &m = made.regions[i], &l = left.regions[i];
        EXPECT_EQ(std::tie(m.id, m.depth_m, m.area_m2, m.sliding), std::tie(l.id, l.depth_m, l.area_m2, l.sliding));
        EXPECT_EQ(m.force_n, l.force_n);
        EXPECT_EQ(m.torque_nm, l.torque_nm);
        EXPECT_EQ(m.friction_n, l.friction_n);
        // Of this scene at this instant, and not a default.
        const ContactRegion& region = engine.state().regions[i];
        EXPECT_EQ(m.force_n, region.force.force_n);
        EXPECT_EQ(m.area_m2, region.extent.area_m2);
        EXPECT_GT(m.area_m2, 0.0);
        EXPECT_GT(m.depth_m, 0.0);
      }
    }
    EXPECT_EQ(engine.answer_hash(), result.state_hash);
  }
}

}  // namespace
}  // namespace touchstone::fast
