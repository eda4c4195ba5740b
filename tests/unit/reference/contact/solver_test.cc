// The promises of solve(): resume bit for bit, answer at once from the store, release, and fail with a name.
#include "reference/solver.h"

#include "scene/shape/surface.h"
#include "support/ball_on_ball.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace touchstone::reference {
namespace {

class SolverTest : public testing::Test {
 protected:
  SolverTest()
      : root_(std::filesystem::temp_directory_path() / ("touchstone-solver-" + std::to_string(::getpid()))),
        scene_(press_and_release()),
        points_m_(scene::tessellate(*scene::body_shape(scene_.body), 64).points_m) {}
  ~SolverTest() override { std::filesystem::remove_all(root_); }

  Result run(const std::string& store, Options options = {}) {
    options.store = root_ / store;
    return solve(scene_, points_m_, options);
  }
  static void expect_identical(const Result& a, const Result& b) {
    ASSERT_EQ(a.instants.size(), b.instants.size());
    for (std::size_t i = 0; i < a.instants.size(); ++i) {
      EXPECT_EQ(a.instants[i].force_n(), b.instants[i].force_n());
      EXPECT_EQ(a.instants[i].displacement_m, b.instants[i].displacement_m);
      EXPECT_EQ(a.levels[0].force_n[i], b.levels[0].force_n[i]);
      EXPECT_EQ(a.instants[i].traction_pa, b.instants[i].traction_pa);
      EXPECT_EQ(a.instants[i].pressure_peak_pa, b.instants[i].pressure_peak_pa);
      ASSERT_EQ(a.instants[i].regions.size(), b.instants[i].regions.size());
      for (std::size_t r = 0; r < a.instants[i].regions.size(); ++r) {
        EXPECT_EQ(a.instants[i].regions[r].friction_n, b.instants[i].regions[r].friction_n);
        EXPECT_EQ(a.instants[i].regions[r].sliding, b.instants[i].regions[r].sliding);
      }
    }
  }

  void expect_resumed_bit_for_bit();

