#include "scene/shape/crossing.h"

#include "scene/shape/solids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace touchstone::scene {
namespace {

/// Every shape, around (0.005, -0.003, 0.02).
std::vector<std::shared_ptr<const Shape>> shapes() {
  const Vec3 center(0.005, -0.003, 0.02);
  std::vector<std::shared_ptr<const Shape>> all{std::make_shared<Box>(center, Vec3(0.01, 0.016, 0.012)),
                                                std::make_shared<Sphere>(center, 0.008),
                                                std::make_shared<Ellipsoid>(center, Vec3(0.012, 0.005, 0.008))};
  for (const Profile& profile : {capsule_profile(0.005, 0.01), cylinder_profile(0.006, 0.015, 0.001),
                                 Profile{{{0.0, 0.0}, {0.025, 0.0}, {0.0, 0.04}}, {}}}) {
    all.push_back(std::make_shared<Revolution>(profile, center));
  }
  return all;
}

/// The shape's own function and that for every convex shape.
using Cross = Crossing (*)(const Shape&, const Vec3&, const Vec3&);
const Cross crosses[] = {[](const Shape& s, const Vec3& from, const Vec3& to) { return s.crossing(from, to); },
                         [](const Shape& s, const Vec3& from, const Vec3& to) { return cross_convex(s, from, to); }};

/// Where a line is inside, by the sign of the signed distance alone: dense steps, then bisection.
Crossing by_sampling(const Shape& shape, const Vec3& from, const Vec3& to) {
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
    int hits = 0;
    for (int k = 0; k < 60; ++k) {
      const Vec3 from(place(random), place(random), place(random));
      // Through the neighbourhood of the shape, sometimes ending in it.
      const Vec3 through = Vec3(0.005, -0.003, 0.02) + Vec3(aside(random), aside(random), aside(random));
      const Vec3 to = k % 5 == 0 ? through : Vec3(from + 2.0 * (through - from));
      const Crossing sampled = by_sampling(*shape, from, to);
      // Sampling may miss a line that only grazes the shape.
      if (sampled.leave_m - sampled.enter_m < 1e-4 && !sampled.empty()) continue;
      for (const Cross cross : crosses) {
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
  const Sphere ball(Vec3(0.0, 0.0, 0.02), 0.008);
  for (const double offset : {0.0, 0.004, 0.0079, 0.0079999, 0.008 - 1e-9}) {
    const Vec3 from(-0.5, offset, 0.02), to(0.5, offset, 0.02);
    const double half = std::sqrt(0.008 * 0.008 - offset * offset);
    for (const Cross cross : crosses) {
      const Crossing here = cross(ball, from, to);
      EXPECT_NEAR(here.enter_m, 0.5 - half, 1e-9) << offset;
      EXPECT_NEAR(here.leave_m, 0.5 + half, 1e-9) << offset;
    }
  }
  for (const double offset : {0.008, 0.0081, 0.1}) {
    for (const Cross cross : crosses) {
      const Crossing here = cross(ball, Vec3(-0.5, offset, 0.02), Vec3(0.5, offset, 0.02));
      EXPECT_LT(here.leave_m - here.enter_m, 1e-6) << offset;
    }
  }
}

TEST(Crossing, OfALineWithoutLengthIsEmpty) {
  for (const auto& shape : shapes()) {
    const Vec3 inside(0.005, -0.003, 0.022);
    for (const Cross cross : crosses) EXPECT_TRUE(cross(*shape, inside, inside).empty());
  }
}

TEST(Crossing, EndsInsideStartAndStopWithTheLine) {
  for (const auto& shape : shapes()) {
    const Vec3 a(0.004, -0.004, 0.0215), b(0.006, -0.002, 0.0225);
    for (const Cross cross : crosses) {
      const Crossing here = cross(*shape, a, b);
      EXPECT_EQ(here.enter_m, 0.0);
      EXPECT_NEAR(here.leave_m, (b - a).norm(), 1e-15);
    }
  }
}

}  // namespace
}  // namespace touchstone::scene
