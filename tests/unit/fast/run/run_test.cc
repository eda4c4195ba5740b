#include "fast/run/run.h"

#include "fast/step/cell_rule.h"
#include "fast/step/step.h"
#include "support/bounded_memory.h"
#include "support/press.h"
#include "support/shipped_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace touchstone::fast {
namespace {

using scene::Vec3;

TEST(Run, RecordsEveryInstantAtItsExactPose) {
  for (const double rate_hz : {1000.0, 333.0, 7.0}) {
    scene::Scene scene = test::ball_on_cube();
    scene.fast.rate_hz = rate_hz;
    const auto result = run(scene);
    const std::vector<double> times_s = scene::instants_s(scene);
    ASSERT_EQ(result.instants.size(), times_s.size());
    const auto body = scene::body_shape(scene.body);
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      const scene::InstantRecord& record = result.instants[i];
      const scene::Pose pose = scene::pose_at(scene.track, times_s[i]);
      EXPECT_EQ(record.time_s, times_s[i]);
      EXPECT_EQ(record.tool.position_m, pose.position_m);
      EXPECT_EQ(record.depth_m, scene::rest_depth_m(*body, scene.tool, pose));
      EXPECT_EQ(record.displacement_m.cols(), result.surface.points_m.cols());
      EXPECT_EQ(result.instants[i].normal.cols(), result.surface.points_m.cols());
      // First touch may count as either.
      if (record.depth_m == 0.0 || record.depth_m > 1e-12) {
        EXPECT_EQ(record.regions.empty(), record.depth_m == 0.0) << record.depth_m;
      }
      EXPECT_LT((record.support_force_n - record.force_n()).norm(), 1e-12 * record.force_n().norm() + 1e-300);
    }
  }
}

TEST(Run, RecordsTheBeamEndsOfEveryPressingRegion) {
  for (const char* name : {"ball-on-cube-press", "compass-two-pins", "ellipsoid-pvc-inside"}) {
    const scene::Scene scene = test::shipped_scene(name, scene::Formulation::corrected);
    const auto result = run(scene);
    const FastModel model = model_of(scene);
    std::size_t row = 0;
    for (const scene::InstantRecord& record : result.instants) {
      Vec3 sum_n = Vec3::Zero();
      for (const scene::RegionRecord& region : record.regions) {
        for (std::size_t i = 0; i < model.skeleton.anchor_m.size(); ++i, ++row) {
          ASSERT_LT(row, result.beams.size());
          const BeamRecord& beam = result.beams[row];
          EXPECT_EQ(beam.time_s, record.time_s);
          EXPECT_EQ(beam.region_id, region.id);
          EXPECT_EQ(beam.anchor, static_cast<int>(i));
          EXPECT_EQ(beam.anchor_m, model.skeleton.anchor_m[i]);
          sum_n += beam.force_n;
          // F_i lies in the plane of the axes written beside its stress.
          const Vec3 in_frame_n = beam.end.axes.transpose() * beam.force_n;
          EXPECT_NEAR(in_frame_n.z(), 0.0, 1e-9 * beam.force_n.norm());
          EXPECT_GE(in_frame_n.x() * beam.end.stress_pa[0], 0.0);
          EXPECT_GE(beam.end.stress_pa[3], 0.0);
          if (record.regions.size() > 1) continue;
          const double area_m2 = model.skeleton.area_m2[i];
          EXPECT_NEAR(beam.end.stress_pa[0] * area_m2, in_frame_n.x(), 1e-9 * beam.force_n.norm()) << name;
        }
      }
      EXPECT_LT((sum_n + record.support_force_n).norm(), 1e-9 * sum_n.norm() + 1e-15) << name;
    }
    EXPECT_EQ(row, result.beams.size()) << name;
    EXPECT_GT(row, 0u);
  }
}

TEST(Run, TicksAtTheScenesRate) {
  scene::Scene scene = test::ball_on_cube();
  EXPECT_EQ(run(scene).ticks, 501);
  scene.fast.rate_hz = 200.0;
  EXPECT_EQ(run(scene).ticks, 101);
  scene.fast.rate_hz = 2.0;  // fewer ticks than instants: each instant still has one of its own
  EXPECT_EQ(run(scene).ticks, 14);
}

TEST(Run, MemoryDoesNotHangOnTheTicks) {
  if (TOUCHSTONE_SANITIZED) GTEST_SKIP() << "the sanitizer keeps memory of its own";
  scene::Scene scene = test::ball_on_cube();
  // Far away, where a tick takes least time.
  for (scene::Waypoint& row : scene.track) row.pose.position_m.z() += 0.5;
  scene.track.back().time_s = 1e4;
  scene.fast.triangles = 100;
  scene.fast.tool_samples = 100;
  EXPECT_TRUE(done_within(std::size_t{64} << 20, [&] { return run(scene).ticks == 10'000'001; }));
}

