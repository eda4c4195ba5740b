#include "compare/errors/errors.h"

#include "compare/errors/compute_errors.h"
#include "compare/errors/figures.h"
#include "fast/command/results.h"
#include "support/mesh_tools.h"
#include "support/synthetic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace touchstone::compare {
namespace {

using test::mesh_tool;

using scene::Vec3;
using testing::set_force;
using testing::Sides;

Errors errors_of(const Sides& sides) { return compute_errors(sides.scene, sides.run, sides.result.instants); }

/// Forces of 1 and (3, 0, 10) N against 2 and 10 N, with uncertainties of 0.2 and 0.5 N.
Sides with_forces() {
  Sides sides = testing::small();
  set_force(sides.run.instants[0], Vec3(0.0, 0.0, 1.0));
  set_force(sides.result.instants[0], Vec3(0.0, 0.0, 2.0));
  set_force(sides.run.instants[1], Vec3(3.0, 0.0, 10.0));
  set_force(sides.result.instants[1], Vec3(0.0, 0.0, 10.0));
  testing::set_each(sides.result, &scene::ReferenceInstant::force_uncertainty_n, {0.2, 0.5});
  return sides;
}

/// Displacements in millimetres; areas 1, 2, 3, 4. Point 0 is the contact point, all others are far from it.
Sides with_shapes() {
  Sides sides = testing::small();
  sides.result.instants[0].displacement_m.col(0) = Vec3(0.0, 0.0, -1e-3);
  sides.result.instants[1].displacement_m.col(0) = Vec3(0.0, 0.0, -10e-3);
  sides.result.instants[1].displacement_m.col(1) = Vec3(2e-3, 0.0, 0.0);
  sides.run.instants[1].displacement_m.col(0) = Vec3(0.0, 0.0, -8e-3);
  sides.run.instants[1].displacement_m.col(1) = Vec3(2e-3, 0.0, 0.0);
  sides.run.instants[1].displacement_m.col(2) = Vec3(0.0, 0.0, 1e-3);
  sides.result.instants[0].displacement_uncertainty_m[0] = 1e-4;
  sides.result.instants[1].displacement_uncertainty_m[1] = 3e-4;
  return sides;
}

TEST(Errors, ForceNrmseIsRmsOfTheVectorErrorOverThePeak) {
  const Errors e = errors_of(with_forces());
  EXPECT_NEAR(*e.force_nrmse.value, std::sqrt((1.0 + 9.0) / 2.0) / 10.0, 1e-14);
  EXPECT_NEAR(*e.force_nrmse.uncertainty, std::sqrt((0.04 + 0.25) / 2.0) / 10.0, 1e-14);
}

TEST(Errors, PeakForceErrorIsSigned) {
  Sides sides = with_forces();
  EXPECT_NEAR(*errors_of(sides).force_peak_rel.value, std::sqrt(109.0) / 10.0 - 1.0, 1e-14);
  EXPECT_NEAR(*errors_of(sides).force_peak_rel.uncertainty, 0.05, 1e-14);
  set_force(sides.run.instants[1], Vec3(0.0, 0.0, 4.0));
  EXPECT_NEAR(*errors_of(sides).force_peak_rel.value, -0.6, 1e-14);
}

TEST(Errors, RelativeForceErrorCountsOnlyAboveATenthOfTheLargestDepth) {
  // The first instant is exactly at a tenth and is excluded.
  const Errors e = errors_of(with_forces());
  EXPECT_FALSE(e.instants[0].deep);
  EXPECT_TRUE(e.instants[1].deep);
  EXPECT_NEAR(*e.force_rel_deep.value, 0.3, 1e-14);
  EXPECT_NEAR(*e.force_rel_deep.uncertainty, 0.05, 1e-14);
  EXPECT_NEAR(*e.instants[0].force_error_rel, 0.5, 1e-14);
}

TEST(Errors, ShapeIsWeightedByAreaOverAllInstants) {
  const Errors e = errors_of(with_shapes());
  // Errors squared 1*1 + 1*4 + 3*1, displacements squared 1*1 + 1*100 + 2*4, in mm^2.
  EXPECT_NEAR(*e.shape_rel_l2.value, std::sqrt(8.0 / 109.0), 1e-13);
  EXPECT_NEAR(*e.shape_rel_l2.uncertainty, std::sqrt((0.01 + 2 * 0.09) / 109.0), 1e-13);
  EXPECT_NEAR(*e.instants[1].shape_rel_l2.value, std::sqrt(7.0 / 108.0), 1e-13);
}

TEST(Errors, ShapeIsSplitAtTheLocalRadius) {
  const Errors e = errors_of(with_shapes());
  EXPECT_NEAR(*e.shape_inside_r_rel_l2.value, std::sqrt(5.0 / 101.0), 1e-13);
  EXPECT_NEAR(*e.shape_outside_r_rel_l2.value, std::sqrt(3.0 / 8.0), 1e-13);
  EXPECT_NEAR(*e.shape_error_outside_share, 3.0 / 8.0, 1e-13);
  Sides wide = with_shapes();
  wide.scene.fast.r_R_m = 1.0;
  EXPECT_NEAR(*errors_of(wide).shape_inside_r_rel_l2.value, std::sqrt(8.0 / 109.0), 1e-13);
  EXPECT_FALSE(errors_of(wide).shape_outside_r_rel_l2.value);
}

TEST(Errors, EveryRegionHasALocalRadiusOfItsOwn) {
  Sides sides = with_shapes();
  // Below point 0 and below point 2, which are far apart.
  const Vec3 under_m(0.0, 0.0, -1e-3);
  sides.result.instants[1].region_middles_m = {sides.run.surface.points_m.col(0) + under_m,
                                               sides.run.surface.points_m.col(2) + under_m};
  const Errors e = errors_of(sides);
  EXPECT_NEAR(*e.shape_inside_r_rel_l2.value, std::sqrt(8.0 / 101.0), 1e-13);
  EXPECT_NEAR(*e.shape_outside_r_rel_l2.value, 0.0, 1e-13);
}

TEST(Errors, AMeshToolTouchesWhereItsShapeDoes) {
  Sides sides = testing::pressed(3, 2000);
  const Errors exact = errors_of(sides);
  sides.scene.tool = mesh_tool(scene::Sphere(Vec3::Zero(), sides.scene.tool.radius_m), 5120);
  const Errors e = errors_of(sides);
  ASSERT_GT(exact.instants[2].penetration_fast_m, 0.0);
  EXPECT_NEAR(e.instants[2].penetration_fast_m / exact.instants[2].penetration_fast_m, 1.0, 0.05);
  EXPECT_NEAR(*e.contact_area_iou, *exact.contact_area_iou, 0.1);
}

TEST(Errors, LargestShapeErrorIsRelativeToTheDepthOfItsInstant) {
  const Errors e = errors_of(with_shapes());
  // 2 mm at 10 mm depth; 1 mm at 1 mm depth is larger but not deep.
  EXPECT_NEAR(*e.shape_max_over_depth.value, 0.2, 1e-13);
  EXPECT_NEAR(*e.shape_max_over_depth.uncertainty, 0.03, 1e-13);
  EXPECT_EQ(e.instants[1].shape_max_at, 0);
  EXPECT_NEAR(e.instants[1].shape_max_m, 2e-3, 1e-15);
}

TEST(Errors, HausdorffIsNoLargerThanThePointErrorAndKnownToTheUncertainty) {
  const Errors e = errors_of(with_shapes());
  EXPECT_GT(*e.shape_hausdorff_m.value, 0.0);
  EXPECT_LE(*e.shape_hausdorff_m.value, 2e-3 + 1e-15);
  EXPECT_NEAR(*e.shape_hausdorff_m.uncertainty, 3e-4, 1e-15);
}

/// Over points of areas 1, 2, 3, 4; the force's are other instants' errors.
TEST(Errors, TractionsAreComparedWhereBothSidesGiveThem) {
  Sides sides = with_forces();
  EXPECT_FALSE(errors_of(sides).contact_pressure_rel_l2.value);
  for (std::size_t t : {0, 1}) {
    sides.run.instants[t].traction_pa = sides.result.instants[t].traction_pa = Eigen::Matrix3Xd::Zero(3, 4);
    sides.result.instants[t].traction_uncertainty_pa = Eigen::VectorXd::Zero(4);
  }
  sides.result.instants[1].traction_pa.col(0) = Vec3(0.0, 0.0, -100.0);
  sides.result.instants[1].traction_pa.col(1) = Vec3(30.0, 0.0, -40.0);
  sides.result.instants[1].traction_uncertainty_pa[1] = 5.0;
  sides.result.instants[1].pressure_peak_pa = 100.0;
  sides.result.instants[1].pressure_peak_uncertainty_pa = 3.0;
  sides.run.instants[1].traction_pa.col(0) = Vec3(0.0, 0.0, -90.0);
  sides.run.instants[1].traction_pa.col(3) = Vec3(0.0, 0.0, -20.0);
  sides.run.instants[1].pressure_peak_pa = 90.0;
  const Errors e = errors_of(sides);
  const double scale = 1.0 * 100.0 * 100.0 + 2.0 * 50.0 * 50.0;
  EXPECT_NEAR(*e.contact_pressure_rel_l2.value, std::sqrt((100.0 + 2.0 * 2500.0 + 4.0 * 400.0) / scale), 1e-13);
  EXPECT_NEAR(*e.contact_pressure_rel_l2.uncertainty, std::sqrt(2.0 * 25.0 / scale), 1e-13);
  EXPECT_NEAR(*e.contact_pressure_peak_rel.value, -0.1, 1e-13);
  EXPECT_NEAR(*e.contact_pressure_peak_rel.uncertainty, 0.03, 1e-13);
}

/// The largest over the instants where the contact is deep; both axes from one instant.
TEST(Errors, HalfAxesOfTheReference) {
  Sides sides = with_forces();
  sides.result.instants[0].contact_half_axes_m = {5e-3, 1.5e-3};
  sides.result.instants[1].contact_half_axes_m = {4e-3, 1e-3};
  sides.result.instants[1].contact_half_axes_uncertainty_m = {1e-4, NAN};
  const scene::Figures figures = reference_figures(sides.result, errors_of(sides).reference);
  const auto value = [&](const std::string& key) {
    return std::ranges::find(figures, "reference.contact_" + key, &scene::Figure::key)->number;
  };
  EXPECT_EQ(value("long_half_axis_m"), 4e-3);
  EXPECT_NEAR(value("long_half_axis_uncertainty_rel"), 0.025, 1e-15);
  EXPECT_EQ(value("short_half_axis_m"), 1e-3);
  EXPECT_TRUE(std::isnan(value("short_half_axis_uncertainty_rel")));
  const std::vector<scene::Column> columns = reference_quality_columns(sides.result, "");
  const auto column = [&](const std::string& name) {
    return std::ranges::find(columns, "contact_" + name, &scene::Column::name)->values;
  };
  EXPECT_EQ(column("long_half_axis_m"), (std::vector{5e-3, 4e-3}));
  EXPECT_EQ(column("short_half_axis_m"), (std::vector{1.5e-3, 1e-3}));
  EXPECT_EQ(column("long_half_axis_uncertainty_m"), (std::vector{0.0, 1e-4}));
  EXPECT_TRUE(std::isnan(column("short_half_axis_uncertainty_m")[1]));
}

TEST(Errors, EqualSidesHaveNone) {
  Sides sides = testing::pressed(5, 200);
  sides.run.instants.assign(sides.result.instants.begin(), sides.result.instants.end());
  const Errors e = errors_of(sides);
  for (const Measure* m :
       {&e.force_nrmse, &e.force_peak_rel, &e.force_rel_deep, &e.shape_rel_l2, &e.shape_max_over_depth,
        &e.shape_inside_r_rel_l2, &e.shape_outside_r_rel_l2, &e.shape_hausdorff_m}) {
    ASSERT_TRUE(m->value);
    EXPECT_EQ(*m->value, 0.0);
    EXPECT_FALSE(m->distinguishable());
  }
  EXPECT_EQ(*e.contact_area_iou, 1.0);
  EXPECT_EQ(e.volume_change_fast_rel, e.volume_change_reference_surface_rel);
}

TEST(Errors, GrowInProportionToTheDifference) {
  Sides sides = testing::pressed(5, 200);
  const auto blend = [&](double share) {
    Sides blended = sides;
    for (std::size_t t = 0; t < 5; ++t) {
      const scene::InstantRecord &f = sides.run.instants[t], &r = sides.result.instants[t];
      blended.run.instants[t].displacement_m = r.displacement_m + share * (f.displacement_m - r.displacement_m);
      set_force(blended.run.instants[t], r.force_n() + share * (f.force_n() - r.force_n()));
    }
    return errors_of(blended);
  };
  const Errors one = blend(0.25), two = blend(0.5);
  EXPECT_NEAR(*two.force_nrmse.value, 2.0 * *one.force_nrmse.value, 1e-12);
  EXPECT_NEAR(*two.force_rel_deep.value, 2.0 * *one.force_rel_deep.value, 1e-12);
  EXPECT_NEAR(*two.shape_rel_l2.value, 2.0 * *one.shape_rel_l2.value, 1e-12);
  EXPECT_NEAR(*two.shape_max_over_depth.value, 2.0 * *one.shape_max_over_depth.value, 1e-12);
}

TEST(Errors, AreDistinguishableOnlyAboveTheUncertainty) {
  EXPECT_TRUE((Measure{0.02, 0.01}.distinguishable()));
  EXPECT_TRUE((Measure{-0.02, 0.01}.distinguishable()));
  EXPECT_FALSE((Measure{0.01, 0.01}.distinguishable()));
  EXPECT_FALSE((Measure{-0.005, 0.01}.distinguishable()));
  EXPECT_TRUE((Measure{0.02, std::nullopt}.distinguishable()));
  EXPECT_FALSE((Measure{std::nullopt, 0.01}.distinguishable()));
  EXPECT_TRUE((Measure{std::numeric_limits<double>::quiet_NaN(), 0.01}.distinguishable()));

  Sides sides = with_forces();
  testing::set_each(sides.result, &scene::ReferenceInstant::force_uncertainty_n, {20.0, 20.0});
  EXPECT_FALSE(errors_of(sides).force_nrmse.distinguishable());
}

TEST(Errors, AreAbsentWithoutContactAndNeverNan) {
  Sides sides = testing::small();
  for (std::size_t t = 0; t < 2; ++t) {
    sides.run.instants[t].depth_m = sides.result.instants[t].depth_m = 0.0;
    sides.run.instants[t].tool.position_m.z() = sides.result.instants[t].tool.position_m.z() = 0.1;
  }
  const Errors e = errors_of(sides);
  EXPECT_FALSE(e.force_nrmse.value || e.force_peak_rel.value || e.force_rel_deep.value || e.shape_rel_l2.value ||
               e.shape_max_over_depth.value || e.contact_area_iou || e.reference.force_uncertainty_rel);
  for (const scene::Figure& f : make_figures(e, sides.result, fast::figures(sides.run))) {
    EXPECT_TRUE(std::isfinite(f.number) || !f.text.empty()) << f.key << " is not a number, and nobody says why";
  }
  EXPECT_EQ(error_figures(e).front().text, "undefined: the reference is never in contact");
}

TEST(Errors, GrazingByRoundingIsNoContact) {
  Sides sides = with_forces();
  sides.run.instants[0].depth_m = sides.result.instants[0].depth_m = 1e-17;
  set_force(sides.result.instants[0], Vec3(0.0, 0.0, 1e-20));
  const Errors e = errors_of(sides);
  EXPECT_FALSE(e.instants[0].in_contact);
  EXPECT_FALSE(e.instants[0].force_error_rel);
  EXPECT_FALSE(e.instants[0].shape_rel_l2.value);
}

TEST(Errors, KeepANumberThatIsNotFiniteVisible) {
  Sides sides = with_shapes();
  set_force(sides.result.instants[1], Vec3(0.0, 0.0, 1.0));
  sides.run.instants[0].displacement_m(0, 3) = std::numeric_limits<double>::quiet_NaN();
  sides.run.instants[1].displacement_m(0, 0) = std::numeric_limits<double>::quiet_NaN();
  const Errors e = errors_of(sides);
  EXPECT_TRUE(std::isnan(*e.shape_rel_l2.value));
  EXPECT_TRUE(std::isnan(*e.shape_max_over_depth.value));
  EXPECT_TRUE(std::isnan(*e.shape_hausdorff_m.value));
  EXPECT_TRUE(std::isnan(e.volume_change_fast_rel));
}

TEST(Errors, AnUnknownBandIsNotAZeroBand) {
  Sides sides = with_forces();
  testing::set_each(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                    {0.1, std::numeric_limits<double>::quiet_NaN()});
  const Errors e = errors_of(sides);
  EXPECT_FALSE(e.force_nrmse.uncertainty || e.force_peak_rel.uncertainty || e.force_rel_deep.uncertainty);
  EXPECT_TRUE(e.force_nrmse.distinguishable());
}

TEST(Errors, ContactAreaInCommonOverAreaOfEither) {
  Sides sides = testing::small();
  // Point 0 is inside the tool on both sides at both instants. At the second, point 1 reaches the tool in the fast
  // model and point 2 in the reference.
  const Vec3 equator_m = sides.run.instants[1].tool.position_m + Vec3(sides.scene.tool.radius_m, 0.0, 0.0);
  const Eigen::Matrix3Xd& rest_m = sides.run.surface.points_m;
  sides.run.instants[1].displacement_m.col(1) = equator_m - rest_m.col(1);
  sides.result.instants[1].displacement_m.col(2) = equator_m - rest_m.col(2);
  const Errors e = errors_of(sides);
  EXPECT_NEAR(*e.instants[0].contact_area_iou, 1.0, 1e-15);
  EXPECT_NEAR(*e.instants[1].contact_area_iou, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(*e.contact_area_iou, 2.0 / 7.0, 1e-15);
  EXPECT_TRUE(e.instants[1].touched_fast[1]);
  EXPECT_FALSE(e.instants[1].touched_reference[1]);
}

TEST(Errors, TouchWithinAHundredthOfTheDepth) {
  Sides sides = testing::small();
  const Eigen::Matrix3Xd& rest_m = sides.run.surface.points_m;
  const auto gap = [&](double gap_m) {
    const Vec3 at_m = sides.run.instants[1].tool.position_m + Vec3(sides.scene.tool.radius_m + gap_m, 0.0, 0.0);
    return Vec3(at_m - rest_m.col(1));
  };
  sides.run.instants[1].displacement_m.col(1) = gap(0.5 * 0.01 * 0.010);
  sides.result.instants[1].displacement_m.col(1) = gap(1.5 * 0.01 * 0.010);
  const Errors e = errors_of(sides);
  EXPECT_TRUE(e.instants[1].touched_fast[1]);
  EXPECT_FALSE(e.instants[1].touched_reference[1]);
}

TEST(Errors, SeeHowFarTheFastSurfaceIsLeftInsideTheTool) {
  Sides sides = testing::small();
  // Point 0 should move down by 10 mm at the second instant, but moves by 7.
  sides.run.instants[1].displacement_m.col(0) = Vec3(0.0, 0.0, -7e-3);
  const Errors e = errors_of(sides);
  EXPECT_NEAR(e.instants[0].penetration_fast_m, 1e-3, 1e-15);
  EXPECT_NEAR(e.instants[1].penetration_fast_m, 3e-3, 1e-15);
  EXPECT_NEAR(*e.penetration_fast_rel, 0.3, 1e-12);
}

TEST(Errors, QualityOfTheReferenceIsItsWorstWhereDeep) {
  Sides sides = with_forces();
  testing::set_each(sides.result, &scene::ReferenceInstant::residual_penetration_m, {1e-4, 2e-4});
  testing::set_each(sides.result, &scene::ReferenceInstant::between_nodes_penetration_m, {1e-3, 5e-4});
  testing::set_each(sides.result, &scene::ReferenceInstant::equilibrium_rel, {1.0, 1e-9});
  testing::set_each(sides.result, &scene::ReferenceInstant::volume_change_rel, {-2e-6, 1e-6});
  const Errors e = errors_of(sides);
  EXPECT_NEAR(*e.reference.force_uncertainty_rel, 0.05, 1e-14);
  EXPECT_NEAR(*e.reference.residual_penetration_rel, 0.02, 1e-14);
  EXPECT_NEAR(*e.reference.between_nodes_rel, 0.05, 1e-14);
  EXPECT_EQ(*e.reference.equilibrium_rel, 1e-9);
  EXPECT_EQ(e.reference.volume_change_rel, -2e-6);
}

/// A tool moved along x by 4 mm per instant at constant depth, five instants; forces and friction are to be set.
Sides with_friction() {
  Sides sides = testing::small();
  sides.scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  const auto repeat = [](auto& list) { list.assign(5, list.back()); };
  repeat(sides.run.instants);
  repeat(sides.result.instants);
  for (std::size_t t = 0; t < 5; ++t) {
    for (scene::InstantRecord* record : testing::both(sides, t)) {
      record->time_s = static_cast<double>(t);
      record->tool.position_m.x() = 4e-3 * static_cast<double>(t);
      set_force(*record, Vec3(0.0, 0.0, 10.0));
    }
    sides.result.instants[t].region_middles_m = {sides.result.instants[t].tool.position_m - Vec3(0.0, 0.0, 0.01)};
  }
  return sides;
}

void set_friction(scene::InstantRecord& record, double along_x_n, bool sliding) {
  record.regions[0].friction_n = Vec3(along_x_n, 0.0, 0.0);
  record.regions[0].force_n.x() = along_x_n;
  record.regions[0].sliding = sliding;
}

TEST(Errors, FrictionIsRelativeToItsOwnPeakWithTheForcesBand) {
  Sides sides = with_friction();
  set_friction(sides.result.instants[2], -4.0, false);
  set_friction(sides.run.instants[2], -1.0, false);
  sides.result.instants[3].force_uncertainty_n = 0.5;
  const Errors e = errors_of(sides);
  EXPECT_NEAR(*e.force_friction_nrmse.value, std::sqrt(9.0 / 5.0) / 4.0, 1e-14);
  EXPECT_NEAR(*e.force_friction_nrmse.uncertainty, std::sqrt(0.25 / 5.0) / 4.0, 1e-14);
  EXPECT_EQ(e.instants[2].friction_fast_n, 1.0);
  EXPECT_NEAR(e.instants[4].path_m, 16e-3, 1e-15);
}

TEST(Errors, FrictionFiguresNeedFriction) {
  const Errors without = errors_of(with_forces());
  EXPECT_FALSE(without.friction || without.force_friction_nrmse.value || without.slip_onset_error_m.value);
  // Pressed straight, friction in all directions leaves round-off only.
  Sides straight = with_friction();
  set_friction(straight.result.instants[2], -1e-9, false);
  EXPECT_FALSE(errors_of(straight).force_friction_nrmse.value);
}

TEST(Errors, WorkAgainstFrictionIsTheLoopsArea) {
  Sides sides = with_friction();
  // Back and forth: 8 mm against 2 N each way for the reference, against 3 N for the other.
  for (std::size_t t = 0; t < 5; ++t) {
    const double x_m = 4e-3 * static_cast<double>(t < 3 ? t : 4 - t);
    sides.run.instants[t].tool.position_m.x() = sides.result.instants[t].tool.position_m.x() = x_m;
    const double against = t == 2 ? 0.0 : t < 2 ? -1.0 : 1.0;
    set_friction(sides.result.instants[t], 2.0 * against, true);
    set_friction(sides.run.instants[t], 3.0 * against, true);
  }
  Errors e = errors_of(sides);
  EXPECT_NEAR(*e.force_friction_work_rel.value, 0.5, 1e-13);
  // Spring-like friction returns its work on the way back.
  for (std::size_t t = 0; t < 5; ++t) {
    const double x_m = sides.run.instants[t].tool.position_m.x();
    set_friction(sides.run.instants[t], -1e3 * x_m, false);
  }
  e = errors_of(sides);
  EXPECT_NEAR(*e.force_friction_work_rel.value, -1.0, 1e-13);
}

TEST(Errors, FrictionWorksWhereTheToolsSurfaceMoves) {
  Sides sides = with_friction();
  // Rotation about y around the contact 10 mm below its centre, which is at rest.
  for (std::size_t t = 0; t < 5; ++t) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.1 * static_cast<double>(t), Vec3::UnitY()));
    for (scene::InstantRecord* record : testing::both(sides, t)) {
      record->tool.position_m = Vec3(0.0, 0.0, 0.06);
      record->tool.orientation = turn;
    }
    sides.result.instants[t].region_middles_m = {Vec3(0.0, 0.0, 0.05)};
    set_friction(sides.result.instants[t], -2.0, true);
  }
  EXPECT_NEAR(errors_of(sides).instants[4].path_m, 4 * 2 * 0.01 * std::sin(0.05), 1e-12);
}

