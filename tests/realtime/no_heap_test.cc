// No heap use below step(): at first contact, in contact, on a jump, on an invalid pose, and on release.
#include "support/no_heap.h"
#include "fast/step/cell_rule.h"

#include "fast/response/response_step.h"
#include "fast/step/step.h"
#include "fast/surface/region_shapes.h"
#include "support/press.h"
#include "support/shipped_scenes.h"
#include "support/synthetic_response.h"
#include "support/two_balls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <new>

namespace touchstone::fast {
namespace {

using scene::Formulation;

void run_without_heap(const scene::Scene& scene) {
  const FastModel model = model_of(scene);
  FastState state(model);
  const double top_m = model.body->bounds().upper_m.z() + scene.tool.radius_m;
  int in_contact = 0;
  const auto tick = [&](const scene::Pose& pose) {
    const test::NoHeap guard;
    step(model, pose, state);
    in_contact += state.in_contact();
  };
  for (int i = -20; i < 200; ++i) {
    scene::Pose pose = test::at(0.0001 * i, 0.002, top_m - 0.00005 * i);
    pose.orientation = test::tilted();
    tick(pose);
  }
  tick(test::at(0.0, std::nan(""), top_m));
  tick(test::at(0.0, 0.0, top_m + 0.01));   // out
  tick(test::at(0.0, 0.0, top_m - 0.045));  // 50 mm in one tick
  tick(test::at(0.029, 0.029, top_m - 0.002));
  tick(test::at(0.5, 0.0, 0.0));
  EXPECT_GT(in_contact, 190);
}

void run_response_without_heap(const scene::Scene& scene) {
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  const ResponseModel model(scene, surface, test::synthetic_response(scene, surface));
  ResponseState state(model);
  double largest_n = 0.0;
  for (int i = -20; i < 200; ++i) {
    scene::Pose pose = test::pressed(0.00005 * i, 0.0001 * i, 0.002);
    if (i == 100) pose.position_m.y() = std::nan("");
    pose.orientation = test::tilted();
    const test::NoHeap guard;
    (void)response_step(model, pose, state);
    largest_n = std::max(largest_n, state.wrench.force_n.norm());
  }
  EXPECT_GT(largest_n, 100.0);
  EXPECT_EQ(state.contacts[0].friction_n.norm() > 10.0, scene.contact.friction.has_value());
}

TEST(NoHeap, BelowAStepOfTheResponseModel) {
  scene::Scene scene = test::ball_on_cube();
  run_response_without_heap(scene);
  scene.contact.friction = scene::Friction{.K = 1.0, .beta = 0.75, .mu_D = 0.3};
  run_response_without_heap(scene);
}

TEST(NoHeap, BelowAStepOfTheResponseModelWithSeveralTips) {
  const scene::Scene scene = test::two_balls_on_cube();
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  const ResponseModel model(scene, surface, test::synthetic_response(scene, surface));
  ResponseState state(model);
  int together = 0;
  for (int i = -20; i < 100; ++i) {
    const scene::Pose pose = test::both_pressed(2e-5 * i, 1e-5 * i, 0.0, 2e-4 * i);
    const test::NoHeap guard;
    (void)response_step(model, pose, state);
    together += state.contacts[0].touches() && state.contacts[1].touches() ? 1 : 0;
  }
  EXPECT_GT(together, 20);
}

TEST(NoHeap, BelowAStepOfTheResponseModelWithACapsuleOnItsSide) {
  const auto lying = [](double depth_m, double about_z) {
    scene::Pose pose = test::at(0.0, 0.0, 0.066 - depth_m);
    pose.orientation = Eigen::AngleAxisd(about_z, scene::Vec3::UnitZ()) *
                       Eigen::AngleAxisd(0.5 * std::acos(-1.0), scene::Vec3::UnitX());
    return pose;
  };
  scene::Scene scene = test::ball_on_cube();
  scene.tool.shape = scene::ToolShape::capsule;
  scene.tool.radius_m = 0.006;
  scene.tool.length_m = 0.012;
  scene.track = {{0.0, lying(0.001, 0.0)}, {1.0, lying(0.002, 0.0)}};
  const scene::Surface surface = scene::tessellate(*scene::body_shape(scene.body), scene.fast.triangles);
  const ResponseModel model(scene, surface, test::synthetic_response(scene, surface));
  ASSERT_TRUE(model.tips[0].tip.line());
  ResponseState state(model);
  int touching = 0;
  for (int i = -20; i < 100; ++i) {
    const scene::Pose pose = lying(2e-5 * i, 0.1 * i);
    const test::NoHeap guard;
    (void)response_step(model, pose, state);
    touching += state.contacts[0].touches() ? 1 : 0;
  }
  EXPECT_GT(touching, 90);
}

TEST(NoHeap, BelowAStepOnABox) {
  for (const Formulation formulation : {Formulation::published, Formulation::corrected}) {
    run_without_heap(test::ball_on_cube(formulation));
  }
}

TEST(NoHeap, BelowAStepOnASphere) {
  for (const Formulation formulation : {Formulation::published, Formulation::corrected}) {
    run_without_heap(test::ball_on_sphere(formulation));
  }
}

TEST(NoHeap, InTheShapeOfSeveralRegions) {
  const FastModel model = model_of(test::ball_on_cube());
  SurfaceField field(model.rest);
  ShapeStack stack(model.rest, *model.anchors, 3);
  const std::vector<scene::Vec3> anchor_m(model.skeleton.anchor_m.size(), scene::Vec3(1e-4, 0.0, -1e-4));
  for (const SeveralRegions& several : {several_regions_published, several_regions_corrected}) {
    const test::NoHeap guard;
    stack.clear();
    scene::Vec3 moved_m = scene::Vec3::Zero();
    for (const double x_m : {-0.02, 0.001, 0.009}) {
      const scene::SurfaceQuery at = model.body->query(scene::Vec3(x_m, 0.003, 0.06));
      RegionShape region;
      region.anchor_displacement_m = anchor_m;
      region.contact = {scene::Vec3(0.0, 0.0, -0.002), at.normal, at.patch, model.anchors->at(at.patch, at.point_m)};
      region.p0_W_m = at.point_m;
      region.size = {40, 3e-5};
      several.add(model.rest, &model.local, region, stack);
      moved_m += several.displacement_at(model.rest, *model.anchors, stack, &model.local, at);
    }
    several.interpolate(model.rest, stack, field);
    several.apply_local_factors(model.rest, model.local, stack, field);
    if (!(moved_m.z() < -0.005)) std::abort();
  }
}

TEST(NoHeap, BelowAStepWithoutLocalFactor) {
  scene::Scene scene = test::ball_on_cube();
  scene.fast.C_n = 0.0;
  run_without_heap(scene);
}

TEST(NoHeap, BelowAStepWithManySamplesAndTriangles) {
  scene::Scene scene = test::ball_on_cube();
  scene.fast.tool_samples = 50000;
  scene.fast.triangles = 100000;
  run_without_heap(scene);
}

class ShippedSceneWithoutHeap : public testing::TestWithParam<std::string> {};

TEST_P(ShippedSceneWithoutHeap, BelowAStep) {
  for (const auto formulation : {scene::Formulation::published, scene::Formulation::corrected}) {
    const scene::Scene scene = test::shipped_scene(GetParam(), formulation);
    const FastModel model = model_of(scene);
    FastState state(model);
    const double begin_s = scene.track.front().time_s, end_s = scene.track.back().time_s;
    int in_contact = 0;
    for (int i = 0; i <= 300; ++i) {
      const scene::Pose pose = scene::pose_at(scene.track, begin_s + (end_s - begin_s) * i / 300);
      const test::NoHeap guard;
      step(model, pose, state);
      in_contact += state.in_contact();
    }
    EXPECT_GT(in_contact, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShippedSceneWithoutHeap, testing::ValuesIn(test::shipped_scenes()),
                         [](const auto& scene) { return test::test_name(scene.param); });

// The heap check itself.
TEST(NoHeapDeathTest, SeesEveryWayToTheHeap) {
  testing::FLAGS_gtest_death_test_style = "fast";
  void* volatile block = nullptr;
  EXPECT_DEATH(
      {
        const test::NoHeap guard;
        block = std::malloc(10);
      },
      "heap use below step.*malloc");
  EXPECT_DEATH(
      {
        const test::NoHeap guard;
        block = std::calloc(2, 10);
      },
      "heap use below step.*calloc");
  EXPECT_DEATH(
      {
        const test::NoHeap guard;
        block = std::aligned_alloc(64, 64);
      },
      "heap use below step.*aligned_alloc");
  EXPECT_DEATH(
      {
        const test::NoHeap guard;
        block = ::operator new(10);
      },
      "heap use below step.*malloc");
  block = std::malloc(10);
  EXPECT_DEATH(
      {
        const test::NoHeap guard;
        block = std::realloc(block, 20);
      },
      "heap use below step.*realloc");
  EXPECT_DEATH(
      {
        const test::NoHeap guard;
        std::free(block);
      },
      "heap use below step.*free");
  std::free(block);
}

TEST(NoHeapDeathTest, SeesEigenTemporaries) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::Random(40, 40);
  Eigen::MatrixXd B = A;
  EXPECT_DEATH(
      {
        const test::NoHeap guard;
        B = A * B;
      },
      "heap use below step");
}

}  // namespace
}  // namespace touchstone::fast
