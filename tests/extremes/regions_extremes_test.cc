// The extremes: many regions, too many, and regions that merge, split, face each other or are mirror images.
#include "extremes/rig.h"

#include <numbers>
#include <set>

namespace touchstone::fast {
namespace {

using extremes::has;
using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

/// Feet of pins on a grid.
std::vector<Vec3> grid_of(int columns, int rows, double pitch_m) {
  std::vector<Vec3> feet_m;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      feet_m.emplace_back(pitch_m * (column - 0.5 * (columns - 1)), pitch_m * (row - 0.5 * (rows - 1)), 0.0);
  return feet_m;
}

// Twelve pins and a limit of four regions: four have a force, the status reports that there are more, and everything is
// bounded. As printed: At most one new region per time step is assumed; up to 10 regions keep the rate.
TEST(RegionExtremes, MoreRegionsThanTheLimit) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::pins_on_cube(formulation, grid_of(4, 3, 0.012));
    scene.fast.max_regions = 4;
    Rig rig(scene);
    rig.may = StepStatus::regions_full | StepStatus::anchors_limited;
    for (int i = -5; i <= 30; ++i) {
      const StepStatus status = rig.to(extremes::sunk(0.0001 * i));
      EXPECT_EQ(has(status, StepStatus::regions_full), rig.state.region_count == 4);
    }
    EXPECT_EQ(rig.state.region_count, 4);
    rig.to(extremes::sunk(-0.001));
    EXPECT_EQ(rig.state.region_count, 0);
    EXPECT_EQ(rig.largest_displacement_m(), 0.0);
  }
}

// Four pins rocked over the face with a limit of two regions: when one region ends, another pin gets one. As printed:
// At most one new region per time step is assumed.
TEST(RegionExtremes, FreedRegionIsReused) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::pins_on_cube(formulation, grid_of(4, 1, 0.012));
    scene.fast.max_regions = 2;
    Rig rig(scene);
    rig.may = StepStatus::regions_full | StepStatus::anchors_limited;
    std::set<int> ids;
    int full = 0;
    for (int i = 0; i <= 100; ++i) {
      const double tilt = 0.25 * (i - 50) / 50.0;
      const StepStatus status =
          rig.to({Vec3(0.0, 0.0, 0.060 - 0.001), Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Vec3::UnitY()))});
      if (i == 50) {
        EXPECT_TRUE(has(status, StepStatus::regions_full));
      }
      EXPECT_LE(rig.state.region_count, 2);
      EXPECT_GT(rig.state.region_count, 0);
      for (int r = 0; r < rig.state.region_count; ++r) {
        const ContactRegion& region = rig.region(static_cast<std::size_t>(r));
        ids.insert(region.id);
        if (region.pressing() && std::abs(tilt) > 0.23) {
          EXPECT_GT(tilt * region.origin.p0_W_m.x(), 0.0);
        }
      }
      full += rig.state.region_count == 2;
    }
    EXPECT_EQ(ids, (std::set<int>{0, 1}));
    EXPECT_GT(full, 50);
  }
}

// Ten pins pressed in, 20 ticks at rest, and released: ten regions, no drift, nothing left. As printed: The same, in
// the order of creation, each on the shape of those before (E18).
TEST(RegionExtremes, TenPinsAtRest) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::pins_on_cube(formulation, grid_of(5, 2, 0.010)));
    rig.may = StepStatus::anchors_limited;
    for (int i = -5; i <= 20; ++i) rig.to(extremes::sunk(0.0001 * i));
    EXPECT_EQ(rig.state.region_count, 10);
    for (int i = 0; i < 5; ++i) rig.to(extremes::sunk(0.002));
    const Vec3 force_n = rig.force_n();
    EXPECT_GT(force_n.z(), rig.model.law.at(0.0).force_n(0.002));
    EXPECT_LT(force_n.z(), 10.0 * rig.model.law.at(0.0).force_n(0.002));
    for (int i = 0; i < 20; ++i) step_force(rig.model, extremes::sunk(0.002), rig.state);
    EXPECT_LE((rig.force_n() - force_n).norm(), 1e-9 * force_n.norm());
    rig.to(extremes::sunk(-0.001));
    EXPECT_EQ(rig.state.region_count, 0);
    EXPECT_EQ(rig.largest_displacement_m(), 0.0);
  }
}