TEST(Errors, SlipBeginsAtAWayKnownToTheInstants) {
  Sides sides = with_friction();
  for (const std::size_t t : {1u, 2u, 3u, 4u}) sides.run.instants[t].regions[0].sliding = true;
  EXPECT_FALSE(errors_of(sides).slip_onset_error_m.value);
  EXPECT_NEAR(*errors_of(sides).slip_onset_fast_m, 4e-3, 1e-15);
  sides.result.instants[3].regions[0].sliding = true;
  const Errors e = errors_of(sides);
  EXPECT_NEAR(*e.slip_onset_error_m.value, -8e-3, 1e-15);
  EXPECT_NEAR(*e.slip_onset_error_m.uncertainty, 4e-3, 1e-15);
  EXPECT_TRUE(e.slip_onset_error_m.distinguishable());
  // Slip in grazing contact is no onset.
  sides.run.instants[0].depth_m = sides.result.instants[0].depth_m = 1e-4;
  sides.result.instants[0].regions[0].sliding = true;
  EXPECT_NEAR(*errors_of(sides).slip_onset_reference_m, 12e-3, 1e-15);
}

TEST(Errors, TorqueIsRelativeToForceTimesDistance) {
  Sides sides = with_forces();
  sides.result.instants[1].region_middles_m = {sides.result.instants[1].tool.position_m + Vec3(0.02, 0.0, 0.0)};
  sides.result.instants[1].regions[0].torque_nm = Vec3(0.0, -0.2, 0.0);
  sides.run.instants[1].regions[0].torque_nm = Vec3(0.0, -0.2, 0.1);
  const Errors e = errors_of(sides);
  EXPECT_NEAR(*e.force_torque_nrmse.value, std::sqrt(0.01 / 2.0) / 0.2, 1e-13);
  EXPECT_NEAR(*e.force_torque_nrmse.uncertainty, std::sqrt(0.5 * 0.5 * 0.02 * 0.02 / 2.0) / 0.2, 1e-13);
  EXPECT_FALSE(errors_of(testing::small()).force_torque_nrmse.value);
}

