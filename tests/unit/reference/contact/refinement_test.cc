// Refinement towards an error: where it ends, what it says, what it finds again, and where its levels start from.
#include "reference/contact/contact_problem.h"
#include "reference/contact/load_path.h"
#include "reference/run/cost.h"
#include "reference/run/model_choice.h"
#include "reference/run/run.h"
#include "reference/run/sensitivity.h"
#include "reference/run/uncertainty.h"
#include "reference/solver.h"

#include "scene/shape/surface.h"
#include "support/ball_on_ball.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <thread>

namespace touchstone::reference {
namespace {

using testing::HasSubstr;

class RefinementTest : public testing::Test {
 protected:
  RefinementTest()
      : root_(std::filesystem::temp_directory_path() / ("touchstone-refinement-" + std::to_string(::getpid()))),
        scene_(ball_on_ball_scene({{0.0, 0.0702}, {1.0, 0.0662}}, 6, 0.5)),
        surface_(scene::tessellate(*scene::body_shape(scene_.body), 128)) {}
  ~RefinementTest() override { std::filesystem::remove_all(root_); }

  /// Solves, and notes the levels on which a step was solved.
  Result run(Options options = {}) {
    solved_.clear();
    options.store = root_;
    options.rest_area_m2 = surface_.vertex_area_m2;
    options.progress = [&](const Progress& progress) {
      if (progress.step_finished) solved_.insert(progress.level);
      if (watch_) watch_(progress);
    };
    return solve(scene_, surface_.points_m, options);
  }
  Result run_to(double error) {
    scene_.reference.error = error;
    return run();
  }

  std::filesystem::path root_;
  scene::Scene scene_;
  scene::Surface surface_;
  std::set<int> solved_;
  std::function<void(const Progress&)> watch_;

