// Interpolation between the points of a load grid.
#include "scene/response/grid_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

namespace touchstone::scene {
namespace {

TEST(GridWeights, AreExactForQuadraticsAndSmooth) {
  for (const int count : {3, 4, 7}) {
    const auto value = [](double x) { return 3.0 - 2.0 * x + 0.7 * x * x; };
    double last = 0.0, last_slope = 0.0;
    for (int k = 0; k <= 100 * (count - 1); ++k) {
      const double x = 0.01 * k;
      const LineWeights line(x, count);
      double sum = 0.0, cubic = 0.0;
      for (int i = 0; i < 4 && line.first + i < count; ++i) {
        const double at = line.first + i;
        sum += line.weight[static_cast<std::size_t>(i)] * value(at);
        cubic += line.weight[static_cast<std::size_t>(i)] * std::sin(at);
      }
      EXPECT_NEAR(sum, value(x), 1e-12) << count << ' ' << x;
      const double slope = cubic - last;
      if (k > 1) {
        EXPECT_NEAR(slope, last_slope, 5e-4) << count << ' ' << x;
      }
      last = cubic;
      last_slope = slope;
    }
  }
  // Outside it is the nearest place.
  EXPECT_EQ(LineWeights(-5.0, 3).weight, LineWeights(0.0, 3).weight);
  EXPECT_EQ(LineWeights(9.0, 5).weight, LineWeights(4.0, 5).weight);
}

TEST(GridWeights, BetweenFourPointsAreExactForPlanesAndHeldAtTheEdge) {
  LoadGrid grid;
  grid.counts = {3, 5};
  const auto value = [&](int k) { return 2.0 - 0.3 * (k % 3) + 0.7 * (k / 3); };
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {0.4, 3.7}, {2.0, 4.0}, {1.0, 2.5}}) {
    const GridWeights four = GridWeights::linear(grid, {x, y});
    EXPECT_EQ(four.count, 4);
    EXPECT_NEAR(four.sum<double>(value), 2.0 - 0.3 * x + 0.7 * y, 1e-12);
  }
  EXPECT_NEAR(GridWeights::linear(grid, {-1.0, 9.0}).sum<double>(value), 2.0 + 0.7 * 4.0, 1e-12);
}

}  // namespace
}  // namespace touchstone::scene