/// Two regions at x = 10 and -10 mm, forces upwards: the reference's 4 and 6 N, the fast model's 5 and 6 N.
Sides with_regions(bool swapped) {
  Sides sides = testing::small();
  for (std::size_t t = 0; t < 2; ++t) {
    const Vec3 tool_m = sides.result.instants[t].tool.position_m;
    const auto region = [](double x_m, double force_n, int id) {
      scene::RegionRecord out;
      out.force_n = Vec3(0.0, 0.0, force_n);
      out.torque_nm = Vec3(x_m, 0.0, 0.0).cross(out.force_n);
      out.id = id;
      return out;
    };
    sides.result.instants[t].regions = {region(0.01, 4.0, 0), region(-0.01, 6.0, 1)};
    sides.result.instants[t].region_middles_m = {tool_m + Vec3(0.01, 0.0, -0.01), tool_m + Vec3(-0.01, 0.0, -0.01)};
    sides.run.instants[t].regions = {region(0.01, 5.0, swapped ? 1 : 0), region(-0.01, 6.0, swapped ? 0 : 1)};
    if (swapped) std::swap(sides.run.instants[t].regions[0], sides.run.instants[t].regions[1]);
  }
  return sides;
}

TEST(Errors, RegionsArePairedByWhereTheyActNotByNumber) {
  for (const bool swapped : {false, true}) {
    const Errors e = errors_of(with_regions(swapped));
    ASSERT_EQ(e.regions.size(), 2u);
    EXPECT_NEAR(*e.regions[0].force_nrmse.value, 0.25, 1e-13);
    EXPECT_NEAR(*e.regions[0].force_peak_rel.value, 0.25, 1e-13);
    EXPECT_NEAR(*e.regions[1].force_nrmse.value, 0.0, 1e-13);
    EXPECT_FALSE(e.regions[0].force_nrmse.uncertainty);
  }
  EXPECT_TRUE(errors_of(with_forces()).regions.empty());
}

