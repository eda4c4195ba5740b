// The response model as an engine: records, replay, its file, a run over a track, and the device loop.
#include "fast/response/response_engine.h"

#include "fast/run/make_engine.h"
#include "fast/run/replay.h"
#include "fast/run/run.h"
#include "scene/base/error.h"
#include "scene/base/files.h"
#include "scene/response/response_file.h"
#include "support/press.h"
#include "support/synthetic_response.h"
#include "support/temporary_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace touchstone::fast {
namespace {

using ::testing::HasSubstr;

class ResponseEngineTest : public ::testing::Test {
 protected:
  ResponseEngineTest() {
    scene_.fast.formulation = scene::Formulation::response;
    scene_.fast.triangles = 1200;
    scene_.fast.store = folder_.path();
  }
  [[nodiscard]] scene::Surface surface() const {
    return scene::tessellate(*scene::body_shape(scene_.body), scene_.fast.triangles);
  }
  [[nodiscard]] ResponseEngine engine() const {
    return {scene_, surface(), test::synthetic_response(scene_, surface())};
  }
  [[nodiscard]] std::string identity() const {
    return scene::response_identity(scene_.body, scene::load_grid(scene_).grid.value(), surface(),
                                    scene::load_kinds(scene_));
  }
  void store_response() const {
    const auto file = scene::response_path(folder_.path(), identity());
    std::filesystem::create_directories(file.parent_path());
    scene::write_file(file, scene::response_bytes(test::synthetic_response(scene_, surface()), identity()));
  }

