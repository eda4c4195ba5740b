// CalculiX 2.20 on the exported decks against the reference: force and surface at every depth.
#include "compare/calculix/calculix.h"
#include "reference/solver.h"
#include "second_code/pressed_scene.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <optional>

namespace touchstone::second_code {
namespace {

struct Both {
  const char* name;
  scene::Body (*body)(double poissons_ratio);
  double poissons_ratio, depth_m;
  int steps, deck_level, reference_levels;
  std::optional<double> element_size_m;
  double force_limit;               ///< fraction of the reference's force
  double surface_limit = 0.02;      ///< fraction of the largest displacement
  std::optional<double> coulomb{};  ///< friction coefficient
  friend void PrintTo(const Both& both, std::ostream* out) { *out << both.name; }
};

class BothCodes : public testing::TestWithParam<Both> {
 protected:
  BothCodes()
      : root_(std::filesystem::temp_directory_path() / ("touchstone-second-code-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(root_);
  }
  ~BothCodes() override { std::filesystem::remove_all(root_); }
  std::filesystem::path root_;
};

TEST_P(BothCodes, GiveOneForceAndOneSurface) {
  const Both& both = GetParam();
  scene::Scene scene = pressed(both.body(both.poissons_ratio), both.depth_m, both.steps);
  scene.reference.levels = both.reference_levels;
  scene.reference.element_size_m = both.element_size_m;
  if (both.coulomb) scene.contact.friction = scene::Friction{.K = *both.coulomb, .beta = 1.0, .mu_D = *both.coulomb};
  const reference::Deck deck = reference::calculix_deck(scene, {.level = both.deck_level});
  std::ofstream(root_ / "pressed.inp") << deck.text;
  const compare::CalculixRun run = compare::run_calculix(root_, "pressed", deck);
  ASSERT_EQ(run.steps.size(), static_cast<std::size_t>(both.steps)) << "CalculiX did not converge";
  reference::Options options;
  options.store = root_ / "store";
  const reference::Result ours = reference::solve(scene, deck.surface_points_m, options);
  for (int step = 0; step < both.steps; ++step) {
    const compare::CalculixStep& theirs = run.steps[step];
    const scene::InstantRecord& record = ours.instants[deck.instants[step]];
    SCOPED_TRACE("at " + std::to_string(1e3 * record.depth_m) + " mm");
    const double force_n = record.force_n().z();
    ASSERT_GT(force_n, 1.0);
    EXPECT_NEAR(theirs.force_n.z() / force_n, 1.0, both.force_limit);
    const double largest_m = record.displacement_m.colwise().norm().maxCoeff();
    EXPECT_NEAR(largest_m, record.depth_m, 0.02 * record.depth_m);
    const double apart_m = (theirs.displacement_m - record.displacement_m).colwise().norm().maxCoeff();
    EXPECT_LT(apart_m, both.surface_limit * largest_m);
    RecordProperty("force_" + std::to_string(step), std::to_string(theirs.force_n.z() / force_n - 1.0));
    RecordProperty("surface_" + std::to_string(step), std::to_string(apart_m / largest_m));
  }
}

constexpr double quarter_size_m = 0.0024;
INSTANTIATE_TEST_SUITE_P(
    Pressed, BothCodes,
    testing::Values(Both{"CylinderCompressible", cylinder, 0.3, 0.003, 3, 2, 3, {}, 0.005},
                    Both{"CylinderRubber", cylinder, 0.49, 0.003, 3, 1, 3, {}, 0.005},
                    Both{"BallRubber", ball, 0.49, 0.003, 3, 1, 3, {}, 0.005},
                    Both{"QuarterBlockCompressible", block, 0.3, 0.004, 2, 0, 2, quarter_size_m, 0.02},
                    Both{"QuarterBlockRubber", block, 0.49, 0.004, 2, 0, 2, quarter_size_m, 0.02},
                    Both{"CylinderAroundSoftBall", cylinder_around_soft_ball, 0.3, 0.003, 3, 1, 3, {}, 0.005},
                    // Both codes are of first order in the steps.
                    Both{"CylinderWithFriction", cylinder, 0.49, 0.003, 8, 1, 3, {}, 0.005, 0.06, 0.3}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace touchstone::second_code