TEST(Errors, ARegionTheFastModelLacksHasNoForceThere) {
  Sides sides = with_regions(false);
  for (scene::InstantRecord& record : sides.run.instants) record.regions.resize(1);
  const Errors e = errors_of(sides);
  ASSERT_EQ(e.regions.size(), 2u);
  EXPECT_NEAR(*e.regions[1].force_nrmse.value, 1.0, 1e-13);
  EXPECT_NEAR(*e.regions[1].force_peak_rel.value, -1.0, 1e-13);
}

TEST(Errors, SideFacesAreThoseNoContactLiesOn) {
  Sides sides = testing::pressed(3, 2000);
  sides.run.instants.assign(sides.result.instants.begin(), sides.result.instants.end());
  EXPECT_EQ(*errors_of(sides).shape_side_faces_rel_l2.value, 0.0);
  const scene::Surface& surface = sides.run.surface;
  // An error on the top is no error of the side faces; a proportional error on one side gives that ratio.
  const auto on_top = [&](Eigen::Index i) { return i >= surface.patch_begin[5]; };
  for (Eigen::Index i = 0; i < surface.points_m.cols(); ++i) {
    if (on_top(i)) sides.run.instants[2].displacement_m.col(i) *= 3.0;
  }
  EXPECT_EQ(*errors_of(sides).shape_side_faces_rel_l2.value, 0.0);
  for (std::size_t t = 0; t < 3; ++t)
    sides.run.instants[t].displacement_m = 1.25 * sides.result.instants[t].displacement_m;
  EXPECT_NEAR(*errors_of(sides).shape_side_faces_rel_l2.value, 0.25, 1e-12);
  // A contact on +x: then the top is a side face.
  testing::set_all(sides.result, &scene::ReferenceInstant::region_middles_m, {Vec3(0.03, 0.0, 0.03)});
  for (std::size_t t = 0; t < 3; ++t) {
    sides.run.instants[t].displacement_m = sides.result.instants[t].displacement_m;
    for (Eigen::Index i = 0; i < surface.points_m.cols(); ++i) {
      if (on_top(i)) sides.run.instants[t].displacement_m.col(i) *= 3.0;
    }
  }
  EXPECT_GT(*errors_of(sides).shape_side_faces_rel_l2.value, 0.5);
}