TEST(Run, RecordsWhatAStepAnswers) {
  const scene::Scene scene = test::ball_on_cube();
  const auto result = run(scene);
  const FastModel model = model_of(scene);
  FastState state(model);
  step(model, scene.track.front().pose, state);
  step(model, scene.track.back().pose, state);
  const scene::InstantRecord& last = result.instants.back();
  ASSERT_EQ(last.regions.size(), 1u);
  EXPECT_LT((last.force_n() - state.regions[0].force.force_n).norm(), 1e-12);
  EXPECT_NEAR(last.regions[0].area_m2, state.regions[0].extent.area_m2, 1e-15);
  EXPECT_NEAR(last.regions[0].depth_m, 0.006, 1e-12);
  for (int v = 0; v < result.surface.vertex_count(); ++v) {
    const auto k = static_cast<std::size_t>(v);
    EXPECT_NEAR(last.displacement_m(2, v), state.field.displacement_m[2][k], 1e-9);
    EXPECT_NEAR(result.instants.back().normal(0, v), state.field.normal[0][k], 1e-5);
  }
}

TEST(Run, SaysWhatItCost) {
  int calls = 0;
  double last = 0.0;
  const auto result = run(test::ball_on_cube(), [&](double part) {
    EXPECT_GE(part, last);
    last = part;
    ++calls;
  });
  EXPECT_EQ(last, 1.0);
  EXPECT_GT(calls, 50);
  EXPECT_LE(calls, 110);
  for (const fast::Percentiles& p : {result.step, result.force}) {
    EXPECT_GT(p.p50_us, 0.0);
    EXPECT_LE(p.p50_us, p.p99_us);
    EXPECT_LE(p.p99_us, p.p999_us);
    EXPECT_LE(p.p999_us, p.max_us);
  }
  EXPECT_GT(result.setup_s, 0.0);
  // At least the surface's columns: 14 + 6 + 6 floats a rest point.
  EXPECT_GT(result.memory_bytes, 26u * sizeof(float) * static_cast<std::size_t>(result.surface.vertex_count()));
  EXPECT_EQ(result.regions_max, 1);
  EXPECT_EQ(status_text(result.status), "ok");
}

TEST(Run, TrackWithoutContactHasNoRegions) {
  scene::Scene scene = test::ball_on_cube();
  scene.track = {{0.0, test::pressed(-0.01)}, {0.1, test::pressed(-0.001)}};
  const auto result = run(scene);
  EXPECT_EQ(result.regions_max, 0);
  EXPECT_EQ(result.force.max_us, 0.0);
  for (const auto& record : result.instants) EXPECT_TRUE(record.regions.empty());
}

/// A ball whose samples are further apart than the contact is wide.
scene::Scene contact_between_samples(scene::Formulation formulation) {
  scene::Scene scene = test::ball_on_cube(formulation);
  const double more_m = 0.6 - scene.tool.radius_m;
  scene.tool.radius_m = 0.6;
  scene.fast.tool_samples = 100;
  for (scene::Waypoint& w : scene.track) w.pose.position_m.z() += more_m;
  return scene;
}

TEST(Run, AContactThatNoSampleFeelsIsNotOk) {
  scene::Scene scene = contact_between_samples(scene::Formulation::published);
  const auto missed = run(scene);
  EXPECT_EQ(missed.regions_max, 0);
  EXPECT_EQ(missed.status, static_cast<std::uint32_t>(StepStatus::contact_missed));
  const scene::Plan told = plan(scene);
  EXPECT_NE(told.front().reason.find("CONTACT MISSED"), std::string::npos) << told.front().reason;
  scene.fast.tool_samples = 100'000;
  const auto felt = run(scene);
  EXPECT_EQ(felt.status & static_cast<std::uint32_t>(StepStatus::contact_missed), 0u);
  EXPECT_EQ(plan(scene).front().reason.find("CONTACT MISSED"), std::string::npos);
}

TEST(Run, CellsFeelAContactBetweenSamples) {
  const auto felt = run(contact_between_samples(scene::Formulation::corrected));
  EXPECT_EQ(felt.regions_max, 1);
  EXPECT_EQ(felt.status & static_cast<std::uint32_t>(StepStatus::contact_missed), 0u);
}

TEST(Run, PublishedLeavesAResidualOffTheAxis) {
  scene::Scene scene = test::ball_on_cube(scene::Formulation::published);
  for (scene::Waypoint& w : scene.track) w.pose.position_m += Vec3(0.013, 0.005, 0.0);
  const scene::InstantRecord last = run(scene).instants.back();
  const double residual = (last.support_force_n - last.force_n()).norm() / last.force_n().norm();
  EXPECT_GT(residual, 1e-4);  // errata E8; corrected: round-off
  EXPECT_LT(residual, 1.0);
}

