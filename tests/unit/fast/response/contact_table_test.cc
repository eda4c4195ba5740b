// The local law against closed forms of contact mechanics.
#include "fast/response/contact_table.h"

#include "support/press.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

constexpr double E_star_pa = 4.0e6;

scene::ToolTip ball_tip(double radius_m) { return {.radius_m = radius_m}; }

scene::ToolTip flat_tip(double flat_m, double fillet_m) {
  return {.axis_T = -scene::Vec3::UnitZ(), .flat_radius_m = flat_m, .radius_m = fillet_m};
}

TEST(ContactTable, ABallOfTrueShape) {
  // C. M. Segedin, Mathematika 4 (1957) 156-161: D = a/2 ln((R + a) / (R - a)),
  // F = E* ((a^2 + R^2) / 2 ln((R + a) / (R - a)) - a R).
  const double R = 0.01;
  const ContactTable table(ball_tip(R), {}, E_star_pa, {});
  for (const double a : {0.0007, 0.002, 0.005, 0.007}) {
    const double logarithm = std::log((R + a) / (R - a)), D = 0.5 * a * logarithm;
    const double F = E_star_pa * (0.5 * (a * a + R * R) * logarithm - a * R);
    EXPECT_NEAR(table.at(D).force_n, F, 2e-5 * F) << a;
    EXPECT_NEAR(table.at(D).radius_m, a, 2e-4 * a) << a;
    EXPECT_NEAR(table.at(D).stiffness_n_per_m, 2.0 * E_star_pa * a, 5e-4 * 2.0 * E_star_pa * a) << a;
  }
}

TEST(ContactTable, HertzAsTheDepthGoesToZero) {
  const double R = 0.01, D = 1e-5;
  const double F = 4.0 / 3.0 * E_star_pa * std::sqrt(R) * std::pow(D, 1.5);
  for (const double nu : {0.0, 0.3, 0.5}) {
    const LocalContact contact = ContactTable(ball_tip(R), {}, E_star_pa, finite_strain(nu)).at(D);
    EXPECT_NEAR(contact.force_n, F, 2e-2 * F) << nu;  // x = 0.016
    EXPECT_NEAR(contact.radius_m, std::sqrt(R * D), 2e-2 * contact.radius_m);
    EXPECT_NEAR(contact.flat, 0.0, 1e-2);
    // Less deep it is nearer.
    const double less = ContactTable(ball_tip(R), {}, E_star_pa, finite_strain(nu)).at(0.01 * D).force_n / (1e-3 * F);
    EXPECT_NEAR(less, 1.0, 0.4 * std::abs(contact.force_n / F - 1.0) + 1e-3) << nu;
  }
}

TEST(ContactTable, ABallOnABallHasTheRelativeCurvature) {
  const LocalShape local{.h2_per_m = 0.5 / 0.03};
  const double R = 1.0 / (1.0 / 0.01 + 1.0 / 0.03), D = 2e-5;
  const double F = 4.0 / 3.0 * E_star_pa * std::sqrt(R) * std::pow(D, 1.5);
  EXPECT_NEAR(ContactTable(ball_tip(0.01), local, E_star_pa, {}).at(D).force_n, F, 2e-3 * F);
}

TEST(ContactTable, AFlatPunch) {
  const double a = 0.006, D = 1e-3;
  const LocalContact contact = ContactTable(flat_tip(a * 0.9999, a * 0.0001), {}, E_star_pa, {}).at(D);
  EXPECT_NEAR(contact.force_n, 2.0 * E_star_pa * a * D, 1e-3 * contact.force_n);
  EXPECT_NEAR(contact.radius_m, a, 1e-3 * a);
  EXPECT_NEAR(contact.flat, 1.0, 1e-2);
  EXPECT_NEAR(contact.stiffness_n_per_m, 2.0 * E_star_pa * a, 1e-3 * contact.stiffness_n_per_m);
}

