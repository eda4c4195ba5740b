// Bounded least squares on functions with known solutions: does it find them, and does it report what is not
// determined?
#include "compare/tune/fit.h"

#include <Eigen/LU>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::compare {
namespace {

using ::testing::ElementsAre;
using Values = Eigen::VectorXd;

constexpr int points = 30;

/// Residuals of y(x) at points in (0, 1] against data with the given uncertainty.
template <class Curve>
Residuals against(const Curve& curve, const Values& truth, double uncertainty, double misfit = 0.0) {
  return [=](const Values& values) -> std::optional<Values> {
    Values out(points);
    for (int k = 0; k < points; ++k) {
      const double x = (k + 1.0) / points;
      out[k] = (curve(values, x) - curve(truth, x) + misfit * std::sin(9.0 * x)) / uncertainty;
    }
    return out;
  };
}

double cubic(const Values& p, double x) { return p[0] * x + p[1] * x * x * x; }

const std::vector<FitParameter> two = {{"linear", 1e-2, 1e4, 1.0, true}, {"cubic", 1e-2, 1e4, 1.0, true}};

TEST(Fit, FindsTheTruthAndCountsTheStartsThatDo) {
  const Fit found = fit(two, against(cubic, Eigen::Vector2d(7.0, 300.0), 1e-2), {});
  EXPECT_NEAR(found.value[0], 7.0, 1e-4);
  EXPECT_NEAR(found.value[1], 300.0, 1e-3);
  EXPECT_EQ(found.starts.size(), 4u);
  EXPECT_GE(found.starts_agreeing, 3);
  EXPECT_EQ(found.rank, 2);
  EXPECT_FALSE(found.parameters[0].open || found.parameters[1].open);
  EXPECT_TRUE(found.open_directions.empty());
}

TEST(Fit, StandardErrorsAndCorrelationAreThoseOfLinearLeastSquares) {
  const std::vector<FitParameter> linear = {{"linear", -1e3, 1e3, 1.0, false}, {"cubic", -1e3, 1e3, 1.0, false}};
  const Fit found = fit(linear, against(cubic, Eigen::Vector2d(7.0, 300.0), 0.5), {});
  Eigen::MatrixXd design(points, 2);
  for (int k = 0; k < points; ++k) {
    const double x = (k + 1.0) / points;
    design.row(k) << x / 0.5, x * x * x / 0.5;
  }
  const Eigen::Matrix2d covariance = (design.transpose() * design).inverse();
  EXPECT_NEAR(*found.parameters[0].error, std::sqrt(covariance(0, 0)), 1e-6);
  EXPECT_NEAR(*found.parameters[1].error, std::sqrt(covariance(1, 1)), 1e-6);
  EXPECT_NEAR(found.correlation(0, 1), covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1)), 1e-6);
  EXPECT_LT(found.correlation(0, 1), -0.8);
}

TEST(Fit, AMisfitWidensTheErrors) {
  const auto error = [](double misfit) {
    return *fit(two, against(cubic, Eigen::Vector2d(7.0, 300.0), 1e-2, misfit), {}).parameters[0].error;
  };
  EXPECT_GT(error(1.0), 10.0 * error(0.0));
}

TEST(Fit, NamesAnActiveBoundAndGivesNoErrorForIt) {
  const std::vector<FitParameter> narrow = {{"linear", 10.0, 1e4, 100.0, true}, two[1]};
  const Fit found = fit(narrow, against(cubic, Eigen::Vector2d(7.0, 300.0), 1e-2), {});
  EXPECT_EQ(found.parameters[0].at_bound, AtBound::low);
  EXPECT_FALSE(found.parameters[0].error);
  EXPECT_EQ(found.parameters[1].at_bound, AtBound::no);
  EXPECT_TRUE(found.parameters[1].error);
  EXPECT_EQ(found.free, 1);
  EXPECT_TRUE(std::isnan(found.correlation(0, 1)));
  EXPECT_GT(found.chi2_per_freedom, 1.0);
}

TEST(Fit, NamesAParameterWithoutEffect) {
  const std::vector<FitParameter> three = {two[0], two[1], {"idle", 1.0, 2.0, 1.5, false}};
  const Fit found = fit(three, against(cubic, Eigen::Vector3d(7.0, 300.0, 1.0), 1e-2), {});
  EXPECT_TRUE(found.parameters[2].open);
  EXPECT_FALSE(found.parameters[2].error);
  EXPECT_FALSE(found.parameters[0].open || found.parameters[1].open);
  EXPECT_EQ(found.rank, 2);
  EXPECT_EQ(found.free, 3);
  EXPECT_TRUE(std::isinf(found.condition));
  EXPECT_THAT(found.open_directions, ElementsAre(ElementsAre(2u)));
}

