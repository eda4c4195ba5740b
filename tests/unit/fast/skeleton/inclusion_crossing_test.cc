#include "fast/skeleton/inclusion_crossing.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

namespace touchstone::fast {
namespace {

using scene::Vec3;

Inclusion ball(double x_m, double radius_m, double youngs_modulus_pa) {
  return {std::make_shared<scene::Sphere>(Vec3(x_m, 0.0, 0.0), radius_m), youngs_modulus_pa};
}

TEST(CutBeam, SegmentsStandInOrderAndAddUp) {
  // In arbitrary order, and the last one crossed off its centre.
  std::vector<Inclusion> inclusions{ball(0.05, 0.005, 2.0), ball(0.02, 0.004, 3.0)};
  const BeamSegments cut = cut_beam(inclusions, Vec3::Zero(), Vec3(0.06, 0.0, 0.0), {0.06, 1.0, 1e-4});
  ASSERT_EQ(cut.count, 5u);
  const double length[] = {0.016, 0.008, 0.021, 0.01, 0.005}, modulus[] = {1.0, 3.0, 1.0, 2.0, 1.0};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(cut.segment[i].length_m, length[i], 1e-15);
    EXPECT_EQ(cut.segment[i].youngs_modulus_pa, modulus[i]);
    EXPECT_EQ(cut.segment[i].second_moment_m4, second_moment_m4(1e-4));
  }
  // A beam that misses both is one segment.
  const BeamSegments missed = cut_beam(inclusions, Vec3(0, 0.01, 0), Vec3(0.06, 0.01, 0.0), {0.06, 1.0, 1e-4});
  ASSERT_EQ(missed.count, 1u);
  EXPECT_EQ(missed.segment[0].length_m, 0.06);
}

TEST(CutBeam, InsideTheNeighbourhoodSegmentsStretchInProportion) {
  const std::vector<Inclusion> inclusions{ball(0.005, 0.001, 2.0)};
  const BeamSegments cut = cut_beam(inclusions, Vec3::Zero(), Vec3(0.01, 0.0, 0.0), {0.03, 1.0, 1e-4});
  ASSERT_EQ(cut.count, 3u);
  EXPECT_NEAR(cut.segment[0].length_m, 0.012, 1e-15);
  EXPECT_NEAR(cut.segment[1].length_m, 0.006, 1e-15);
  EXPECT_NEAR(cut.segment[2].length_m, 0.012, 1e-15);
}

TEST(CutBeam, OfOverlappingInclusionsTheLaterOneCounts) {
  const std::vector<Inclusion> inclusions{ball(0.02, 0.01, 2.0), ball(0.02, 0.004, 3.0), ball(0.034, 0.006, 4.0)};
  const BeamSegments cut = cut_beam(inclusions, Vec3::Zero(), Vec3(0.06, 0.0, 0.0), {0.06, 1.0, 1e-4});
  double at = 0.0;
  for (const BeamSegment& segment : cut.all()) {
    const double middle = at + 0.5 * segment.length_m;
    const double expected = middle > 0.028 && middle < 0.04    ? 4.0
                            : middle > 0.016 && middle < 0.024 ? 3.0
                            : middle > 0.01 && middle < 0.03   ? 2.0
                                                               : 1.0;
    EXPECT_EQ(segment.youngs_modulus_pa, expected) << middle;
    at += segment.length_m;
  }
  EXPECT_NEAR(at, 0.06, 1e-15);
}

TEST(CutBeam, HoldsAsManyInclusionsAsDeclared) {
  std::vector<Inclusion> inclusions;
  for (std::size_t i = 0; i < inclusions_max; ++i) inclusions.push_back(ball(0.01 + 0.01 * i, 0.002, 2.0 + i));
  const BeamSegments cut = cut_beam(inclusions, Vec3::Zero(), Vec3(0.2, 0.0, 0.0), {0.2, 1.0, 1e-4});
  ASSERT_EQ(cut.count, segments_max);
  for (std::size_t i = 0; i < inclusions_max; ++i) {
    EXPECT_NEAR(cut.segment[2 * i + 1].length_m, 0.004, 1e-14);
    EXPECT_EQ(cut.segment[2 * i + 1].youngs_modulus_pa, 2.0 + i);
  }
}

}  // namespace
}  // namespace touchstone::fast
