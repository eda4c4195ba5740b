#include "reference/contact/regions.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace touchstone::reference {
namespace {

using scene::Vec3;

ContactRegion region(double x_m, double force_n) {
  ContactRegion region;
  region.center_m = {x_m, 0, 0};
  region.force_n = {0, 0, force_n};
  return region;
}

TEST(Regions, ChainsOfShortStepsAndLinksJoinPoints) {
  Eigen::Matrix3Xd points_m = Eigen::Matrix3Xd::Zero(3, 6);
  points_m.row(0) << 5.0, 0.0, 0.9, 1.9, 5.5, 9.0;
  EXPECT_EQ(region_of_points(points_m, {}, 1.0), (std::vector<int>{0, 1, 1, 1, 0, 2}));
  EXPECT_EQ(region_of_points(points_m, {}, 0.95), (std::vector<int>{0, 1, 1, 2, 0, 3}));
  EXPECT_EQ(region_of_points(points_m, {{5, 1}}, 1.0), (std::vector<int>{0, 1, 1, 1, 0, 1}));
  EXPECT_TRUE(region_of_points(Eigen::Matrix3Xd(3, 0), {}, 1.0).empty());
}

/// Each point with every other, as the definition has it.
std::vector<int> by_pairs(const Eigen::Matrix3Xd& points_m, double gap_m) {
  std::vector<int> region(static_cast<std::size_t>(points_m.cols()), -1);
  int regions = 0;
  for (std::size_t first = 0; first < region.size(); ++first) {
    if (region[first] >= 0) continue;
    std::vector<std::size_t> next = {first};
    region[first] = regions++;
    while (!next.empty()) {
      const std::size_t a = next.back();
      next.pop_back();
      for (std::size_t b = 0; b < region.size(); ++b) {
        const auto apart_m = points_m.col(static_cast<Eigen::Index>(a)) - points_m.col(static_cast<Eigen::Index>(b));
        if (region[b] >= 0 || apart_m.squaredNorm() > gap_m * gap_m) continue;
        region[b] = region[a];
        next.push_back(b);
      }
    }
  }
  return region;
}

TEST(Regions, OfManyPointsAreThoseOfAllPairs) {
  std::srand(1);
  for (const int count : {2, 30, 300}) {
    const Eigen::Matrix3Xd points_m = 0.05 * Eigen::Matrix3Xd::Random(3, count);
    for (const double gap_m : {0.0, 1e-9, 0.002, 0.006, 0.012, 0.03, 0.2}) {
      EXPECT_EQ(region_of_points(points_m, {}, gap_m), by_pairs(points_m, gap_m)) << count << ' ' << gap_m;
    }
  }
}

TEST(Regions, KeepTheirNumbersWhileTheyLive) {
  RegionIds ids;
  const auto follow = [&](const std::vector<ContactRegion>& regions) {
    std::vector<std::pair<int, int>> seen;
    for (const auto& place : ids.follow(regions, 0.5)) seen.emplace_back(place.id, place.region);
    return seen;
  };
  using Seen = std::vector<std::pair<int, int>>;
  EXPECT_EQ(follow({region(1.0, 5)}), (Seen{{0, 0}}));
  // Two new ones: the stronger first, after the one that goes on.
  EXPECT_EQ(follow({region(3.0, 1), region(5.0, 2), region(1.2, 9)}), (Seen{{0, 2}, {1, 1}, {2, 0}}));
  // One ends; its number is free for the next, which comes last in the order of creation.
  EXPECT_EQ(follow({region(3.1, 1), region(4.9, 2)}), (Seen{{1, 1}, {2, 0}}));
  EXPECT_EQ(follow({region(1.0, 5), region(3.1, 1), region(4.9, 2)}), (Seen{{1, 2}, {2, 1}, {0, 0}}));
  // Farther than the reach is another region.
  EXPECT_EQ(follow({region(2.0, 1)}), (Seen{{0, 0}}));
  EXPECT_EQ(follow({}), Seen{});
}

TEST(Regions, TheNearestPairGoesTogether) {
  RegionIds ids;
  (void)ids.follow({region(0.0, 2), region(1.0, 1)}, 10.0);
  const auto places = ids.follow({region(0.9, 1)}, 10.0);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].id, 1);
}

}  // namespace
}  // namespace touchstone::reference