TEST(Fit, NamesParametersOfWhichOnlyTheProductCounts) {
  const auto product = [](const Values& p, double x) { return p[0] * p[1] * x; };
  const Fit found = fit(two, against(product, Eigen::Vector2d(7.0, 300.0), 1.0), {});
  EXPECT_NEAR(found.value[0] * found.value[1], 2100.0, 1e-2);
  EXPECT_TRUE(found.parameters[0].open && found.parameters[1].open);
  EXPECT_THAT(found.open_directions, ElementsAre(ElementsAre(0u, 1u)));
}

TEST(Fit, GoesRoundWhereTheModelHasNoAnswer) {
  const Residuals all = against(cubic, Eigen::Vector2d(7.0, 300.0), 1e-2);
  const Residuals some = [&](const Values& p) { return p[0] * p[1] > 1e5 ? std::nullopt : all(p); };
  EXPECT_NEAR(fit(two, some, {}).value[1], 300.0, 1e-3);
  const Residuals none = [](const Values&) { return std::nullopt; };
  EXPECT_THROW((void)fit(two, none, {}), std::runtime_error);
}

TEST(Profile, IsLeastAtTheFitAndWidensWithTheUncertainty) {
  const auto width = [](double uncertainty) {
    const Residuals residuals = against(cubic, Eigen::Vector2d(7.0, 300.0), uncertainty);
    const Fit found = fit(two, residuals, {});
    const Profile along = profile(two, residuals, found, 0, 41);
    EXPECT_LE(along.low, 7.0 + 1e-6);
    EXPECT_GE(along.high, 7.0 - 1e-6);
    return std::log(along.high / along.low);
  };
  EXPECT_LT(width(0.1), width(30.0));
}

TEST(Profile, StaysFlatForAParameterWithoutEffect) {
  const std::vector<FitParameter> three = {two[0], two[1], {"idle", 1.0, 2.0, 1.5, false}};
  const Residuals residuals = against(cubic, Eigen::Vector3d(7.0, 300.0, 1.0), 1e-2);
  const Profile along = profile(three, residuals, fit(three, residuals, {}), 2, 5);
  EXPECT_TRUE(along.open_low && along.open_high);
  const Profile known = profile(three, residuals, fit(three, residuals, {}), 1, 5);
  EXPECT_FALSE(known.open_low || known.open_high);
}

/// A line through the data, and a comb in one parameter with many local minima: a descent ends where it began.
std::optional<Values> comb(const Values& p) {
  return Values(Eigen::Vector3d(p[0] - 3.0, 0.2 * (p[1] - 8.0), 2.0 * std::sin(std::numbers::pi * p[1])));
}
const std::vector<FitParameter> toothed = {{"line", 0.0, 10.0, 1.0, false}, {"comb", 0.0, 16.0, 2.0, false}};

TEST(ProfiledFit, StartsAgainFromTheBestPlaceOfAProfile) {
  FitOptions one_start;
  one_start.starts = 1;
  EXPECT_NEAR(fit(toothed, comb, one_start).value[1], 2.0, 0.2);
  const ProfiledFit found = fit_through_profiles(toothed, comb, one_start, {1}, 17);
  EXPECT_EQ(found.rounds, 2);
  EXPECT_NEAR(found.fit.value[0], 3.0, 1e-6);
  EXPECT_NEAR(found.fit.value[1], 8.0, 1e-6);
  ASSERT_EQ(found.profiles.size(), 1u);
  EXPECT_EQ(found.profiles[0].parameter, 1u);
  // The profile is that of the last fit.
  EXPECT_GE(std::ranges::count(found.profiles[0].values, found.fit.value[1]), 1);
}

TEST(ProfiledFit, FitsOnceWhereNoProfileFindsABetterPlace) {
  EXPECT_EQ(fit_through_profiles(toothed, comb, {}, {}, 9).rounds, 1);
  EXPECT_EQ(fit_through_profiles(two, against(cubic, Eigen::Vector2d(7.0, 300.0), 1e-2, 1.0), {}, {0, 1}, 9).rounds, 1);
}

}  // namespace
}  // namespace touchstone::compare