/// A tool with two feet, joined by a hollow of this height.
scene::Scene hollow_on_cube(Formulation formulation, double hollow_m) {
  scene::Scene scene = extremes::cube(formulation);
  scene::TriangleMesh mesh;
  mesh.points_m.resize(3, 0);
  for (const double x : {-0.008, 0.008})
    extremes::add_box(Vec3(x - 0.002, -0.004, 0.0), Vec3(x + 0.002, 0.004, 0.02), mesh);
  extremes::add_box(Vec3(-0.006, -0.004, hollow_m), Vec3(0.006, 0.004, 0.02), mesh);
  extremes::use_mesh(std::move(mesh), scene);
  scene.fast.max_regions = 10;
  scene.contact.r_th_m = 0.002;
  scene.fast.tool_samples = 8000;  // closer than half of r_th
  scene.fast.s_c_m2 = 0.03;
  return scene;
}

// Two regions that merge as the hollow between them touches, and split on release: one region with the older one's id,
// then two; the same force at the same depth both times, and nothing left at the end. As printed: The same; since the
// force of a region is a mean, it falls where two merge, by half and more (E7).
TEST(RegionExtremes, TwoMergeIntoOneAndSplitAgain) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(hollow_on_cube(formulation, 0.001));
    rig.may = StepStatus::anchors_limited;
    std::vector<int> counts;
    std::vector<double> force_n;
    const auto to = [&](int i) {
      rig.to(extremes::sunk(0.0001 * i + 1e-6));  // not decided by rounding whether the hollow touches
      if (counts.empty() || counts.back() != rig.state.region_count) counts.push_back(rig.state.region_count);
      force_n.push_back(rig.force_n().z());
      if (rig.state.region_count == 1) {
        EXPECT_EQ(rig.region().id, 0);
      }
    };
    for (int i = -2; i <= 20; ++i) to(i);
    for (int i = 20; i >= -2; --i) to(i);
    for (std::size_t i = 0; i < force_n.size(); ++i)
      EXPECT_NEAR(force_n[i], force_n[force_n.size() - 1 - i], 1e-3 * force_n[22]) << i;
    EXPECT_EQ(counts, (std::vector<int>{0, 2, 1, 2, 0}));
    EXPECT_EQ(rig.largest_displacement_m(), 0.0);
  }
}

// Two feet from the side, the second slightly behind, so that it first only reaches the bulge beside the other: once it
// is inside, its region's direction is into the side, too. As printed: The same.
TEST(RegionExtremes, RegionThatBeginsOutsideGetsItsDirection) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::pins_on_cube(formulation, {Vec3(-0.008, 0.0, 0.0), Vec3(0.008, 0.0, 0.001)}));
    rig.may = StepStatus::anchors_limited;
    const Eigen::Quaterniond from_the_side(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY()));
    bool waited = false;
    for (int i = -5; i <= 30; ++i) {
      rig.to({Vec3(0.03 - 0.0001 * i, 0.0, 0.03), from_the_side});
      waited = waited || (rig.state.region_count == 2 && !rig.state.regions[1].pressing());
      for (int k = 0; k < rig.state.region_count; ++k) {
        const ContactRegion& region = rig.state.regions[static_cast<std::size_t>(k)];
        if (!region.pressing()) continue;
        EXPECT_GT(region.d.dot(-Vec3::UnitX()), 0.99) << i << ", region " << k;
      }
    }
    EXPECT_TRUE(waited);
    EXPECT_EQ(rig.state.region_count, 2);
  }
}

