#include "fast/contact/mass_distribution.h"

#include "support/points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace touchstone::fast {
namespace {

using scene::Vec3;

const Vec3 down = -Vec3::UnitZ();
/// Every test finds what others have left in it.
CellIntegrals integrals;

/// Points of a flat tool 10 mm under its mass centre, facing down.
test::OwnedPoints flat(const std::vector<Vec3>& places_m) {
  test::OwnedPoints points(static_cast<int>(places_m.size()));
  points.count = static_cast<int>(places_m.size());
  for (std::size_t i = 0; i < places_m.size(); ++i) {
    points.x_T_m[i] = places_m[i].x();
    points.y_T_m[i] = places_m[i].y();
    points.z_T_m[i] = -0.01;
    points.area_m2[i] = 1e-6;
    points.cos_theta[i] = 1.0;
  }
  return points;
}

double sum(const RegionPoints& points) { return std::accumulate(points.share, points.share + points.count, 0.0); }

TEST(MassDistribution, CorrectedBalancesTheLever) {
  // Supports at lever arms 1 : 3 carry 3/4 and 1/4, and the load's centre is the mass centre (errata E6).
  test::OwnedPoints points = flat({Vec3(0.01, 0.0, 0.0), Vec3(-0.03, 0.0, 0.0)});
  distribute_mass_corrected(down, {}, integrals, points);
  EXPECT_NEAR(points.share[0], 0.75, 1e-12);
  EXPECT_NEAR(points.share[1], 0.25, 1e-12);
}

TEST(CellIntegrals, DependOnTheCellAndTheDirectionAlone) {
  struct Case {
    double turned, size_m, off_m;
  };
  SurfaceCell cell;  // always at the same place in memory
  std::vector<double> seen_m;
  // From one to the next one thing changes.
  for (const auto& [turned, size_m, off_m] :
       {Case{0.0, 2e-3, 0.0}, Case{0.1, 2e-3, 0.0}, Case{0.1, 1e-3, 0.0}, Case{0.1, 1e-3, 1e-4}}) {
    const Vec3 d_T(std::sin(turned), 0.0, std::cos(turned)), middle_m(off_m, 0.0, 0.01);
    const Vec3 x_m = 0.5 * size_m * Vec3::UnitX(), y_m = 0.5 * size_m * Vec3::UnitY();
    const std::array<Vec3, 4> corners{middle_m - x_m - y_m, middle_m + x_m - y_m, middle_m + x_m + y_m,
                                      middle_m - x_m + y_m};
    cell = flat_cell(corners);
    for (int again = 0; again < 2; ++again) {
      seen_m.push_back(integrals.over_distance_m(cell, {}, d_T));
      EXPECT_EQ(seen_m.back(), CellIntegrals().over_distance_m(cell, {}, d_T));
    }
  }
  for (std::size_t k = 2; k < seen_m.size(); k += 2) EXPECT_NE(seen_m[k], seen_m[k - 1]);
}

TEST(MassDistribution, MeanOfTheInverseDistanceOverADisc) {
  constexpr double radius_m = 0.3;
  for (const double r_m : {0.0, 0.05, 0.29, 0.31, 0.5, 0.89, 0.91, 2.0, 50.0}) {
    // In polar coordinates about the point the integrand is 1: the mean length of the chords, and 0 outside the disc.
    constexpr int rays = 200000;
    double sum_m2 = 0.0;
    for (int k = 0; k < rays; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.5) / rays, along_m = r_m * std::cos(angle);
      const double half2_m2 = radius_m * radius_m - r_m * r_m + along_m * along_m;
      if (half2_m2 <= 0.0) continue;
      const double half_m = std::sqrt(half2_m2);
      sum_m2 += std::max(0.0, along_m + half_m) - std::max(0.0, along_m - half_m);
    }
    const double mean_per_m = sum_m2 * 2.0 * std::numbers::pi / rays / (std::numbers::pi * radius_m * radius_m);
    EXPECT_NEAR(mean_inverse_distance_per_m(r_m * r_m, radius_m) / mean_per_m, 1.0, 2e-4) << r_m;
  }
}

/// A cell with its depth below a plane that rises along x and falls along y.
void put(const SurfaceCell& cell, test::OwnedPoints& points) {
  constexpr double rise = 0.3, fall = -0.2, at_axis_m = 0.002;
  const int k = points.count++;
  const Vec3& at_m = cell.center_T_m;
  points.spread = true;
  points.set(k, {{at_m, at_m, cell.normal_T, cell.area_m2, at_axis_m + rise * at_m.x() + fall * at_m.y(), 0},
                 Vec3::UnitZ(),
                 cell.spread_m,
                 cell.turn,
                 &cell});
  points.cos_theta[k] = 1.0;
  points.rise1_m[k] = rise * cell.spread_m[0].x() + fall * cell.spread_m[0].y();
  points.rise2_m[k] = rise * cell.spread_m[1].x() + fall * cell.spread_m[1].y();
}