  compare::testing::TemporaryFolder folder_;
  scene::Scene scene_ = test::ball_on_cube();
};

TEST_F(ResponseEngineTest, AReplayEqualsTheRunBitForBitWithTheConstantsOfTheCall) {
  store_response();
  scene::Scene other = scene_;
  other.fast.body_falloff_per_m = 200.0;
  Replay replay(scene_);
  EXPECT_FALSE(replay.recorded());
  double last_n = 0.0;
  for (const scene::Scene& now : {other, scene_}) {
    const fast::Run run = fast::run(now);
    const std::vector<scene::Vec3> force_n = replay.forces_n(now);
    ASSERT_EQ(force_n.size(), run.instants.size());
    for (std::size_t t = 0; t < force_n.size(); ++t) EXPECT_EQ(force_n[t], run.instants[t].force_n()) << t;
    EXPECT_NE(force_n.back().norm(), last_n);
    last_n = force_n.back().norm();
    const std::vector<std::size_t> instants = {force_n.size() / 2, force_n.size() - 1};
    std::size_t visited = 0;
    replay.displacements(now, instants, [&](std::size_t k, const Columns3& displacement_m) {
      EXPECT_EQ(matrix_of(displacement_m), run.instants[instants[k]].displacement_m) << k;
      ++visited;
    });
    EXPECT_EQ(visited, instants.size());
  }
}

TEST_F(ResponseEngineTest, RecordsTheContactInEquilibrium) {
  ResponseEngine engine = this->engine();
  const scene::Pose pose = test::pressed(0.004);
  EXPECT_EQ(engine.step(pose), StepStatus::ok);
  const scene::InstantRecord record = engine.record(0.5, pose, 0.004);
  ASSERT_EQ(record.regions.size(), 1u);
  EXPECT_GT(record.force_n().z(), 10.0);
  EXPECT_EQ(record.force_n(), engine.wrench().force_n);
  EXPECT_EQ(record.support_force_n, record.force_n());
  EXPECT_EQ(record.depth_m, 0.004);
}

TEST_F(ResponseEngineTest, TheTractionIsAPressureAlongTheBallsNormal) {
  scene_.fast.triangles = 24000;
  ResponseEngine engine = this->engine();
  const scene::Pose pose = test::pressed(0.004);
  engine.step(pose);
  const scene::InstantRecord record = engine.record(0.0, pose, 0.004);
  const scene::Surface& rest = engine.surface();
  int loaded = 0;
  scene::Vec3 sum_n = scene::Vec3::Zero();
  for (Eigen::Index i = 0; i < record.traction_pa.cols(); ++i) {
    const scene::Vec3 traction_pa = record.traction_pa.col(i);
    if (traction_pa.isZero(0.0)) continue;
    ++loaded;
    const scene::Vec3 from_center_m = rest.points_m.col(i) + record.displacement_m.col(i) - pose.position_m;
    EXPECT_LT(from_center_m.head<2>().norm(), 0.01);
    EXPECT_GT(traction_pa.normalized().dot(from_center_m.normalized()), 0.999);
    EXPECT_LT(traction_pa.norm(), 1.3 * record.pressure_peak_pa);
    sum_n += rest.vertex_area_m2[static_cast<std::size_t>(i)] * traction_pa;
  }
  EXPECT_GT(loaded, 40);
  // By the areas at rest, of which a ball stretches those at its side.
  EXPECT_NEAR(-sum_n.z(), engine.wrench().force_n.z(), 0.25 * engine.wrench().force_n.z());
}

TEST_F(ResponseEngineTest, NormalsFollowTheSurfaceAndComeBack) {
  ResponseEngine engine = this->engine();
  const Columns3 rest = engine.field().normal;
  engine.step(test::pressed(0.004));
  const Eigen::Matrix3Xd normals = matrix_of(engine.field().normal);
  EXPECT_LT((normals.colwise().norm().array() - 1.0).abs().maxCoeff(), 1e-5);
  // Of a dent the surface leans towards the middle.
  double lean = 0.0;
  for (Eigen::Index i = 0; i < normals.cols(); ++i) {
    const scene::Vec3 p_m = engine.surface().points_m.col(i);
    const double r_m = p_m.head<2>().norm();
    if (p_m.z() < 0.0599 || r_m < 0.002 || r_m > 0.012) continue;
    EXPECT_LT(normals.col(i).head<2>().dot(p_m.head<2>()), 1e-4 * r_m);
    lean = std::max(lean, normals.col(i).head<2>().norm());
  }
  EXPECT_GT(lean, 0.1);
  engine.step(test::pressed(-0.001));
  EXPECT_EQ(engine.field().normal, rest);
}

TEST_F(ResponseEngineTest, EqualPosesGiveEqualHashesAndABadOneHolds) {
  ResponseEngine one = engine(), other = engine();
  for (const double depth_m : {0.001, 0.004, 0.002}) {
    one.step(test::pressed(depth_m));
    other.step_force(test::pressed(depth_m));
    other.step_shape();
    scene::Pose bad = test::pressed(depth_m);
    bad.position_m.x() = std::numeric_limits<double>::quiet_NaN();
    const scene::Wrench before = one.wrench();
    EXPECT_EQ(one.step(bad), StepStatus::not_finite);
    EXPECT_EQ(one.wrench().force_n, before.force_n);
    other.step(bad);
  }
  EXPECT_EQ(one.answer_hash(), other.answer_hash());
}

TEST_F(ResponseEngineTest, TellsWhoseTimeItTakes) {
  ResponseEngine engine = this->engine();
  engine.time_stages(true);
  engine.step(test::pressed(0.004));
  for (const Stage stage :
       {Stage::detection, Stage::force, Stage::interpolation, Stage::local_factor, Stage::normals}) {
    EXPECT_GT(engine.stages().spent_ns(stage), 0) << stage_names[static_cast<std::size_t>(stage)];
  }
  EXPECT_EQ(engine.stages().spent_ns(Stage::skeleton), 0);
}

TEST_F(ResponseEngineTest, AMissingFileIsNamedWithTheCommandThatWritesIt) {
  try {
    (void)make_engine(scene_);
    ADD_FAILURE() << "made without a file";
  } catch (const scene::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(scene::response_path(folder_.path(), identity()).string()));
    EXPECT_THAT(error.what(), HasSubstr("touchstone prepare"));
  }
  const scene::Plan plan = fast::plan(scene_);
  EXPECT_TRUE(std::ranges::any_of(plan, [](const scene::PlanLine& line) {
    return line.part == "body" && line.reason.find("touchstone prepare") != std::string::npos;
  }));
}

TEST_F(ResponseEngineTest, RunsOverATrackFromItsFile) {
  store_response();
  const fast::Run run = fast::run(scene_);
  EXPECT_EQ(status_text(run.status), "ok");
  EXPECT_TRUE(run.beams.empty());
  EXPECT_EQ(run.regions_max, 1);
  ResponseEngine engine = this->engine();
  for (const scene::InstantRecord& record : run.instants) {
    engine.step(record.tool);
    EXPECT_EQ(record.force_n(), engine.wrench().force_n);
    EXPECT_EQ(record.displacement_m, matrix_of(engine.field().displacement_m));
    EXPECT_EQ(record.normal, matrix_of(engine.field().normal));
  }
  for (const scene::PlanLine& line : fast::plan(scene_)) {
    if (line.part == "whole step") {
      EXPECT_THAT(line.cost, HasSubstr("measured"));
    } else if (line.part == "friction") {
      EXPECT_FALSE(line.modelled);
    }
  }
}