TEST(ContactTable, AFilletIsBetween) {
  const ContactTable table(flat_tip(0.0045, 0.0015), {}, E_star_pa, {});
  double last_m = 0.0045;
  for (const double D : {1e-5, 1e-4, 1e-3, 3e-3}) {
    const LocalContact contact = table.at(D);
    EXPECT_GT(contact.radius_m, last_m);
    EXPECT_LT(contact.radius_m, 0.006);
    EXPECT_GT(contact.force_n, 2.0 * E_star_pa * 0.0045 * D);
    EXPECT_LT(contact.force_n, 2.0 * E_star_pa * contact.radius_m * D);
    last_m = contact.radius_m;
  }
}

TEST(ContactTable, OnePotential) {
  const scene::ToolTip line{.half_line_T_m = scene::Vec3(0.0, 0.0, 0.006), .radius_m = 0.01};
  for (const scene::ToolTip& tip : {ball_tip(0.01), flat_tip(0.0045, 0.0015), line}) {
    const ContactTable table(tip, {}, E_star_pa, {0.2, -0.1});
    double last_n = 0.0;
    for (double D = 3e-5; D < 0.009; D *= 1.3) {
      const double e = 1e-4 * D, force_n = table.at(D).force_n;
      EXPECT_NEAR((table.energy_j(D + e) - table.energy_j(D - e)) / (2.0 * e), force_n, 1e-6 * force_n) << D;
      EXPECT_NEAR((table.at(D + e).force_n - table.at(D - e).force_n) / (2.0 * e), table.at(D).stiffness_n_per_m,
                  1e-5 * table.at(D).stiffness_n_per_m)
          << D;
      EXPECT_GT(force_n, last_n);
      last_n = force_n;
    }
    double work_j = 0.0;
    const double step_m = 1e-6, last_m = 0.009;
    for (double D = 0.5 * step_m; D < last_m; D += step_m) work_j += table.at(D).force_n * step_m;
    EXPECT_NEAR(table.energy_j(last_m), work_j, 1e-5 * work_j);
    EXPECT_EQ(table.at(0.0).force_n, 0.0);
    EXPECT_EQ(table.at(-1.0).force_n, 0.0);
    EXPECT_EQ(table.at(10.0).force_n, table.at(table.largest_indentation_m()).force_n);
  }
}

TEST(ContactTable, FiniteStrainTakesItsFactor) {
  // Of a ball on a plane: area pi D (2 R - D), volume pi D^2 (3 R - D) / 3.
  const double R = 0.01, D = 0.004;
  const double a = std::sqrt(D * (2.0 * R - D)), d_m = D * (3.0 * R - D) / 3.0 / (2.0 * R - D), x = d_m / a;
  const double linear_n = ContactTable(ball_tip(R), {}, E_star_pa, {}).at(D).force_n;
  const double force_n = ContactTable(ball_tip(R), {}, E_star_pa, {0.1, 0.3}).at(D).force_n;
  EXPECT_NEAR(force_n / linear_n, 1.0 - 0.1 * x - 0.3 * x * x, 1e-5);
}

TEST(ContactTable, ThePressureUnderADiscIsItsForceAndHasItsSecondMoment) {
  const ContactTable table(flat_tip(0.009, 0.003), {}, E_star_pa, {});
  for (const double D : {1e-5, 5e-4, 0.002, 0.02}) {  // the last is deeper than the rim
    const LocalContact contact = table.at(D);
    const double a = contact.radius_m;
    double sum = 0.0, moment_m2 = 0.0, largest = 0.0;
    constexpr int steps = 20000;
    for (int k = 0; k < steps; ++k) {
      const double angle = 0.5 * std::numbers::pi * (k + 0.5) / steps, r = a * std::sin(angle);
      const double p = table.pressure_per_m2(D, r, 0.0);
      const double ring = 2.0 * std::numbers::pi * r * a * std::cos(angle) * 0.5 * std::numbers::pi / steps;
      sum += p * ring;
      moment_m2 += p * ring * r * r;
      largest = std::max(largest, p);
    }
    EXPECT_NEAR(sum, 1.0, 2e-3) << D;
    EXPECT_NEAR(moment_m2, (0.4 + contact.flat * (2.0 / 3.0 - 0.4)) * a * a, 1e-2 * a * a) << D;
    EXPECT_EQ(table.pressure_per_m2(D, 1.01 * a, 0.0), 0.0);
    if (D < 0.01) {
      EXPECT_NEAR(table.largest_pressure_per_m2(D), largest, 0.1 * largest) << D;
    }
  }
  // With no depth it is the flat punch's, away from the edge.
  const double a = 0.009;
  for (const double x : {0.0, 0.5, 0.8}) {
    const double punch = 0.5 / (std::numbers::pi * a * a * std::sqrt(1.0 - x * x));
    EXPECT_NEAR(table.pressure_per_m2(1e-6, x * a, 0.0), punch, 1e-2 * punch) << x;
  }
}