TEST(ConvexMeshTool, TakesTheStepOfItsShape) {
  scene::Scene scene = test::ball_on_cube();
  const auto of_shape = run(scene);
  const FastModel shape(scene);
  const auto ball = scene::tessellate(*scene::tool_shape(scene.tool), 6000);
  scene::TriangleMesh mesh{ball.points_m, ball.triangles};
  scene.tool.shape = scene::ToolShape::mesh;
  scene.tool.mass_center_m = Vec3::Zero();
  scene.fast.max_regions = 10;
  scene.tool.mesh = std::make_shared<scene::TriangleMesh>(mesh);
  EXPECT_NE(FastState(FastModel(scene)).several, nullptr);

  mesh.convex = true;
  scene.tool.mesh = std::make_shared<scene::TriangleMesh>(mesh);
  const FastModel model = model_of(scene);
  EXPECT_EQ(FastState(model).several, nullptr);
  EXPECT_NEAR(model.tool.count(), shape.tool.count(), 0.1 * shape.tool.count());
  const auto of_mesh = run(scene);
  ASSERT_EQ(of_mesh.instants.size(), of_shape.instants.size());
  double largest_n = 0.0, off_n = 0.0;
  for (std::size_t i = 0; i < of_mesh.instants.size(); ++i) {
    const Vec3 force_n = of_shape.instants[i].force_n();
    largest_n = std::max(largest_n, force_n.norm());
    off_n = std::max(off_n, (of_mesh.instants[i].force_n() - force_n).norm());
  }
  EXPECT_GT(largest_n, 0.0);
  EXPECT_LT(off_n, 0.03 * largest_n);
  for (const scene::PlanLine& line : plan(scene)) {
    if (line.part == "several regions") {
      EXPECT_FALSE(line.modelled);
      EXPECT_NE(line.reason.find("the tool's mesh has no concavity deeper than 0.035 mm"), std::string::npos)
          << line.reason;
    }
  }
}

TEST(StatusText, NamesEveryBit) {
  EXPECT_EQ(status_text(0), "ok");
  const std::string all = status_text(0xffff);
  EXPECT_EQ(std::ranges::count(all, ';'), 15);
  for (const char* part :
       {"not finite", "half of the body", "peak of the contact law", "fast.s_c_m2", "fast.max_regions",
        "fast.tool_samples", "body's response is known", "tip is high", "flat tip"}) {
    EXPECT_NE(all.find(part), std::string::npos) << part;
  }
}

TEST(Plan, SaysWhatIsModelledAndWhatIsNot) {
  const auto line = [](const scene::Plan& plan, const std::string& part) {
    const auto found = std::find_if(plan.begin(), plan.end(), [&](const auto& l) { return l.part == part; });
    EXPECT_NE(found, plan.end()) << part;
    return found == plan.end() ? scene::PlanLine{} : *found;
  };
  scene::Scene scene = test::ball_on_cube();
  scene::Plan with = plan(scene);
  for (const char* part :
       {"contact detection", "contact force", "beam skeleton", "surface", "local factor", "normals"}) {
    EXPECT_TRUE(line(with, part).modelled) << part;
  }
  for (const char* part : {"friction", "several regions", "inclusions"})
    EXPECT_FALSE(line(with, part).modelled) << part;
  for (const auto& l : with) EXPECT_FALSE(l.reason.empty() || l.cost.empty()) << l.part;
  EXPECT_NE(line(with, "contact detection").reason.find("504 cells of the tool, 1.58 mm apart"), std::string::npos)
      << line(with, "contact detection").reason;
  scene.fast.C_n = 0.0;
  EXPECT_FALSE(line(plan(scene), "local factor").modelled);
  scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  scene::Inclusion core;
  core.shape = scene::BodyShape::sphere;
  core.radius_m = 0.01;
  core.center_m = Vec3(0.0, 0.0, 0.03);
  core.material = {1e5, 0.3};
  scene.body.inclusions.push_back(core);
  with = plan(scene);
  for (const char* part : {"friction", "inclusions"}) EXPECT_TRUE(line(with, part).modelled) << part;
  const scene::Plan compass = plan(test::shipped_scene("compass-two-pins", scene::Formulation::corrected));
  EXPECT_TRUE(line(compass, "several regions").modelled);
  EXPECT_NE(line(compass, "several regions").reason.find("2 at the track's instants"), std::string::npos);
  EXPECT_EQ(line(compass, "several regions").reason.find("SPLIT"), std::string::npos);
  scene::Scene coarse = test::shipped_scene("compass-two-pins", scene::Formulation::corrected);
  coarse.fast.tool_samples = 500;
  EXPECT_NE(line(plan(coarse), "several regions").reason.find("ONE CONTACT MAY SPLIT INTO SEVERAL"), std::string::npos);
}

}  // namespace
}  // namespace touchstone::fast