/// @return the cell's share beside one of 1 mm^2 far off, and its depth
std::pair<double, double> share_and_depth_m(const std::vector<SurfaceCell>& parts) {
  test::OwnedPoints points(static_cast<int>(parts.size()) + 1);
  for (const SurfaceCell& part : parts) put(part, points);
  SurfaceCell far = parts.front();
  far.center_T_m = Vec3(1.0, 0.0, 0.0);
  far.area_m2 = 1e-6;
  far.spread_m = {Vec3::Zero(), Vec3::Zero()};
  put(far, points);
  distribute_mass_corrected(down, {}, integrals, points);
  double share = 0.0, depth_m = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    share += points.share[i];
    depth_m += points.share[i] * points.depth_m[i];
  }
  return {share / points.share[parts.size()], depth_m / share};
}

TEST(MassDistribution, ACellIsAsItsManyParts) {
  for (const double x_mm : {0.0, 0.3, 0.6, 1.0, 1.5, 3.0, 10.0}) {
    const Vec3 corner_m(1e-3 * (x_mm - 0.5), -0.3e-3, -0.01), a_m(0.0, 1e-3, 0.0), b_m(1e-3, 0.0, 0.0);
    const std::vector<SurfaceCell> whole{
        flat_cell(std::array<Vec3, 4>{corner_m, corner_m + a_m, corner_m + a_m + b_m, corner_m + b_m})};
    std::vector<SurfaceCell> parts = whole;
    for (int round = 0; round < 10; ++round) {
      std::vector<SurfaceCell> finer;
      for (const SurfaceCell& part : parts)
        for (const SurfaceCell& half : halves(part, {})) finer.push_back(half);
      parts = std::move(finer);
    }
    const auto [share, depth_m] = share_and_depth_m(whole);
    const auto [exact_share, exact_depth_m] = share_and_depth_m(parts);
    EXPECT_NEAR(share / exact_share, 1.0, 4e-3) << x_mm;
    EXPECT_NEAR(depth_m, exact_depth_m, 2e-5) << x_mm;
  }
}

TEST(MassDistribution, PublishedSwapsTheLever) {
  test::OwnedPoints points = flat({Vec3(0.01, 0.0, 0.0), Vec3(-0.03, 0.0, 0.0)});
  distribute_mass_published(down, {}, integrals, points);
  EXPECT_NEAR(points.share[0], 0.25, 1e-12);
  EXPECT_NEAR(points.share[1], 0.75, 1e-12);
}

TEST(MassDistribution, SumsToOneAndFollowsTheFormulas) {
  test::OwnedPoints points = flat({Vec3(0.0, 0.0, 0.0), Vec3(0.001, 0.002, 0.0), Vec3(-0.004, 0.001, 0.0)});
  points.cos_theta[1] = 0.5;
  points.area_m2[2] = 3e-6;
  const double r1 = std::hypot(0.001, 0.002), r2 = std::hypot(0.004, 0.001);

  distribute_mass_corrected(down, {}, integrals, points);
  EXPECT_NEAR(sum(points), 1.0, 1e-15);
  EXPECT_NEAR(points.share[2] / points.share[1], (3e-6 / r2) / (0.5e-6 / r1), 1e-12);
  // A point under the mass centre is a disc.
  const double disc_m = 1e-6 * mean_inverse_distance_per_m(0.0, std::sqrt(1e-6 / std::numbers::pi));
  EXPECT_NEAR(points.share[0] / points.share[1], disc_m / (0.5e-6 / r1), 1e-12);

  distribute_mass_published(down, {}, integrals, points);
  EXPECT_NEAR(sum(points), 1.0, 1e-15);
  EXPECT_EQ(points.share[0], 0.0);
  EXPECT_NEAR(points.share[2] / points.share[1], r2 / (0.5 * r1), 1e-12);
}

TEST(MassDistribution, LeverArmsAreTakenAcrossTheDirection) {
  test::OwnedPoints points = flat({Vec3(0.01, 0.0, 0.0), Vec3(0.0, 0.01, 0.0)});
  // Seen along x, the second point's arm is sqrt(0.01^2 + 0.01^2), the first one's 0.01 (both are 10 mm low).
  distribute_mass_published(Vec3::UnitX(), {}, integrals, points);
  EXPECT_NEAR(points.share[1] / points.share[0], std::sqrt(2.0), 1e-12);
}

TEST(MassDistribution, IsUniformWhereAllWeightsVanish) {
  for (const DistributeMass distribute : {distribute_mass_published, distribute_mass_corrected}) {
    test::OwnedPoints points = flat({Vec3(0.001, 0.0, 0.0), Vec3(0.0, 0.002, 0.0)});
    points.cos_theta[0] = points.cos_theta[1] = 0.0;
    distribute(down, {}, integrals, points);
    EXPECT_EQ(points.share[0], 0.5);
    EXPECT_EQ(points.share[1], 0.5);
  }
}

TEST(MassDistribution, OnePointUnderTheMassCentreCarriesAll) {
  for (const DistributeMass distribute : {distribute_mass_published, distribute_mass_corrected}) {
    test::OwnedPoints points = flat({Vec3::Zero()});
    distribute(down, {}, integrals, points);
    EXPECT_EQ(points.share[0], 1.0);
  }
}

}  // namespace
}  // namespace touchstone::fast