TEST(ContactTable, ThePressureOfALineIsItsForce) {
  const double R = 0.006, half_m = 0.012;
  const ContactTable table({.half_line_T_m = scene::Vec3(half_m, 0.0, 0.0), .radius_m = R}, {}, E_star_pa, {});
  for (const double D : {2e-4, 0.001, 0.003}) {
    double sum = 0.0, largest = 0.0;
    constexpr int steps = 200;
    for (int i = 0; i < steps; ++i) {
      for (int j = 0; j < steps; ++j) {
        const double p = table.pressure_per_m2(D, (i + 0.5) / steps * R, (j + 0.5) / steps * (half_m + R));
        sum += 4.0 * p * R * (half_m + R) / (steps * steps);
        largest = std::max(largest, p);
      }
    }
    EXPECT_NEAR(sum, 1.0, 0.02) << D;
    EXPECT_NEAR(table.largest_pressure_per_m2(D), largest, 0.02 * largest) << D;
    // Largest at the ends of the line.
    EXPECT_GT(largest, 1.05 * table.pressure_per_m2(D, 0.0, 0.0)) << D;
  }
}

TEST(ContactTable, FiniteStrainMovesThePressureOfABallAlone) {
  const FiniteStrain strain{.k1 = 0.1, .p1 = -0.4, .p2 = 0.2};
  const ContactTable table(ball_tip(0.01), {}, E_star_pa, strain);
  for (const double D : {0.0005, 0.004}) {
    const double x = D * (0.03 - D) / 3.0 / (0.02 - D) / std::sqrt(D * (0.02 - D));
    const LocalContact contact = table.at(D);
    EXPECT_NEAR(contact.widening, 1.0 + 0.1 * x, 1e-4);
    const double over_mean = (1.0 - contact.peaked) * 1.5 + 2.5 * contact.peaked;
    EXPECT_NEAR(over_mean, strain.peak(x) * contact.widening * contact.widening, 1e-3);
  }
  const LocalContact flat = ContactTable(flat_tip(0.0045, 0.0015), {}, E_star_pa, strain).at(0.001);
  EXPECT_EQ(flat.widening, 1.0);
  EXPECT_EQ(flat.peaked, 0.0);
}

TEST(LocalShape, OfSimpleBodies) {
  const auto cube = scene::body_shape(test::ball_on_cube().body);
  const LocalShape flat = local_shape(*cube, {0.0, 0.0, 0.06}, scene::Vec3::UnitZ(), 0.01);
  EXPECT_NEAR(flat.height_m(0.01), 0.0, 1e-15);
  const auto ball = scene::body_shape(test::ball_on_sphere().body);
  const scene::Vec3 n = scene::Vec3(0.3, 0.1, 0.9).normalized();
  const LocalShape round = local_shape(*ball, scene::Vec3(0.0, 0.0, 0.03) + 0.03 * n, n, 0.01);
  for (const double r : {0.003, 0.01}) {
    EXPECT_NEAR(round.height_m(r), 0.03 - std::sqrt(0.03 * 0.03 - r * r), 2e-3 * round.height_m(r)) << r;
  }
}

}  // namespace
}  // namespace touchstone::fast
