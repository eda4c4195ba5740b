// The numerical contact of a capsule on its side against closed forms.
#include "fast/response/line_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

constexpr double E_star_pa = 4.0e6, R = 0.006;

TEST(LineContact, WithoutALineItIsABallOfTrueShape) {
  // Segedin's, as in contact_table_test.cc.
  for (const double a : {0.0005, 0.002, 0.004}) {
    const double logarithm = std::log((R + a) / (R - a)), D = 0.5 * a * logarithm;
    const double F = E_star_pa * (0.5 * (a * a + R * R) * logarithm - a * R);
    EXPECT_NEAR(line_contact(R, 0.0, D, E_star_pa).force_n, F, 1e-3 * F) << a;
  }
  const double D = 4e-5;
  const LineContact small = line_contact(R, 0.0, D, E_star_pa);
  EXPECT_NEAR(small.half_width_m, std::sqrt(R * D), 1e-2 * small.half_width_m);
  EXPECT_NEAR(small.across2_m2, R * D / 5.0, 1e-2 * small.across2_m2);
  EXPECT_NEAR(small.along2_m2, R * D / 5.0, 1e-2 * small.along2_m2);
}

TEST(LineContact, InTheMiddleOfALongLineItIsACylinders) {
  // b^2 = 4 q R / (pi E*) with the load per length q (Johnson 1985, 4.43). Of two lengths, the difference has nearly
  // the middle's; the ends carry more.
  const double D = 1e-4, longer_m = 0.060, shorter_m = 0.050;
  const LineContact one = line_contact(R, longer_m, D, E_star_pa), other = line_contact(R, shorter_m, D, E_star_pa);
  const double q = (one.force_n - other.force_n) / (2.0 * (longer_m - shorter_m));
  EXPECT_NEAR(one.half_width_m, std::sqrt(4.0 * q * R / (std::numbers::pi * E_star_pa)), 0.06 * one.half_width_m);
  EXPECT_NEAR(one.across2_m2, one.half_width_m * one.half_width_m / 4.0, 0.1 * one.across2_m2);
  EXPECT_GT(std::sqrt(3.0 * one.along2_m2), longer_m);
  EXPECT_LT(std::sqrt(3.0 * one.along2_m2), 1.1 * longer_m);
}

TEST(LineContact, StiffensWithLengthAndDepth) {
  double last_n = 0.0;
  for (const double half_line_m : {0.0, 0.003, 0.012}) {
    const double n = line_contact(R, half_line_m, 0.002, E_star_pa).force_n;
    EXPECT_GT(n, last_n);
    last_n = n;
  }
  // Force is linear in the modulus and of the dimension of an area.
  const double n = line_contact(2.0 * R, 0.024, 0.004, 3.0 * E_star_pa).force_n;
  EXPECT_NEAR(n, 12.0 * last_n, 1e-6 * n);
}

}  // namespace
}  // namespace touchstone::fast
