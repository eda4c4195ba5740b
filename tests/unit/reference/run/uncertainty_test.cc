#include "reference/run/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::reference {
namespace {

const std::vector<double> halved = {1.0, 2.0, 4.0};

TEST(Uncertainty, LargerOfTheLastChangeAndHalfTheOneBefore) {
  const auto band = force_band({{10.0, 10.0}, {10.4, 10.1}, {10.5, 10.0}}, halved);
  ASSERT_EQ(band.size(), 2u);
  EXPECT_NEAR(band[0], 1.25 * 0.2, 1e-12);
  EXPECT_NEAR(band[1], 1.25 * 0.2, 1e-12);  // from its neighbour; its own is 0.125
}

TEST(Uncertainty, NeighboursCoverAChanceAgreement) {
  const auto band = force_band({{1.0, 2.0, 3.0, 4.0}, {1.0, 2.0, 3.0, 4.2}, {1.0, 2.0, 3.0, 4.2}}, halved);
  EXPECT_EQ(band[1], 0.0);
  EXPECT_NEAR(band[2], 0.125, 1e-12);
}

/// An error that is a multiple of the cell size is held with the safety factor to spare, whichever the sizes.
TEST(Uncertainty, HoldsAFirstOrderError) {
  for (const std::vector<double>& finer :
       {std::vector<double>{1.0, 1.5, 2.0}, {1.5, 2.0, 3.0}, {2.0, 3.0, 4.0}, {1.0, 2.0, 4.0}, {1.0, 3.0, 9.0}}) {
    std::vector<std::vector<double>> levels;
    for (const double f : finer) levels.push_back({5.0 + 0.3 / f});
    EXPECT_NEAR(force_band(levels, finer)[0], 1.25 * 0.3 / finer.back(), 1e-12);
  }
}

/// Two levels whose cells hardly differ say nothing: an error of the last one is not blown up by their nearness.
TEST(Uncertainty, LeavesOutPairsTooClose) {
  const auto band = force_band({{1.0}, {1.1}, {1.0}}, {1.0, 1.5, 2.0});
  EXPECT_NEAR(band[0], 1.25 * 0.1 / (2.0 - 2.0 / 1.5), 1e-12);
}

/// Where all are close, the widest pair says what there is to say: an uncertainty is never zero for want of pairs.
TEST(Uncertainty, KeepsTheWidestPair) {
  EXPECT_NEAR(force_band({{1.0}, {1.05}, {1.1}}, {1.0, 1.1, 1.2})[0], 1.25 * 0.1 / (1.2 - 1.0), 1e-12);
}

/// Forces at one instant whose error is a multiple of f^-order.
std::vector<std::vector<double>> falling(const std::vector<double>& finer, double order) {
  std::vector<std::vector<double>> levels;
  for (const double f : finer) levels.push_back({5.0 + 0.3 * std::pow(f, -order)});
  return levels;
}

/// Between first order and the largest allowed one the error is held by exactly the safety factor.
TEST(Uncertainty, TakesTheOrderThatTheLevelsShow) {
  const std::vector<double> finer = {1.0, 1.6, 2.5};
  for (const double order : {1.0, 1.2, 1.5}) {
    const double left = 0.3 * std::pow(finer.back(), -order);
    EXPECT_NEAR(force_band(falling(finer, order), finer, {.most_order = 1.5})[0] / (1.25 * left), 1.0, 1e-4) << order;
  }
}

TEST(Uncertainty, BelievesInNoOrderBeyondItsBounds) {
  const std::vector<double> finer = {1.0, 1.6, 2.5};
  std::vector<double> at_most;
  for (const double f : finer) at_most.push_back(std::pow(f, 1.5));
  const auto fast = falling(finer, 4.0), slow = falling(finer, 0.4);
  EXPECT_NEAR(force_band(fast, finer, {.most_order = 1.5})[0] / force_band(fast, at_most)[0], 1.0, 1e-4);
  EXPECT_NEAR(force_band(slow, finer, {.most_order = 1.5})[0] / force_band(slow, finer)[0], 1.0, 1e-4);
}

/// The second instant's last two levels agree by chance, which the third shows. The first has the second's band alone.
TEST(Uncertainty, NeighboursShowTheOrder) {
  const std::vector<std::vector<double>> levels = {{5.0, 1.0, 7.0}, {5.0, 2.0, 7.0}, {5.0, 2.0, 7.7}};
  const std::vector<double> finer = {1.0, 1.6, 2.5};
  EXPECT_GT(force_band(levels, finer)[0], 0.0);
  EXPECT_EQ(force_band(levels, finer, {.most_order = 1.5})[0], force_band(levels, finer)[0]);
}

TEST(Uncertainty, AnInstantThatTheMeshesAreNotRefinedForLendsNothing) {
  const std::vector<std::vector<double>> levels = {{9.0, 2.0, 3.0}, {8.0, 2.0, 3.0}, {7.0, 2.0, 3.4}};
  const auto band = force_band(levels, halved, {.refined_for = {false, true, true}});
  EXPECT_NEAR(band[0], 1.25 * 1.0, 1e-12);
  EXPECT_NEAR(band[1], 1.25 * 0.4, 1e-12);
  EXPECT_NEAR(force_band(levels, halved)[1], 1.25 * 1.0, 1e-12);
}

TEST(Uncertainty, TakesTheLastThreeLevels) {
  const auto three = force_band({{1.1}, {1.05}, {1.0}}, {2.0, 3.0, 4.0});
  const auto four = force_band({{7.0}, {1.1}, {1.05}, {1.0}}, {1.5, 2.0, 3.0, 4.0});
  EXPECT_EQ(three[0], four[0]);
}

TEST(Uncertainty, UnknownWithFewerThanThreeLevels) {
  for (const double half_width : force_band({{1.0, 2.0}, {1.0, 2.0}}, {1.0, 1.5})) EXPECT_TRUE(std::isnan(half_width));
  const auto shape = point_band<3>({{Eigen::Matrix3Xd::Zero(3, 2)}}, {1.0});
  EXPECT_TRUE(std::isnan(shape[0][1]));
}

/// Errors of a whole surface of first order are held with the safety factor to spare, point by point; of higher orders
/// with more.
TEST(Uncertainty, ShapeHoldsAnErrorOfFirstOrder) {
  Eigen::Matrix3Xd error = Eigen::Matrix3Xd::Zero(3, 2);
  error.col(1) << 0.3, 0.4, 0.0;
  for (const std::vector<double>& finer : {std::vector<double>{1.0, 1.5, 2.0}, {1.5, 2.0, 3.0}, {1.0, 2.0, 4.0}}) {
    for (const double order : {1.0, 1.7, 2.0, 3.0}) {
      std::vector<std::vector<Eigen::Matrix3Xd>> levels;
      for (const double f : finer) levels.push_back({Eigen::Matrix3Xd::Ones(3, 2) + std::pow(f, -order) * error});
      const Eigen::VectorXd band = point_band(levels, finer)[0];
      EXPECT_EQ(band[0], 0.0);
      const double left = 0.5 * std::pow(finer.back(), -order);
      if (order == 1.0) {
        EXPECT_NEAR(band[1] / (1.25 * left), 1.0, 1e-9);
      } else {
        EXPECT_GT(band[1], 1.5 * left) << order;
      }
    }
  }
}

/// Three instants: apart, shallow, deep.
std::vector<scene::ReferenceInstant> instants(const std::vector<double>& bands_n = {0.0, 0.0, 0.0}) {
  std::vector<scene::ReferenceInstant> list(3);
  for (int i = 0; i < 3; ++i) {
    list[i].depth_m = std::vector{0.0, 0.0009, 0.01}[i];
    list[i].displacement_m = i * Eigen::Matrix3Xd::Ones(3, 2);
    list[i].displacement_uncertainty_m = Eigen::Vector2d(0.0, std::vector{0.0, 0.3, 0.4}[i]);
    list[i].force_uncertainty_n = bands_n[i];
    if (i > 0) list[i].regions.push_back({.depth_m = list[i].depth_m, .force_n = {0.0, 0.0, 2.0 * i}});
  }
  return list;
}

TEST(Uncertainty, RelativeForceOfTheDeepInstants) {
  EXPECT_NEAR(*force_uncertainty_rel(instants({9.0, 9.0, 0.2})), 0.05, 1e-12);
  EXPECT_TRUE(std::isnan(*force_uncertainty_rel(instants({9.0, 9.0, std::nan("")}))));
  EXPECT_FALSE(force_uncertainty_rel(std::vector<scene::ReferenceInstant>(1)));
}

TEST(Uncertainty, RelativeShapeByArea) {
  // All points move by sqrt(3) and 2 sqrt(3); three quarters of the area are uncertain.
  EXPECT_NEAR(*shape_uncertainty_rel(instants(), {1.0, 3.0}), std::sqrt(0.25 * 3.0 / (15.0 * 4.0)), 1e-12);
  EXPECT_NEAR(*shape_uncertainty_rel(instants(), {}), std::sqrt(0.25 / (15.0 * 2.0)), 1e-12);
}

}  // namespace
}  // namespace touchstone::reference
