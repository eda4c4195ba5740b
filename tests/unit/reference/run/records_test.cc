#include "reference/run/records.h"

#include "support/press.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace touchstone::reference {
namespace {

ContactRegion region(double x_m, double force_n) {
  ContactRegion made;
  made.force_n = {0.0, 0.0, force_n};
  made.center_m = {x_m, 0.0, 0.06};
  return made;
}

TEST(Records, ARegionAndItsMiddleHaveOnePlace) {
  scene::Scene scene = test::ball_on_cube();
  scene.track = {{0.0, test::pressed(0.001)}, {1.0, test::pressed(0.001)}};
  const std::vector<double> times_s{0.0, 1.0};
  std::vector<Step> steps(2);
  // What an instant finds first is the second region of the one before.
  steps[0].seen.regions = {region(-0.02, 5.0), region(0.02, 3.0)};
  steps[1].seen.regions = {region(0.02, 8.0), region(-0.02, 4.0)};
  Result result;
  fill_records(scene, times_s, steps, std::vector<Eigen::Matrix3Xd>(2, Eigen::Matrix3Xd::Zero(3, 1)), result);
  for (std::size_t t = 0; t < steps.size(); ++t) {
    const scene::ReferenceInstant& instant = result.instants[t];
    ASSERT_EQ(instant.regions.size(), 2u);
    ASSERT_EQ(instant.region_middles_m.size(), 2u);
    for (std::size_t r = 0; r < 2; ++r) {
      for (const ContactRegion& seen : steps[t].seen.regions) {
        if (seen.center_m == instant.region_middles_m[r]) {
          EXPECT_EQ(seen.force_n, instant.regions[r].force_n) << t << ' ' << r;
        }
      }
    }
    EXPECT_LT(instant.region_middles_m[0].x(), 0.0) << "the stronger region of the first instant";
  }
}

}  // namespace
}  // namespace touchstone::reference
