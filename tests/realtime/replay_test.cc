// The pipeline in virtual time is a function of its scene, bit for bit.
#include "fast/run/run.h"
#include "fast/step/cell_rule.h"
#include "fast/step/step.h"
#include "support/press.h"
#include "support/shipped_scenes.h"

#include <gtest/gtest.h>

#include <functional>

namespace touchstone::fast {
namespace {

using scene::Formulation;

/// A press that also slides and rotates.
scene::Scene busy(Formulation formulation) {
  scene::Scene scene = test::ball_on_cube(formulation);
  scene.track.push_back({0.8, test::pressed(0.002, 0.012, -0.004)});
  scene.track.back().pose.orientation = test::tilted();
  scene.fast.rate_hz = 100.0;
  scene.fast.triangles = 1200;
  return scene;
}

TEST(Replay, GivesEqualBits) {
  for (const Formulation formulation : {Formulation::published, Formulation::corrected}) {
    const auto first = run(busy(formulation)), second = run(busy(formulation));
    EXPECT_EQ(first.state_hash, second.state_hash);
    EXPECT_EQ(first.status, second.status);
    ASSERT_EQ(first.instants.size(), second.instants.size());
    for (std::size_t i = 0; i < first.instants.size(); ++i) {
      EXPECT_EQ(first.instants[i].force_n(), second.instants[i].force_n());
      EXPECT_EQ(first.instants[i].support_force_n, second.instants[i].support_force_n);
      EXPECT_EQ(first.instants[i].displacement_m, second.instants[i].displacement_m);
      EXPECT_EQ(first.instants[i].normal, second.instants[i].normal);
    }
  }
}

class ShippedScene : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScene, GivesEqualBitsAndNoStatus) {
  for (const Formulation formulation : {Formulation::published, Formulation::corrected}) {
    const scene::Scene scene = test::shipped_scene(GetParam(), formulation);
    const auto first = run(scene), second = run(scene);
    EXPECT_EQ(first.state_hash, second.state_hash);
    EXPECT_EQ(status_text(first.status), "ok");
    EXPECT_GT(first.regions_max, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene, testing::ValuesIn(test::shipped_scenes()),
                         [](const auto& scene) { return test::test_name(scene.param); });

TEST(Replay, HashSeesEveryPhysicalChange) {
  const std::uint64_t hash = run(busy(Formulation::corrected)).state_hash;
  const std::vector<std::pair<const char*, std::function<void(scene::Scene&)>>> changes{
      {"k1", [](scene::Scene& s) { s.contact.k1_n_per_m *= 1.0 + 1e-12; }},
      {"k3", [](scene::Scene& s) { s.contact.k3_n_per_m3 *= 1.001; }},
      {"Young's modulus", [](scene::Scene& s) { s.body.material.youngs_modulus_pa *= 1.001; }},
      {"tool radius", [](scene::Scene& s) { s.tool.radius_m *= 1.001; }},
      {"track", [](scene::Scene& s) { s.track[1].pose.position_m.z() += 1e-9; }},
      {"C_n", [](scene::Scene& s) { s.fast.C_n *= 1.01; }},
      {"C_r", [](scene::Scene& s) { s.fast.C_r_m *= 1.01; }},
      {"r_R", [](scene::Scene& s) { s.fast.r_R_m *= 1.01; }},
      {"s_c", [](scene::Scene& s) { s.fast.s_c_m2 *= 1.01; }},
      {"samples", [](scene::Scene& s) { s.fast.tool_samples /= 2; }},
      {"formulation", [](scene::Scene& s) { s.fast.formulation = Formulation::published; }},
  };
  for (const auto& [name, change] : changes) {
    scene::Scene scene = busy(Formulation::corrected);
    change(scene);
    EXPECT_NE(run(scene).state_hash, hash) << name;
  }
}

TEST(Replay, AHeldPoseIsAFixedPoint) {
  // However many ticks a tool rests, nothing drifts.
  for (const Formulation formulation : {Formulation::published, Formulation::corrected}) {
    const FastModel model = model_of(busy(formulation));
    FastState state(model);
    scene::Pose pose = test::pressed(0.004, 0.011, -0.003);
    pose.orientation = test::tilted();
    step(model, test::pressed(-0.001), state);
    step(model, pose, state);
    step(model, pose, state);
    const auto force_n = state.regions[0].force.force_n;
    const Columns3 displacement_m = state.field.displacement_m, normal = state.field.normal;
    for (int tick = 0; tick < 300; ++tick) step(model, pose, state);
    EXPECT_EQ(state.regions[0].force.force_n, force_n);
    EXPECT_EQ(state.field.displacement_m, displacement_m);
    EXPECT_EQ(state.field.normal, normal);
  }
}

}  // namespace
}  // namespace touchstone::fast
