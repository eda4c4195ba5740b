#include "fast/mass_distribution.h"

#include "unit/fast/points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

const Vec3 down = -Vec3::UnitZ();

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
  distribute_mass_corrected(down, 1e-9, points);
  EXPECT_NEAR(points.share[0], 0.75, 1e-12);
  EXPECT_NEAR(points.share[1], 0.25, 1e-12);
}

TEST(MassDistribution, PublishedSwapsTheLever) {
  test::OwnedPoints points = flat({Vec3(0.01, 0.0, 0.0), Vec3(-0.03, 0.0, 0.0)});
  distribute_mass_published(down, 1e-9, points);
  EXPECT_NEAR(points.share[0], 0.25, 1e-12);
  EXPECT_NEAR(points.share[1], 0.75, 1e-12);
}

TEST(MassDistribution, SumsToOneAndFollowsTheFormulas) {
  test::OwnedPoints points = flat({Vec3(0.0, 0.0, 0.0), Vec3(0.001, 0.002, 0.0), Vec3(-0.004, 0.001, 0.0)});
  points.cos_theta[1] = 0.5;
  points.area_m2[2] = 3e-6;
  const double r_0 = 0.001;
  const double r1 = std::hypot(0.001, 0.002), r2 = std::hypot(0.004, 0.001);

  distribute_mass_corrected(down, r_0, points);
  EXPECT_NEAR(sum(points), 1.0, 1e-15);
  EXPECT_NEAR(points.share[1] / points.share[0], 0.5 * r_0 / std::hypot(r1, r_0), 1e-12);
  EXPECT_NEAR(points.share[2] / points.share[0], 3.0 * r_0 / std::hypot(r2, r_0), 1e-12);

  distribute_mass_published(down, r_0, points);
  EXPECT_NEAR(sum(points), 1.0, 1e-15);
  EXPECT_EQ(points.share[0], 0.0);
  EXPECT_NEAR(points.share[2] / points.share[1], r2 / (0.5 * r1), 1e-12);
}

TEST(MassDistribution, LeverArmsAreTakenAcrossTheDirection) {
  test::OwnedPoints points = flat({Vec3(0.01, 0.0, 0.0), Vec3(0.0, 0.01, 0.0)});
  // Seen along x, the second point's arm is sqrt(0.01^2 + 0.01^2), the first one's 0.01 (both are 10 mm low).
  distribute_mass_published(Vec3::UnitX(), 1e-3, points);
  EXPECT_NEAR(points.share[1] / points.share[0], std::sqrt(2.0), 1e-12);
}

TEST(MassDistribution, IsUniformWhereAllWeightsVanish) {
  for (const DistributeMass distribute : {distribute_mass_published, distribute_mass_corrected}) {
    test::OwnedPoints points = flat({Vec3(0.001, 0.0, 0.0), Vec3(0.0, 0.002, 0.0)});
    points.cos_theta[0] = points.cos_theta[1] = 0.0;
    distribute(down, 1e-3, points);
    EXPECT_EQ(points.share[0], 0.5);
    EXPECT_EQ(points.share[1], 0.5);
  }
}

TEST(MassDistribution, OnePointUnderTheMassCentreCarriesAll) {
  for (const DistributeMass distribute : {distribute_mass_published, distribute_mass_corrected}) {
    test::OwnedPoints points = flat({Vec3::Zero()});
    distribute(down, 1e-3, points);
    EXPECT_EQ(points.share[0], 1.0);
  }
}

}  // namespace
}  // namespace touchstone::fast
