#include "compare/errors/figures.h"

#include "compare/errors/compute_errors.h"
#include "fast/command/results.h"
#include "support/synthetic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

namespace touchstone::compare {
namespace {

scene::Figures figures_of(const testing::Sides& sides) {
  return make_figures(compute_errors(sides.scene, sides.run, sides.result.instants), sides.result,
                      fast::figures(sides.run));
}

const scene::Figure& find(const scene::Figures& figures, const std::string& key) {
  static const scene::Figure none{"missing", 0.0, "missing", ""};
  const auto found = std::find_if(figures.begin(), figures.end(), [&](const auto& f) { return f.key == key; });
  return found == figures.end() ? none : *found;
}

TEST(Figures, HoldEveryKeyOfTheDesignInItsOrder) {
  const char* const keys[] = {"force.nrmse",
                              "force.peak_rel",
                              "force.rel_above_10pct_depth",
                              "force.friction_nrmse",
                              "force.slip_onset_error_m",
                              "shape.rel_l2",
                              "shape.max_over_depth",
                              "shape.inside_r_rel_l2",
                              "shape.outside_r_rel_l2",
                              "shape.hausdorff_m",
                              "shape.volume_change_rel",
                              "contact.area_iou",
                              "reference.force_uncertainty_rel",
                              "reference.shape_uncertainty_rel",
                              "reference.residual_penetration_rel",
                              "reference.equilibrium_rel",
                              "reference.dofs",
                              "reference.wall_s",
                              "reference.model",
                              "fast.step_us.p50",
                              "fast.step_us.p99",
                              "fast.step_us.p999",
                              "fast.step_us.max",
                              "fast.force_us.p50",
                              "fast.force_us.p99",
                              "fast.setup_s",
                              "fast.memory_bytes",
                              "fast.triangles",
                              "fast.regions_max",
                              "fast.status"};
  const scene::Figures figures = figures_of(testing::pressed(5, 200));
  auto from = figures.begin();
  for (const char* key : keys) {
    from = std::find_if(from, figures.end(), [&](const auto& f) { return f.key == key; });
    ASSERT_NE(from, figures.end()) << key;
  }
}

TEST(Figures, AreUniqueAndEachHasAMeaning) {
  std::set<std::string> seen;
  for (const scene::Figure& figure : figures_of(testing::pressed(5, 200))) {
    EXPECT_TRUE(seen.insert(figure.key).second) << figure.key;
    EXPECT_FALSE(figure_meaning(figure.key).empty()) << figure.key;
  }
  EXPECT_TRUE(figure_meaning("no.such_key").empty());
}

TEST(Figures, NameEveryRegionAndItsMeaning) {
  testing::Sides sides = testing::pressed(5, 200);
  for (const bool fast : {true, false}) {
    scene::InstantRecord& record = fast ? sides.run.instants[4] : sides.result.instants[4];
    record.regions.push_back(record.regions[0]);
    record.regions.back().id = 12;
    record.regions.back().torque_nm = scene::Vec3(0.0, 1.0, 0.0);
  }
  sides.result.instants[4].region_middles_m = {scene::Vec3(0.0, 0.0, 0.06), scene::Vec3(0.01, 0.0, 0.06)};
  const scene::Figures figures = figures_of(sides);
  EXPECT_TRUE(find(figures, "force.region12.nrmse").text.empty());
  EXPECT_EQ(find(figures, "force.region12.nrmse_uncertainty").text, "unknown");
  EXPECT_FALSE(figure_meaning("force.region12.nrmse").empty());
  EXPECT_TRUE(figure_meaning("force.region12.no_such").empty());
}

TEST(Figures, SayWhyThereIsNoSlipOnset) {
  testing::Sides sides = testing::pressed(5, 200);
  EXPECT_EQ(find(figures_of(sides), "force.slip_onset_error_m").text, "undefined: the scene has no friction");
  sides.scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  EXPECT_EQ(find(figures_of(sides), "force.slip_onset_error_m").text, "undefined: neither side ever slips");
  sides.result.instants[4].regions[0].sliding = true;
  EXPECT_EQ(find(figures_of(sides), "force.slip_onset_error_m").text, "undefined: the fast model never slips");
  sides.run.instants[4].regions[0].sliding = true;
  EXPECT_EQ(find(figures_of(sides), "force.slip_onset_error_m").number, 0.0);
}

TEST(Figures, CarryTheErrorsTheirUncertaintyAndUnits) {
  testing::Sides sides = testing::pressed(5, 200);
  const Errors errors = compute_errors(sides.scene, sides.run, sides.result.instants);
  const scene::Figures figures = figures_of(sides);
  EXPECT_EQ(find(figures, "force.nrmse").number, *errors.force_nrmse.value);
  EXPECT_EQ(find(figures, "force.nrmse_uncertainty").number, *errors.force_nrmse.uncertainty);
  EXPECT_EQ(find(figures, "force.peak_rel").number, *errors.force_peak_rel.value);
  EXPECT_EQ(find(figures, "force.rel_above_10pct_depth").number, *errors.force_rel_deep.value);
  EXPECT_EQ(find(figures, "shape.rel_l2").number, *errors.shape_rel_l2.value);
  EXPECT_EQ(find(figures, "shape.max_over_depth").number, *errors.shape_max_over_depth.value);
  EXPECT_EQ(find(figures, "shape.inside_r_rel_l2").number, *errors.shape_inside_r_rel_l2.value);
  EXPECT_EQ(find(figures, "shape.outside_r_rel_l2").number, *errors.shape_outside_r_rel_l2.value);
  EXPECT_EQ(find(figures, "shape.hausdorff_m").number, *errors.shape_hausdorff_m.value);
  EXPECT_EQ(find(figures, "shape.hausdorff_m").unit, "m");
  EXPECT_EQ(find(figures, "shape.volume_change_rel").number, errors.volume_change_fast_rel);
  EXPECT_EQ(find(figures, "contact.area_iou").number, *errors.contact_area_iou);
  EXPECT_EQ(find(figures, "reference.force_uncertainty_rel").number, *errors.reference.force_uncertainty_rel);
  // The reference's own figure, summed by itself, equals the one in the norm of the comparison.
  EXPECT_NEAR(find(figures, "reference.shape_uncertainty_rel").number, *errors.shape_rel_l2.uncertainty, 1e-12);
  EXPECT_EQ(find(figures, "reference.residual_penetration_rel").number, *errors.reference.residual_penetration_rel);
  EXPECT_EQ(find(figures, "reference.penetration_between_nodes_rel").number, *errors.reference.between_nodes_rel);
  EXPECT_EQ(find(figures, "reference.equilibrium_rel").number, *errors.reference.equilibrium_rel);
  EXPECT_EQ(find(figures, "reference.volume_change_rel").number, errors.reference.volume_change_rel);
  EXPECT_EQ(find(figures, "reference.dofs").number, 275200.0);
  EXPECT_NEAR(find(figures, "reference.wall_s").number, 2.4 * (1 + 11 + 121), 1e-9);
  EXPECT_EQ(find(figures, "reference.wall_s").unit, "s");
  EXPECT_EQ(find(figures, "reference.model").text, sides.result.model);
}

TEST(Figures, AreReadableByPeople) {
  EXPECT_EQ(figure_text({"shape.rel_l2", 0.643, "", ""}), "64.3\u00a0%");
  EXPECT_EQ(figure_text({"fast.triangles", 3888.0, "", ""}), "3888");
  EXPECT_EQ(figure_text({"shape.hausdorff_m", 0.0009, "", "m"}), "0.9\u00a0mm");
  EXPECT_EQ(figure_text({"fast.status", 0.0, "ok", ""}), "ok");
}

TEST(Figures, SayWhenTheBandIsUnknown) {
  testing::Sides sides = testing::pressed(5, 200);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(find(figures_of(sides), "force.nrmse_uncertainty").text, "unknown");
  EXPECT_TRUE(std::isnan(find(figures_of(sides), "force.nrmse_uncertainty").number)) << "a text among numbers";
  EXPECT_TRUE(std::isnan(find(figures_of(sides), "reference.force_uncertainty_rel").number));
  EXPECT_TRUE(std::isnan(find(figures_of(sides), "force.friction_nrmse").number)) << "without friction";
  EXPECT_EQ(find(figures_of(sides), "reference.force_uncertainty_rel").text, "unknown");
}

}  // namespace
}  // namespace touchstone::compare