TEST(Errors, ABodyWithoutEdgesHasNoSideFaces) {
  Sides sides = testing::small();
  sides.scene.body.shape = scene::BodyShape::sphere;
  sides.scene.body.radius_m = 0.03;
  EXPECT_FALSE(errors_of(sides).shape_side_faces_rel_l2.value);
}

TEST(Errors, NormalsTellTurningFromMoving) {
  Sides sides = testing::pressed(3, 2000);
  sides.run.instants.assign(sides.result.instants.begin(), sides.result.instants.end());
  EXPECT_EQ(*errors_of(sides).shape_normals_rms_rad.value, 0.0);
  // Translation as a whole gives no angle; rotation as a whole about x by 0.1 rad gives that angle everywhere.
  sides.run.instants[2].displacement_m.colwise() += Vec3(1e-3, 2e-3, 3e-3);
  EXPECT_NEAR(*errors_of(sides).shape_normals_rms_rad.value, 0.0, 1e-9);
  const Eigen::AngleAxisd turn(0.1, Vec3::UnitX());
  for (std::size_t t = 0; t < 3; ++t) {
    const Eigen::Matrix3Xd& rest_m = sides.run.surface.points_m;
    sides.result.instants[t].displacement_m.setZero();
    sides.run.instants[t].displacement_m = turn.toRotationMatrix() * rest_m - rest_m;
  }
  // The faces -x and +x rotate about their own normal, the other four by the whole angle.
  EXPECT_NEAR(*errors_of(sides).shape_normals_rms_rad.value, 0.1 * std::sqrt(2.0 / 3.0), 1e-9);
}

TEST(Errors, RefuseSidesThatDoNotBelongTogether) {
  const Sides good = testing::small();
  EXPECT_NO_THROW(errors_of(good));
  Sides late = good;
  late.run.instants[1].time_s += 1e-9;
  EXPECT_THROW(errors_of(late), std::logic_error);
  Sides elsewhere = good;
  elsewhere.run.instants[1].tool.position_m.x() += 1e-6;
  EXPECT_THROW(errors_of(elsewhere), std::logic_error);
  Sides shorter = good;
  shorter.result.instants.pop_back();
  EXPECT_THROW(errors_of(shorter), std::logic_error);
  Sides fewer = good;
  fewer.result.instants[1].displacement_m.conservativeResize(3, 3);
  EXPECT_THROW(errors_of(fewer), std::logic_error);
  Sides unbanded = good;
  unbanded.result.instants[1].displacement_uncertainty_m.conservativeResize(3);
  EXPECT_THROW(errors_of(unbanded), std::logic_error);
}

}  // namespace
}  // namespace touchstone::compare