  /// A limit that the estimates fit into, and a watch that lets it pass where `when` first holds.
  Options over_at(const std::function<bool(const Progress&)>& when) {
    Options options;
    options.seconds_limit = 4.0;
    watch_ = [when, begin = std::chrono::steady_clock::now(), done = false](const Progress& progress) mutable {
      if (done || !when(progress)) return;
      done = true;
      std::this_thread::sleep_until(begin + std::chrono::milliseconds(4100));
    };
    return options;
  }
  /// What a solve that ends without an answer says.
  std::string limit_reached(const Options& options) {
    try {
      (void)run(options);
    } catch (const LimitReached& limit) {
      return limit.what();
    }
    ADD_FAILURE() << "there is an answer";
    return "";
  }
};

TEST_F(RefinementTest, EndsWhenForceAndShapeAreKnown) {
  const Result rough = run_to(0.05);
  EXPECT_TRUE(rough.refinement.reached) << rough.refinement.why_ended;
  EXPECT_GE(rough.levels.size(), 3u);
  EXPECT_LE(*rough.force_uncertainty_rel, 0.05);
  EXPECT_LE(*rough.shape_uncertainty_rel, 0.05);
  const std::string key = rough.key;

  const Result fine = run_to(0.004);
  EXPECT_TRUE(fine.refinement.reached) << fine.refinement.why_ended;
  EXPECT_LE(std::max(*fine.force_uncertainty_rel, *fine.shape_uncertainty_rel), 0.004);
  ASSERT_GT(fine.levels.size(), rough.levels.size());
  // One level fewer would not have done.
  scene_.reference.levels = static_cast<int>(fine.levels.size()) - 1;
  const Result fewer = run();
  EXPECT_TRUE(fewer.from_store);
  EXPECT_GT(std::max(*fewer.force_uncertainty_rel, *fewer.shape_uncertainty_rel), 0.004);
  EXPECT_EQ(fewer.key, key);
}

TEST_F(RefinementTest, FindsTheLevelsOfAnEarlierRun) {
  const Result rough = run_to(0.05);
  const int first = static_cast<int>(rough.levels.size());
  const Result fine = run_to(0.004);
  ASSERT_FALSE(solved_.empty());
  EXPECT_GT(*solved_.begin(), first);
  for (int level = 0; level < first; ++level) EXPECT_EQ(rough.levels[level].force_n, fine.levels[level].force_n);
  const Result again = run_to(0.05);
  EXPECT_TRUE(again.from_store);
  EXPECT_EQ(again.levels.size(), rough.levels.size());
  for (std::size_t i = 0; i < rough.instants.size(); ++i) {
    EXPECT_EQ(again.instants[i].force_uncertainty_n, rough.instants[i].force_uncertainty_n);
  }
}

TEST_F(RefinementTest, SaysThatTheMemoryEndedIt) {
  scene_.reference.error = 0.0002;
  Options options;
  options.memory_limit_bytes = expected_memory_bytes(2, 6000.0);
  const Result result = run(options);
  EXPECT_FALSE(result.refinement.reached);
  EXPECT_EQ(result.refinement.ended_by, EndedBy::memory);
  EXPECT_NE(result.refinement.why_ended.find("GiB of memory"), std::string::npos) << result.refinement.why_ended;
  EXPECT_LE(result.levels.back().unknowns, 6000);
  const std::string next = "no mesh " + std::to_string(result.levels.size() + 1) + ":";
  EXPECT_NE(result.refinement.why_ended.find(next), std::string::npos) << result.refinement.why_ended;
}

TEST_F(RefinementTest, NoMeshIsBegunThatCannotBeFinished) {
  Options time;
  time.seconds_limit = 0.001;
  const std::string why = limit_reached(time);
  EXPECT_THAT(why, HasSubstr("mesh 1 is not finished: its "));
  EXPECT_THAT(why, HasSubstr(" for 5 load steps, more than the 0.0 s left, and all that is left of 3 meshes about "));
  EXPECT_THAT(why, HasSubstr("reference.element_size_m"));
  Options memory;
  memory.memory_limit_bytes = 1e6;
  EXPECT_THAT(limit_reached(memory), HasSubstr(" GiB of memory, more than 0.00093 GiB"));
  // Who asks for a number of meshes is limited, too.
  scene_.reference.levels = 2;
  EXPECT_THAT(limit_reached(memory), HasSubstr(" GiB of memory"));
  EXPECT_TRUE(solved_.empty());
  scene_.body.shape = scene::BodyShape::revolution;
  scene_.body.profile = {{{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.06}, {0.0, 0.06}}, {}};
  scene_.reference.element_size_m = 1e-8;
  EXPECT_THAT(limit_reached({}), HasSubstr("more than 300000 cells"));
}

/// Neither what is solved of the first mesh is lost nor the time to solve it again.
TEST_F(RefinementTest, TheTimeIsUpWithinTheFirstMesh) {
  const Options options = over_at([](const Progress& p) { return p.step_finished && p.instant == 3; });
  const std::string why = limit_reached(options);
  EXPECT_THAT(why, HasSubstr("the time was up after 3 of its 6 instants, which are kept; the next run goes on from "
                             "there, and needs about "));
  EXPECT_THAT(why, HasSubstr(" for this mesh, and all that is left of 3 meshes about "));
  std::set<int> instants;
  watch_ = [&](const Progress& p) {
    if (p.step_finished && p.level == 1) instants.insert(p.instant);
  };
  const Result resumed = run();
  EXPECT_EQ(instants, (std::set<int>{4, 5, 6}));
  std::filesystem::remove_all(root_);
  EXPECT_EQ(run().levels[0].force_n, resumed.levels[0].force_n);
}

/// The last finished mesh is the answer, without an uncertainty, and the unfinished one is gone on with.
TEST_F(RefinementTest, TheTimeIsUpBetweenTwoNewtonIterations) {
  const Options options = over_at([](const Progress& p) { return p.level == 2 && p.instant == 4 && p.newton == 1; });
  const Result result = run(options);
  EXPECT_EQ(result.levels.size(), 1u);
  EXPECT_FALSE(result.refinement.reached);
  EXPECT_FALSE(std::isfinite(*result.force_uncertainty_rel));
  EXPECT_FALSE(std::isfinite(*result.shape_uncertainty_rel));
  const std::string& why = result.refinement.why_ended;
  EXPECT_TRUE(why.starts_with("there is no mesh 2: the time was up after 3 of its 6 instants, which are kept")) << why;
  EXPECT_TRUE(why.ends_with("; an uncertainty needs 3")) << why;
  int first = 0;
  watch_ = [&](const Progress& p) {
    if (p.step_finished && first == 0) first = 10 * p.level + p.instant;
  };
  EXPECT_EQ(run().levels.size(), 3u);
  EXPECT_EQ(first, 24);
}

TEST_F(RefinementTest, TheTimeIsUpWithinTheSensitivities) {
  scene_.reference.error = 0.05;
  const Options options = over_at([](const Progress& p) { return p.note == "sensitivity to the far_field"; });
  const Result result = run(options);
  EXPECT_EQ(result.levels.size(), 3u);
  EXPECT_TRUE(result.sensitivities.empty());
  EXPECT_FALSE(std::isfinite(*result.force_uncertainty_rel));
  EXPECT_FALSE(result.refinement.reached);
  const std::string& why = result.refinement.why_ended;
  EXPECT_TRUE(why.starts_with("the uncertainty is unknown after 3 meshes: the time was up before all sensitivities"))
      << why;
  std::set<std::string> measured;
  watch_ = [&](const Progress& p) {
    if (p.event) measured.insert(p.note);
  };
  const Result again = run();
  EXPECT_EQ(measured, (std::set<std::string>{"sensitivity to the far_field"})) << "the others are kept";
  EXPECT_TRUE(again.refinement.reached) << again.refinement.why_ended;
  EXPECT_TRUE(std::isfinite(*again.force_uncertainty_rel));
}

TEST_F(RefinementTest, NoSensitivityIsBegunThatCannotBeFinished) {
  // The finest cells of the three meshes have fewer unknowns than the far field's halved ones would have here.
  scene_.reference.element_size_m = 0.012;
  scene_.reference.levels = 3;
  const ModelChoice choice = choose_model(scene_);
  double finest = 0.0, far_field = 0.0;
  for (int level = 0; level < 3; ++level) finest = std::max(finest, unknowns_of(level_mesh<2>(scene_, choice, level)));
  far_field = unknowns_of(level_mesh<2>(scene_, choice, 0, {.far_field = 0.5}));
  ASSERT_GT(far_field, finest);
  Options options;
  options.memory_limit_bytes = expected_memory_bytes(2, 0.5 * (finest + far_field));
  const Result result = run(options);
  EXPECT_EQ(result.levels.size(), 3u);
  EXPECT_FALSE(std::isfinite(*result.force_uncertainty_rel));
  EXPECT_THAT(result.refinement.why_ended, HasSubstr("the sensitivities, which it needs, would take about "));
  EXPECT_THAT(result.refinement.why_ended, HasSubstr(" GiB of memory"));
}

TEST_F(RefinementTest, ANumberOfMeshesIsAReason) {
  for (const auto& [levels, why] :
       {std::pair(1, "1 mesh was asked for; an uncertainty needs 3"),
        std::pair(2, "2 meshes were asked for; an uncertainty needs 3"), std::pair(3, "3 meshes were asked for")}) {
    scene_.reference.levels = levels;
    EXPECT_EQ(run().refinement.why_ended, why);
  }
}

/// Of the whole work that is known: it shrinks, it does not end before the work does, and it says so when more may
/// come.
TEST_F(RefinementTest, TheTimeLeftIsThatOfAllMeshes) {
  std::vector<std::pair<int, double>> left;  // of what mesh, in seconds
  watch_ = [&](const Progress& p) {
    EXPECT_EQ(p.levels, 3);
    EXPECT_TRUE(p.at_least);
    EXPECT_GT(p.seconds_left, 0.0) << p.level << ' ' << p.instant << ' ' << p.note;
    if (p.step_finished) left.emplace_back(p.level, p.seconds_left);
  };
  scene_.reference.error = 0.05;
  const auto begin = std::chrono::steady_clock::now();
  const Result result = run();
  ASSERT_EQ(result.levels.size(), 3u);
  const double all_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  // In the middle of the work it is known within a factor of four, on a busy machine as well.
  const auto middle = std::find_if(left.begin(), left.end(), [](const auto& one) { return one.first == 2; });
  EXPECT_GT(middle->second, 0.1 * all_s);
  EXPECT_LT(middle->second, 3.0 * all_s);
  EXPECT_LT(left.back().second, middle->second);
}

TEST_F(RefinementTest, TheFirstEstimateIsOfAllMeshesAndTheSensitivities) {
  const ModelChoice choice = choose_model(scene_);
  const Discretisation<2> coarsest = level_mesh<2>(scene_, choice, 0);
  constexpr int load_steps = 5;  // of six instants the first is apart
  double meshes_s = 0.0, sensitivities_s = 0.0;
  for (int level = 0; level < 3; ++level) {
    const double unknowns = unknowns_of(level_mesh<2>(scene_, choice, level));
    meshes_s += expected_cost({.dim = 2, .unknowns = unknowns, .load_steps = load_steps}, ranks::threads()).seconds;
  }
  for (const SensitivityWork& one : missing_sensitivities<2>(scene_, choice, coarsest, load_steps, nullptr)) {
    sensitivities_s += expected_cost(one.work, ranks::threads()).seconds;
  }
  std::optional<double> first_s;
  std::atomic<bool> stop = false;
  watch_ = [&](const Progress& p) {
    if (!p.event || first_s) return;
    first_s = p.seconds_left;
    stop = true;
  };
  EXPECT_THROW((void)run({.store = {}, .progress = {}, .stop = &stop}), Interrupted);
  ASSERT_GT(sensitivities_s, 0.05 * meshes_s);
  // The first instant, which is apart, counts as a load step until it is over.
  const double step_s =
      expected_cost({.dim = 2, .unknowns = unknowns_of(coarsest), .load_steps = 1}, ranks::threads()).seconds;
  ASSERT_LT(step_s, 0.5 * sensitivities_s);
  EXPECT_NEAR(first_s.value(), meshes_s + sensitivities_s + step_s, 0.01 * sensitivities_s);
}

/// Without friction the answer does not depend on where Newton starts: a level followed along its own load path ends
/// in the same force, after more iterations.
TEST_F(RefinementTest, CoarserLevelSavesIterationsAndMovesNothing) {
  scene_.reference.levels = 3;
  const Result result = run();
  const ModelChoice choice = choose_model(scene_);
  ContactProblem<2> problem(level_mesh<2>(scene_, choice, 2), scene_.body.material, scene_.reference.kinematics, true,
                            true, 1);
  const auto body = scene::body_shape(scene_.body);
  LoadPath<2> path(problem, [&](double time_s) -> std::optional<RigidTool<2>> {
    const scene::Pose pose = scene::pose_at(scene_.track, time_s);
    if (scene::rest_depth_m(*body, scene_.tool, pose) <= 0.0) return std::nullopt;
    return RigidTool<2>(choice.tool, pose);
  });
  const std::vector<double> times_s = scene::instants_s(scene_);
  int iterations = 0;
  std::optional<Solved<2>> before;
  Solved<2> current{times_s[0] - 1.0, problem.rest(), false};
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    Solved<2> next;
    const AdvanceReport report = path.advance(before ? &*before : nullptr, current, times_s[i], next, {}, {});
    ASSERT_TRUE(report.converged);
    iterations += report.newton_iterations;
    const double force_n = problem.observe(next.state).force_n.norm();
    EXPECT_NEAR(result.levels[2].force_n[i], force_n, 1e-7 * force_n) << i;
    before = std::move(current);
    current = std::move(next);
  }
  EXPECT_LT(result.levels[2].newton_iterations, iterations);
}

TEST_F(RefinementTest, SensitivitiesAreMeasuredOnce) {
  scene_.reference.levels = 3;
  const Result result = run();
  std::set<std::string> parts;
  for (const Sensitivity& one : result.sensitivities) {
    parts.insert(one.part);
    if (one.part == "far_field") {
      EXPECT_GT(one.force_rel, 1e-6);
      EXPECT_LT(one.force_rel, 0.01);
      EXPECT_GT(one.shape_rel, 1e-5);
      EXPECT_GT(share_at(one, 2), 1.0);
      EXPECT_LT(share_at(one, 4), share_at(one, 3));
    } else {
      // Frictionless contact in the end knows no steps, no parameter and no numerical modulus.
      EXPECT_LT(one.force_rel, 1e-7) << one.part;
      EXPECT_LT(one.shape_rel, 1e-7) << one.part;
      EXPECT_EQ(share_at(one, 3), 1.0);
    }
  }
  EXPECT_EQ(parts, (std::set<std::string>{"load_step", "contact_parameter", "numerical_bulk", "far_field"}));
  const Result again = run();
  EXPECT_TRUE(again.from_store);
  ASSERT_EQ(again.sensitivities.size(), result.sensitivities.size());
  for (std::size_t i = 0; i < again.sensitivities.size(); ++i) {
    EXPECT_EQ(again.sensitivities[i].force_rel, result.sensitivities[i].force_rel);
    EXPECT_EQ(again.sensitivities[i].shape_rel, result.sensitivities[i].shape_rel);
  }
}

/// The answer is kept where a solve that only serves its uncertainty fails.
TEST_F(RefinementTest, ASensitivityThatDoesNotConvergeCostsTheBandAlone) {
  scene_.reference.levels = 4;
  watch_ = [](const Progress& progress) {
    if (progress.note == "sensitivity to the contact_parameter") throw NotConverged("the sensitivity failed");
  };
  const Result result = run();
  EXPECT_EQ(result.levels.size(), 4u);
  EXPECT_GT(result.instants.back().force_n().z(), 0.1);
  EXPECT_TRUE(std::isnan(result.instants.back().force_uncertainty_n));
  EXPECT_TRUE(std::isnan(result.instants.back().pressure_peak_uncertainty_pa));
  EXPECT_EQ(result.refinement.ended_by, EndedBy::sensitivity);
  EXPECT_THAT(result.refinement.why_ended, HasSubstr("uncertainty is unknown after 3 meshes: the sensitivity failed"));
  // Without a number of meshes it ends where the uncertainty would be known.
  scene_.reference.levels.reset();
  const Result refined = run_to(0.02);
  EXPECT_EQ(refined.levels.size(), 3u);
  EXPECT_EQ(refined.refinement.ended_by, EndedBy::sensitivity);
  watch_ = {};
  EXPECT_TRUE(std::isfinite(run_to(0.02).instants.back().force_uncertainty_n));
}

/// The band holds the differences of the levels and, on top, what those do not show.
TEST_F(RefinementTest, SensitivitiesWidenTheBand) {
  scene_.reference.levels = 3;
  const Result result = run();
  std::vector<std::vector<double>> forces_n;
  for (const LevelRecord& level : result.levels) forces_n.push_back(level.force_n);
  const std::vector<double> mesh_n = force_band(forces_n, {1.0, 2.0, 4.0});
  double sum_rel = 0.0;
  for (const Sensitivity& one : result.sensitivities) sum_rel += share_at(one, 2) * one.force_rel;
  EXPECT_GT(sum_rel, 1e-6);
  for (std::size_t i = 0; i < mesh_n.size(); ++i) {
    EXPECT_NEAR(result.instants[i].force_uncertainty_n, mesh_n[i] + sum_rel * result.instants[i].force_n().norm(),
                1e-12);
  }
}

/// With friction in few steps no mesh helps.
TEST_F(RefinementTest, EndsWhereMeshesDoNotHelp) {
  scene_.contact.friction = scene::Friction{.K = 0.3, .beta = 1.0, .mu_D = 0.3};
  scene_.compare.instants = 4;
  const Result result = run_to(5e-4);
  EXPECT_FALSE(result.refinement.reached);
  EXPECT_EQ(result.levels.size(), 3u);
  EXPECT_EQ(result.refinement.ended_by, EndedBy::sensitivity);
  EXPECT_NE(result.refinement.why_ended.find("finer meshes do not help"), std::string::npos)
      << result.refinement.why_ended;
  EXPECT_NE(result.refinement.why_ended.find("more instants would"), std::string::npos) << result.refinement.why_ended;
}

/// One formulation serves every Poisson's ratio, and near one half nothing locks.
TEST_F(RefinementTest, EveryPoissonsRatioReachesTheError) {
  double before_n = 0.0;
  for (const double nu : {0.0, 0.3, 0.4999, 0.5}) {
    scene_.body.material.poissons_ratio = nu;
    const Result result = run_to(0.02);
    EXPECT_TRUE(result.refinement.reached) << nu << ": " << result.refinement.why_ended;
    const double force_n = result.instants.back().force_n().z();
    EXPECT_GT(force_n, before_n) << nu;
    if (nu == 0.5) {
      EXPECT_NEAR(force_n / before_n, 1.0, 2e-3);
    }
    before_n = force_n;
  }
}

}  // namespace
}  // namespace touchstone::reference