TEST_F(ResponseEngineTest, FrictionIsInTheRecordsAndThePlan) {
  scene_.contact.friction = scene::Friction{.K = 0.4, .beta = 1.0, .mu_D = 0.4};
  scene_.track = {
      {0.0, test::pressed(-0.0005, -0.003)}, {0.2, test::pressed(0.003, -0.003)}, {0.5, test::pressed(0.003, 0.003)}};
  store_response();
  const fast::Run run = fast::run(scene_), again = fast::run(scene_);
  EXPECT_EQ(status_text(run.status), "ok");
  for (std::size_t i = 0; i < run.instants.size(); ++i) {
    EXPECT_EQ(run.instants[i].force_n(), again.instants[i].force_n());
    EXPECT_EQ(run.instants[i].displacement_m, again.instants[i].displacement_m);
  }
  const scene::RegionRecord& last = run.instants.back().regions.front();
  EXPECT_TRUE(last.sliding);
  const double normal_n = (last.force_n - last.friction_n).norm();
  // The springs that were pulled aside while the tool was pressed in have nearly turned to its way.
  EXPECT_NEAR(last.friction_n.norm(), 0.4 * normal_n, 1e-4 * normal_n);
  EXPECT_LT(last.friction_n.x(), -0.39 * normal_n);
  EXPECT_EQ(run.instants.back().support_force_n, last.force_n);
  // Shear is part of the traction, against the tool's motion on the tool and with it on the body.
  scene::Vec3 sum_n = scene::Vec3::Zero();
  for (Eigen::Index i = 0; i < run.instants.back().traction_pa.cols(); ++i) {
    sum_n += run.surface.vertex_area_m2[static_cast<std::size_t>(i)] * run.instants.back().traction_pa.col(i);
  }
  EXPECT_NEAR(sum_n.x(), 0.4 * normal_n, 0.15 * normal_n);
  EXPECT_TRUE(std::ranges::any_of(run.instants, [](const scene::InstantRecord& record) {
    return !record.regions.empty() && !record.regions.front().sliding;
  }));
  bool planned = false;
  for (const scene::PlanLine& line : fast::plan(scene_)) {
    if (line.part != "friction") continue;
    planned = line.modelled;
    EXPECT_THAT(line.cost, HasSubstr("measured"));
  }
  EXPECT_TRUE(planned);
}

TEST_F(ResponseEngineTest, ThePlanSaysHowFarThePressureIsOffAndWhatFallsOff) {
  const auto reason = [&](const std::string& part) {
    for (const scene::PlanLine& line : fast::plan(scene_)) {
      if (line.part == part) return line.reason;
    }
    return std::string();
  };
  EXPECT_THAT(reason("pressure"), HasSubstr("under a ball, up to 9 % near an edge"));
  EXPECT_THAT(reason("body"), ::testing::StartsWith("20 columns")) << "as many as `prepare` computes";
  EXPECT_THAT(reason("contact force"), ::testing::EndsWith("in series with the body's compliance"));
  scene_.body.inclusions.push_back({});
  EXPECT_THAT(reason("pressure"), HasSubstr("NOT GOOD above a soft inclusion"));
  EXPECT_THAT(reason("contact force"), HasSubstr("fast.body_falloff_per_m = 0; `tune` can fit it"));
  scene_.fast.body_falloff_per_m = 250.0;
  EXPECT_THAT(reason("contact force"), HasSubstr("under a contact of 4 mm radius"));
  scene_.body.inclusions.clear();
  scene_.contact.friction = scene::Friction{.K = 0.4, .beta = 1.0, .mu_D = 0.4};
  EXPECT_THAT(reason("pressure"), HasSubstr("7 % off on a flat face, 20 % on a curved one, with friction"));
}

TEST_F(ResponseEngineTest, ReachesAsFarAsTheTool) { EXPECT_NEAR(engine().tool_reach_m(), scene_.tool.radius_m, 1e-9); }

}  // namespace
}  // namespace touchstone::fast
