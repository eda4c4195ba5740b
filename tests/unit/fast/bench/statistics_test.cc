#include "fast/bench/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::bench {
namespace {

TEST(Statistics, MedianIsTheLowerOfTheMiddle) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.0);
}

TEST(Statistics, NothingMeasuredIsNoNumber) {
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_EQ(ratio(6.0, 2.0), 3.0);
  EXPECT_TRUE(std::isnan(ratio(6.0, 0.0)));
  EXPECT_TRUE(std::isnan(ratio(std::nan(""), 2.0)));
  EXPECT_TRUE(std::isnan(ratio(6.0, std::nan(""))));
  EXPECT_TRUE(std::isnan(ratio(INFINITY, 2.0)));
}

}  // namespace
}  // namespace touchstone::bench
