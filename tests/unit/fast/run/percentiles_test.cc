#include "fast/run/percentiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace touchstone::fast {
namespace {

TEST(Percentiles, APercentileIsTheSmallestThatEnoughOfTheSampleDoNotExceed) {
  std::mt19937 random(7);
  for (const std::size_t size : {1u, 2u, 3u, 10u, 99u, 100u, 101u, 1000u, 1001u}) {
    std::vector<double> sample_us;
    for (std::size_t i = 0; i < size; ++i) sample_us.push_back(static_cast<double>(random() % 500));
    const auto not_above = [&](double limit_us) {
      return static_cast<double>(
                 std::count_if(sample_us.begin(), sample_us.end(), [&](double us) { return us <= limit_us; })) /
             static_cast<double>(size);
    };
    for (const double part : {0.001, 0.5, 0.9, 0.99, 0.999, 1.0}) {
      const double p_us = percentile_us(sample_us, part);
      EXPECT_NE(std::find(sample_us.begin(), sample_us.end(), p_us), sample_us.end());
      EXPECT_GE(not_above(p_us), part);
      EXPECT_LT(not_above(p_us - 0.5), part) << size << " " << part;
    }
    const Percentiles all = percentiles(sample_us);
    EXPECT_EQ(all.p50_us, percentile_us(sample_us, 0.5));
    EXPECT_EQ(all.p99_us, percentile_us(sample_us, 0.99));
    EXPECT_EQ(all.p999_us, percentile_us(sample_us, 0.999));
    EXPECT_EQ(all.max_us, *std::max_element(sample_us.begin(), sample_us.end()));
  }
}

TEST(Percentiles, OfNothingAreZero) { EXPECT_EQ(percentiles({}).max_us, 0.0); }

}  // namespace
}  // namespace touchstone::fast