// Gripped from two opposite sides: the forces are opposite and nearly cancel, and the support carries the rest. As
// printed: The second of the two is evaluated on the shape left by the first and is a little weaker (E18).
TEST(RegionExtremes, OppositeSidesNearlyCancel) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::cube(formulation);
    scene::TriangleMesh mesh;
    mesh.points_m.resize(3, 0);
    // Jaws 58 mm apart.
    extremes::add_box(Vec3(-0.049, -0.003, -0.003), Vec3(-0.029, 0.003, 0.003), mesh);
    extremes::add_box(Vec3(0.029, -0.003, -0.003), Vec3(0.049, 0.003, 0.003), mesh);
    extremes::use_mesh(std::move(mesh), scene);
    scene.fast.max_regions = 10;
    Rig rig(scene);
    rig.may = StepStatus::anchors_limited;
    rig.to(test::at(0.0, 0.05, 0.03));
    for (int i = 0; i <= 50; ++i) rig.to(test::at(0.0, 0.05 - 0.001 * i, 0.03));
    ASSERT_EQ(rig.state.region_count, 2);
    const Vec3 first_n = rig.region(0).force.force_n, second_n = rig.region(1).force.force_n;
    EXPECT_LT(first_n.x() * second_n.x(), 0.0);
    EXPECT_LT(rig.force_n().norm(), 0.5 * first_n.norm());
  }
}

// Two pins that are mirror images, one a micrometre longer, then the other: mirrored forces, and the same total. As
// printed: The same; but the second of two equal pins is evaluated on the shape of the first, and its force is a
// seventh (E18).
TEST(RegionExtremes, MirroredPinsHaveMirroredForces) {
  IN_BOTH_FORMULATIONS(formulation) {
    std::vector<Vec3> first_n, second_n;
    for (const double side : {-1.0, 1.0}) {
      Rig rig(extremes::pins_on_cube(formulation, {Vec3(0.01 * side, 0.0, 0.0), Vec3(-0.01 * side, 0.0, 1e-6)}));
      rig.may = StepStatus::anchors_limited;
      for (int i = -200; i <= 2000; i += 10) rig.to(extremes::sunk(1e-6 * (i + 0.5)));
      ASSERT_EQ(rig.state.region_count, 2);
      EXPECT_GT(side * rig.region(0).origin.p0_W_m.x(), 0.0);
      first_n.push_back(rig.region(0).force.force_n);
      second_n.push_back(rig.region(1).force.force_n);
    }
    for (const auto& forces_n : {first_n, second_n}) {
      const Vec3 mirrored_n(-forces_n[1].x(), forces_n[1].y(), forces_n[1].z());
      EXPECT_LE((forces_n[0] - mirrored_n).norm(), 1e-5 * first_n[0].norm());
    }
    EXPECT_GE(first_n[0].norm(), second_n[0].norm());
  }
}

// Pins exactly r_th apart, and the next smaller and larger number: one region or two, bounded in each case. As printed:
// The same: points closer than a threshold are one region.
TEST(RegionExtremes, ExactlyTheThresholdApart) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const double off : {-1e-9, -1e-16, 0.0, 1e-16, 1e-9}) {
      scene::Scene scene = extremes::pins_on_cube(formulation, {Vec3(-0.005, 0, 0), Vec3(0.005, 0, 0)});
      Rig probe(scene);
      // The two closest samples of different pins.
      double gap_m = 1e300;
      const ToolSamples& tool = probe.model.tool;
      for (std::size_t i = 0; i < tool.x_T_m.size(); ++i) {
        if (tool.x_T_m[i] < 0.0 || tool.z_T_m[i] > 0.002) continue;
        for (std::size_t k = 0; k < tool.x_T_m.size(); ++k) {
          if (tool.x_T_m[k] > 0.0 || tool.z_T_m[k] > 0.002) continue;
          gap_m = std::min(
              gap_m,
              Vec3(tool.x_T_m[i] - tool.x_T_m[k], tool.y_T_m[i] - tool.y_T_m[k], tool.z_T_m[i] - tool.z_T_m[k]).norm());
        }
      }
      scene.contact.r_th_m = gap_m * (1.0 + off);
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      for (int i = -2; i <= 20; ++i) rig.to(extremes::sunk(0.0001 * i));
      EXPECT_EQ(rig.state.region_count, off > 1e-12 ? 1 : off < -1e-12 ? 2 : rig.state.region_count);
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