  std::filesystem::path root_;
  scene::Scene scene_;
  Eigen::Matrix3Xd points_m_;
};

void SolverTest::expect_resumed_bit_for_bit() {
  const Result whole = run("whole");
  std::atomic<bool> stop = false;
  int finished = 0, first_resumed = 0;
  Options options;
  options.stop = &stop;
  options.progress = [&](const Progress& progress) {
    finished += progress.step_finished ? 1 : 0;
    if (finished == 4 && progress.newton == 2 && !progress.step_finished) stop = true;  // within the fifth step
  };
  EXPECT_THROW(run("parts", options), Interrupted);
  EXPECT_EQ(finished, 4);
  Options resume;
  resume.progress = [&](const Progress& progress) {
    if (progress.step_finished && first_resumed == 0) first_resumed = progress.instant;
  };
  const Result resumed = run("parts", resume);
  EXPECT_EQ(first_resumed, 5);
  expect_identical(whole, resumed);
}

/// Its own surface at the deepest instant is the solution that the rest points see, solved now or before.
TEST_F(SolverTest, GivesItsOwnSurfaceAtTheDeepestInstant) {
  const Result solved = run("own-surface");
  const auto deepest = std::max_element(solved.instants.begin(), solved.instants.end(),
                                        [](const auto& a, const auto& b) { return a.depth_m < b.depth_m; });
  const BoundarySurface& own = solved.deepest_surface;
  ASSERT_GT(own.rest.points_m.cols(), 1000);
  ASSERT_GT(own.displacement_m.colwise().norm().maxCoeff(), 0.5 * deepest->depth_m);
  points_m_ = own.rest.points_m;
  const Result again = run("own-surface");
  ASSERT_TRUE(again.from_store);
  const auto& seen_m = again.instants[static_cast<std::size_t>(deepest - solved.instants.begin())].displacement_m;
  EXPECT_LT((seen_m - own.displacement_m).colwise().norm().maxCoeff(), 1e-6 * deepest->depth_m);
  EXPECT_EQ(again.deepest_surface.displacement_m, own.displacement_m);
  const auto& traction_pa = again.instants[static_cast<std::size_t>(deepest - solved.instants.begin())].traction_pa;
  const double peak_pa = own.traction_pa.colwise().norm().maxCoeff();
  EXPECT_LT((traction_pa - own.traction_pa).colwise().norm().maxCoeff(), 1e-5 * peak_pa);
  EXPECT_NEAR(deepest->pressure_peak_pa, peak_pa, 0.02 * peak_pa);
  EXPECT_EQ(again.deepest_surface.rest.points_m, own.rest.points_m);
}

TEST_F(SolverTest, InterruptedRunResumesBitForBit) { expect_resumed_bit_for_bit(); }

TEST_F(SolverTest, InterruptedFrictionResumesBitForBit) {
  scene_.contact.friction = scene::Friction{0.5, 0.8, 0.2};
  expect_resumed_bit_for_bit();
}

TEST_F(SolverTest, FrictionRemembersThePress) {
  scene_.body.material.poissons_ratio = 0.0;  // whose surface moves inwards under the ball, where friction holds it
  const Result without = run("without");
  scene_.contact.friction = scene::Friction{0.5, 0.8, 0.2};
  const Result with = run("with");
  EXPECT_NE(with.key, without.key);
  const std::size_t last = with.instants.size() - 1;
  for (std::size_t i = 1; i < last; ++i) {
    ASSERT_EQ(with.instants[i].regions.size(), 1u);
    const scene::RegionRecord& region = with.instants[i].regions[0];
    EXPECT_LT(region.friction_n.norm(), 0.5 * std::pow(region.force_n.norm(), 0.8));
    EXPECT_LT(with.instants[i].equilibrium_rel, 1e-6);
  }
  // Pressed, friction holds the ball up; taken off, it holds it down.
  for (std::size_t i = 2; i <= last / 2; ++i) {
    const double gain = with.instants[i].force_n().z() / without.instants[i].force_n().z();
    EXPECT_GT(gain, 1.0) << i;
    EXPECT_LT(gain, 1.1) << i;
    if (i == last / 2) continue;
    EXPECT_LT(with.instants[last - i].force_n().z(), with.instants[i].force_n().z()) << i;
  }
  EXPECT_EQ(with.instants[last].displacement_m.cwiseAbs().maxCoeff(), 0.0);
  const scene::Plan lines = plan(scene_);
  EXPECT_TRUE(
      std::any_of(lines.begin(), lines.end(), [](const auto& l) { return l.part == "friction" && l.modelled; }));
}

TEST_F(SolverTest, SecondRunAnswersFromTheStore) {
  const Result first = run("store");
  EXPECT_FALSE(first.from_store);
  const auto begin = std::chrono::steady_clock::now();
  const Result second = run("store");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  EXPECT_TRUE(second.from_store);
  EXPECT_EQ(first.key, content_key(scene_));
  EXPECT_EQ(first.linear_solver, second.linear_solver);
  expect_identical(first, second);
}

TEST_F(SolverTest, DamagedStepIsSolvedAgain) {
  const Result first = run("damaged");
  const auto file = root_ / "damaged" / first.key / "level-2" / "instant-5.step";
  ASSERT_TRUE(std::filesystem::exists(file));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  const Result second = run("damaged");
  EXPECT_FALSE(second.from_store);
  expect_identical(first, second);
}

TEST_F(SolverTest, ReleasesTheWayItPressed) {
  const Result result = run("release");
  const std::size_t last = result.instants.size() - 1;
  EXPECT_EQ(result.instants[0].force_n().norm(), 0.0);
  EXPECT_EQ(result.instants[last].force_n().norm(), 0.0);
  EXPECT_EQ(result.instants[last].displacement_m.cwiseAbs().maxCoeff(), 0.0);
  for (std::size_t i = 1; i < last; ++i) {
    const double down_n = result.instants[i].force_n().z(), up_n = result.instants[last - i].force_n().z();
    ASSERT_GT(down_n, 0.1);
    EXPECT_NEAR(up_n / down_n, 1.0, 1e-6);
    EXPECT_LT(result.instants[i].equilibrium_rel, 1e-6);
    EXPECT_LT(result.instants[i].residual_penetration_m, 1e-6 * result.instants[i].depth_m);
    EXPECT_LT(result.instants[i].between_nodes_penetration_m, 0.02 * result.instants[i].depth_m);
  }
}

TEST_F(SolverTest, TwoLevelsGiveNoUncertainty) {
  const Result result = run("two");
  for (const auto& instant : result.instants) EXPECT_TRUE(std::isnan(instant.force_uncertainty_n));
  EXPECT_TRUE(std::isnan(result.instants[3].displacement_uncertainty_m[0]));
}

TEST_F(SolverTest, KeyFollowsTheAnswerOnly) {
  const std::string key = content_key(scene_);
  scene::Scene other = scene_;
  other.title = "another title";
  other.tool.mass_kg = 5.0;
  other.fast.triangles = 17;
  other.contact.k1_n_per_m = 3.0;
  EXPECT_EQ(content_key(other), key);
  other.body.material.poissons_ratio = 0.4500000001;
  EXPECT_NE(content_key(other), key);
  other = scene_;
  other.track[1].pose.position_m.z() += 1e-9;
  EXPECT_NE(content_key(other), key);
  other = scene_;
  other.body.inclusions.emplace_back();
  const std::string with_inclusion = content_key(other);
  EXPECT_NE(with_inclusion, key);
  other.body.inclusions[0].material.youngs_modulus_pa = 1.0;
  EXPECT_NE(content_key(other), with_inclusion);
  other = scene_;
  other.body.shape = scene::BodyShape::revolution;
  other.body.profile = scene::capsule_profile(0.03, 0.01);
  const std::string capsule = content_key(other);
  other.body.profile.arc_radius_m[0] += 1e-9;
  EXPECT_NE(content_key(other), capsule);
}

TEST_F(SolverTest, FailureNamesInstantAndContact) {
  // A soft ball flattened to a tenth of its height by a much larger one.
  scene_.tool.radius_m = 0.3;
  scene_.track = {{0.0, {{0.0, 0.0, 0.361}, Eigen::Quaterniond::Identity()}},
                  {1.0, {{0.0, 0.0, 0.306}, Eigen::Quaterniond::Identity()}}};
  scene_.compare.instants = 3;
  scene_.reference.element_size_m = 0.02;
  try {
    run("fails");
    FAIL() << "converged";
  } catch (const NotConverged& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with("instant 2 of 3 (t = 0.5 s") || text.starts_with("instant 3 of 3 (t = 1 s")) << text;
    EXPECT_NE(text.find("depth "), std::string::npos) << text;
    EXPECT_NE(text.find("Try "), std::string::npos) << text;
    EXPECT_NE(text.find("contact region 1 of 1, around (0, 0, 0.0"), std::string::npos) << text;
    EXPECT_NE(text.find("largest out-of-balance force at ("), std::string::npos) << text;
  }
}

TEST_F(SolverTest, PlanNamesSymmetryAndWhatIsLeftOut) {
  const scene::Plan lines = plan(scene_);
  const auto find = [&](const std::string& part) {
    for (const auto& line : lines) {
      if (line.part == part) return &line;
    }
    return static_cast<const scene::PlanLine*>(nullptr);
  };
  ASSERT_TRUE(find("axial symmetry"));
  EXPECT_TRUE(find("axial symmetry")->modelled);
  ASSERT_TRUE(find("friction"));
  EXPECT_FALSE(find("friction")->modelled);
  ASSERT_TRUE(find("mesh 2"));
  EXPECT_NE(find("mesh 2")->cost.find("unknowns"), std::string::npos);
  ASSERT_TRUE(find("all meshes"));
  EXPECT_NE(find("all meshes")->reason.find("7 load steps in contact"), std::string::npos)
      << find("all meshes")->reason;
  EXPECT_NE(find("all meshes")->cost.find(" s"), std::string::npos);
}

}  // namespace
}  // namespace touchstone::reference
