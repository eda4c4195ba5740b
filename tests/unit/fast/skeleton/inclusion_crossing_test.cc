#include "fast/skeleton/inclusion_crossing.h"

#include "support/bodies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// Every shape of inclusion, around (0.005, -0.003, 0.02).
std::vector<std::shared_ptr<const scene::Shape>> shapes() {
  const Vec3 center(0.005, -0.003, 0.02);
  std::vector<std::shared_ptr<const scene::Shape>> all{
      std::make_shared<scene::Box>(center, Vec3(0.01, 0.016, 0.012)), std::make_shared<scene::Sphere>(center, 0.008),
      std::make_shared<scene::Ellipsoid>(center, Vec3(0.012, 0.005, 0.008))};
  for (const scene::Profile& profile :
       {scene::capsule_profile(0.005, 0.01), scene::cylinder_profile(0.006, 0.015, 0.001), test::cone_profile()}) {
    all.push_back(std::make_shared<scene::Revolution>(profile, center));
  }
  return all;
}

/// Where a line runs inside, by the sign of the signed distance alone: dense steps, then halving.
Crossing by_sampling(const scene::Shape& shape, const Vec3& from, const Vec3& to) {
  constexpr int steps = 4000;
  const double length = (to - from).norm();
  const auto inside = [&](double t) { return shape.signed_distance_m(from + t * (to - from)) < 0.0; };
  int first = -1, last = -1;
  for (int i = 0; i <= steps; ++i) {
    if (inside(static_cast<double>(i) / steps)) {
      if (first < 0) first = i;
      last = i;
    }
  }
  if (first < 0) return {};
  const auto border = [&](double out, double in) {
    for (int i = 0; i < 50; ++i) (inside(0.5 * (out + in)) ? in : out) = 0.5 * (out + in);
    return in;
  };
  return {length * (first == 0 ? 0.0 : border((first - 1.0) / steps, static_cast<double>(first) / steps)),
          length * (last == steps ? 1.0 : border((last + 1.0) / steps, static_cast<double>(last) / steps))};
}

TEST(Crossing, IsWhereTheSignedDistanceIsNegative) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.04, 0.04), aside(-0.012, 0.012);
  for (const auto& shape : shapes()) {
    const Cross closed = crossing_of(*shape);
    int hits = 0;
    for (int k = 0; k < 60; ++k) {
      const Vec3 from(place(random), place(random), place(random));
      // Through the neighbourhood of the shape, now and then ending in it.
      const Vec3 through = Vec3(0.005, -0.003, 0.02) + Vec3(aside(random), aside(random), aside(random));
      const Vec3 to = k % 5 == 0 ? through : Vec3(from + 2.0 * (through - from));
      const Crossing sampled = by_sampling(*shape, from, to);
      // A line that only grazes the shape slips through the sampling.
      if (sampled.leave_m - sampled.enter_m < 1e-4 && !sampled.empty()) continue;
      for (const Cross cross : {closed, static_cast<Cross>(cross_convex)}) {
        const Crossing here = cross(*shape, from, to);
        if (sampled.empty()) {
          EXPECT_LT(here.leave_m - here.enter_m, 1e-4);
          continue;
        }
        ++hits;
        EXPECT_NEAR(here.enter_m, sampled.enter_m, 1e-11);
        EXPECT_NEAR(here.leave_m, sampled.leave_m, 1e-11);
      }
    }
    EXPECT_GT(hits, 24);
  }
}

TEST(Crossing, ClosedFormsAndTheSignedDistanceAgreeFarOutAndGrazing) {
  const scene::Sphere ball(Vec3(0.0, 0.0, 0.02), 0.008);
  for (const double offset : {0.0, 0.004, 0.0079, 0.0079999, 0.008 - 1e-9}) {
    const Vec3 from(-0.5, offset, 0.02), to(0.5, offset, 0.02);
    const double half = std::sqrt(0.008 * 0.008 - offset * offset);
    for (const Cross cross : {crossing_of(ball), static_cast<Cross>(cross_convex)}) {
      const Crossing here = cross(ball, from, to);
      EXPECT_NEAR(here.enter_m, 0.5 - half, 1e-9) << offset;
      EXPECT_NEAR(here.leave_m, 0.5 + half, 1e-9) << offset;
    }
  }
  for (const double offset : {0.008, 0.0081, 0.1}) {
    for (const Cross cross : {crossing_of(ball), static_cast<Cross>(cross_convex)}) {
      const Crossing here = cross(ball, Vec3(-0.5, offset, 0.02), Vec3(0.5, offset, 0.02));
      EXPECT_LT(here.leave_m - here.enter_m, 1e-6) << offset;
    }
  }
}

TEST(Crossing, OfALineWithoutLengthIsEmpty) {
  for (const auto& shape : shapes()) {
    const Vec3 inside(0.005, -0.003, 0.022);
    EXPECT_TRUE(crossing_of(*shape)(*shape, inside, inside).empty());
    EXPECT_TRUE(cross_convex(*shape, inside, inside).empty());
  }
}

TEST(Crossing, EndsInsideStartAndStopWithTheLine) {
  for (const auto& shape : shapes()) {
    const Vec3 a(0.004, -0.004, 0.0215), b(0.006, -0.002, 0.0225);
    for (const Cross cross : {crossing_of(*shape), static_cast<Cross>(cross_convex)}) {
      const Crossing here = cross(*shape, a, b);
      EXPECT_EQ(here.enter_m, 0.0);
      EXPECT_NEAR(here.leave_m, (b - a).norm(), 1e-15);
    }
  }
}

Inclusion ball(double x_m, double radius_m, double youngs_modulus_pa) {
  auto shape = std::make_shared<scene::Sphere>(Vec3(x_m, 0.0, 0.0), radius_m);
  const Cross cross = crossing_of(*shape);
  return {std::move(shape), youngs_modulus_pa, cross};
}

TEST(CutBeam, SegmentsStandInOrderAndAddUp) {
  // Given out of order, and the last one hit off its centre.
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
