#include "fast/run/duration_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace touchstone::fast {
namespace {

double exact_ns(std::vector<std::int64_t> sample, double part) {
  std::sort(sample.begin(), sample.end());
  const auto rank = static_cast<std::size_t>(std::ceil(part * static_cast<double>(sample.size())));
  return static_cast<double>(sample[std::max<std::size_t>(rank, 1) - 1]);
}

TEST(DurationHistogram, PercentilesAreWithinTwoPercentOfTheExact) {
  std::mt19937 random(3);
  std::lognormal_distribution<double> usual(std::log(2e4), 0.6);
  std::uniform_real_distribution<double> tail(1e6, 5e7);
  std::exponential_distribution<double> small(1.0 / 200.0);
  const std::vector<std::function<double()>> shapes{
      [&] { return usual(random); }, [&] { return random() % 200 == 0 ? tail(random) : usual(random); },
      [&] { return small(random); }, [&] { return std::pow(10.0, static_cast<double>(random() % 12)); }};
  for (const auto& shape : shapes) {
    DurationHistogram histogram;
    std::vector<std::int64_t> sample;
    for (int i = 0; i < 20000; ++i) {
      sample.push_back(std::llround(shape()));
      histogram.add(sample.back());
    }
    for (const double part : {1e-9, 0.1, 0.5, 0.9, 0.99, 0.999, 1.0}) {
      const double exact = exact_ns(sample, part);
      EXPECT_NEAR(histogram.percentile_ns(part), exact, 0.01 * exact) << part;
    }
    EXPECT_EQ(histogram.max_ns(), *std::max_element(sample.begin(), sample.end()));
    EXPECT_EQ(histogram.count(), sample.size());
  }
}

TEST(DurationHistogram, EveryDurationFallsIntoABinThatHoldsIt) {
  // One at a time, across every octave's boundary.
  for (int bit = 0; bit < 40; ++bit) {
    for (std::int64_t offset : {-1, 0, 1}) {
      const std::int64_t value = (std::int64_t{1} << bit) + offset;
      DurationHistogram histogram;
      histogram.add(value);
      histogram.add(std::int64_t{1} << 39);  // so that the maximum does not help
      EXPECT_NEAR(histogram.percentile_ns(0.5), static_cast<double>(value), 0.01 * static_cast<double>(value));
    }
  }
}

TEST(DurationHistogram, CountsBetweenTwoDurations) {
  DurationHistogram histogram;
  for (int i = 0; i < 1000; ++i) histogram.add(1'000'000 + 1000 * i);
  EXPECT_EQ(histogram.count_between(0.0, INFINITY), 1000u);
  EXPECT_EQ(histogram.count_between(0.0, 0.9e6), 0u);
  EXPECT_NEAR(static_cast<double>(histogram.count_between(1.2e6, 1.5e6)), 300.0, 30.0);
  EXPECT_EQ(histogram.count_between(0.0, 1.5e6) + histogram.count_between(1.5e6, INFINITY), 1000u);
}

TEST(DurationHistogram, SmallOnesAreExact) {
  DurationHistogram histogram;
  for (int i = 0; i < 100; ++i) histogram.add(i);
  EXPECT_EQ(histogram.percentile_ns(0.5), 49.0);
  EXPECT_EQ(histogram.percentile_ns(0.99), 98.0);
}

TEST(DurationHistogram, TakesAnything) {
  DurationHistogram histogram;
  EXPECT_EQ(histogram.percentile_ns(0.5), 0.0);
  EXPECT_EQ(histogram.percentiles().max_us, 0.0);
  histogram.add(-5);
  EXPECT_EQ(histogram.percentile_ns(1.0), 0.0);
  histogram.add(std::int64_t{1} << 62);
  EXPECT_EQ(histogram.max_ns(), std::int64_t{1} << 62);
  EXPECT_EQ(histogram.count(), 2u);
}

}  // namespace
}  // namespace touchstone::fast
