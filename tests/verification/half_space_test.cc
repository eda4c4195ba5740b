// Ball on a half space: Hertz in the limit of small load, Sneddon's exact ball, and the incompressible limit.
#include "reference/verification/half_space.h"

#include "reference/verification/closed_forms.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace touchstone::verification
