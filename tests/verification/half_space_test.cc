// Ball on a half space: Hertz in the limit of small load, Sneddon's exact ball, and the incompressible limit.
#include "reference/verification/half_space.h"

#include "reference/verification/closed_forms.h"
#include "reference/verification/pressed_with_friction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

namespace touchstone::verification {
namespace {

using scene::Kinematics;

constexpr double R_m = 0.01, E_pa = 3e6;

HalfSpaceProblem ball(double nu, double d_over_R, Kinematics kinematics, int level = 3) {
  return {{E_pa, nu}, ball_punch(R_m, d_over_R * R_m), d_over_R * R_m, kinematics, level};
}

class HalfSpace : public testing::TestWithParam<double> {};

TEST_P(HalfSpace, HertzAtSmallLoadInFiniteStrain) {
  const double a_over_R = 0.03;
  const HalfSpaceProblem problem = ball(GetParam(), a_over_R * a_over_R, Kinematics::finite);
  const HalfSpaceAnswer answer = indent_half_space(problem);
  const auto exact = hertz(contact_modulus_pa(E_pa, GetParam()), R_m, problem.depth_m);
  EXPECT_NEAR(answer.force_n / exact.force_n, 1.0, 0.005);
  EXPECT_NEAR(answer.contact_radius_m / exact.contact_radius_m, 1.0, 0.005);
  EXPECT_LT(answer.equilibrium_rel, 1e-6);
  EXPECT_LT(answer.node_penetration_m, 1e-9 * problem.depth_m);
}

TEST_P(HalfSpace, SneddonsBallInSmallStrain) {
  for (const double d_over_R : {0.05, 0.3, 0.6}) {
    const HalfSpaceProblem problem = ball(GetParam(), d_over_R, Kinematics::small);
    const HalfSpaceAnswer answer = indent_half_space(problem);
    const auto exact = sneddon(contact_modulus_pa(E_pa, GetParam()), R_m, problem.depth_m);
    EXPECT_NEAR(answer.force_n / exact.force_n, 1.0, 0.002) << "d/R = " << d_over_R;
    EXPECT_NEAR(answer.contact_radius_m / exact.contact_radius_m, 1.0, 0.004) << "d/R = " << d_over_R;
  }
}

INSTANTIATE_TEST_SUITE_P(PoissonsRatio, HalfSpace, testing::Values(0.3, 0.5));

TEST(HalfSpaceLimit, NearlyIncompressibleIsIncompressible) {
  const HalfSpaceAnswer limit = indent_half_space(ball(0.5, 0.2, Kinematics::finite, 2));
  const HalfSpaceAnswer nearly = indent_half_space(ball(0.4999, 0.2, Kinematics::finite, 2));
  EXPECT_NEAR(nearly.force_n / limit.force_n, 1.0, 0.001);
  EXPECT_NE(nearly.force_n, limit.force_n);
}

TEST(HalfSpaceLimit, LargeStepDoesNotEndInAnUnstableBalance) {
  // In one step this load has a second, unstable equilibrium at a distance of 0.05 to 0.1 %.
  const HalfSpaceAnswer limit = indent_half_space(ball(0.5, 0.3, Kinematics::finite, 3));
  const HalfSpaceAnswer nearly = indent_half_space(ball(0.4999, 0.3, Kinematics::finite, 3));
  EXPECT_NEAR(nearly.force_n / limit.force_n, 1.0, 0.0003);
}

TEST(HalfSpaceLimit, AContactNarrowerThanTheFirstCellConverges) {
  // The tool touches the two nodes nearest to the axis only, and what it presses on the axis holds the other one.
  for (const double share : {5.0, 5.25, 5.5, 8.0}) {
    const double depth_m = 2e-4 * R_m;
    HalfSpaceProblem problem{{E_pa, 0.3}, ball_punch(R_m, depth_m), share / 288.0 * depth_m, Kinematics::small, 0};
    const HalfSpaceAnswer answer = indent_half_space(problem);
    EXPECT_GT(answer.force_n, 0.0) << share;
    EXPECT_LT(answer.equilibrium_rel, 1e-6) << share;
    EXPECT_LT(answer.node_penetration_m, 1e-9 * problem.depth_m) << share;
    RecordProperty("force over Hertz at " + std::to_string(share),
                   std::to_string(answer.force_n / hertz(contact_modulus_pa(E_pa, 0.3), R_m, problem.depth_m).force_n));
  }
}

TEST(PressedWithFriction, StickingEverywhereIsMossakovskiis) {
  // V. I. Mossakovskii, J. Appl. Math. Mech. 27 (1963) 418-427: (1 - nu) ln(3 - 4 nu) / (1 - 2 nu).
  const double nu = 0.3, stuck = (1.0 - nu) * std::log(3.0 - 4.0 * nu) / (1.0 - 2.0 * nu);
  const PressedWithFriction much = pressed_with_friction(nu, 0.7, 30), some = pressed_with_friction(nu, 0.2, 30);
  EXPECT_GT(much.stick_radius, 0.99);
  EXPECT_NEAR(much.punch_stiffness, stuck, 0.0005);
  EXPECT_LT(some.punch_stiffness, much.punch_stiffness - 0.005);
}

TEST(PressedWithFriction, RingsConverge) {
  const PressedWithFriction coarse = pressed_with_friction(0.0, 0.3, 20), fine = pressed_with_friction(0.0, 0.3, 40);
  EXPECT_NEAR(coarse.stick_radius, fine.stick_radius, 1e-3);
  EXPECT_NEAR(coarse.punch_stiffness, fine.punch_stiffness, 2e-4);
  EXPECT_NEAR(coarse.ball_force, fine.ball_force, 1e-4);
  EXPECT_THROW((void)pressed_with_friction(0.3, 0.0), std::domain_error);
  EXPECT_THROW((void)pressed_with_friction(0.0, 0.05), std::domain_error);
  EXPECT_EQ(pressed_with_friction(0.5, 0.1).punch_stiffness, 1.0);
}

TEST(PressedWithFriction, TheSolverSlipsOutsideTheSameRadius) {
  const PressedWithFriction exact = pressed_with_friction(0.3, 0.2);
  HalfSpaceProblem problem{{E_pa, 0.3}, flat_punch(R_m), 0.01 * R_m};
  problem.friction = 0.2;
  const HalfSpaceAnswer punch = indent_half_space(problem);
  EXPECT_NEAR(punch.stick_radius_m / R_m, exact.stick_radius, 0.01 * exact.stick_radius);
  const double free_n = flat_punch_force_n(contact_modulus_pa(E_pa, 0.3), R_m, problem.depth_m);
  EXPECT_NEAR(punch.force_n / free_n, exact.punch_stiffness, 0.002);
}

}  // namespace
}  // namespace touchstone::verification
