// The closed forms against printed or independently computed numbers, before they are used for comparison.
#include "reference/verification/closed_forms.h"

#include <gtest/gtest.h>

namespace touchstone::verification {
namespace {

TEST(ClosedForms, SneddonOverHertz) {
  const double ratio[][2] = {{.05, .99500}, {.1, .98999}, {.2, .97996}, {.3, .96991}, {.5, .94981}, {1.0, .89976}};
  for (const auto& [d_over_R, expected] : ratio) {
    EXPECT_NEAR(sneddon(1.0, 1.0, d_over_R).force_n / hertz(1.0, 1.0, d_over_R).force_n, expected, 6e-6);
  }
}

TEST(ClosedForms, HertzPeakPressureOfSsnv104) {
  // Code_Aster SSNV104: ball of 50 mm, E = 20 GPa, nu = 0.3, a = 10 mm: p0 = 2798.3 MPa.
  const Indentation contact = hertz(contact_modulus_pa(20e9, 0.3), 0.05, 0.002);
  EXPECT_NEAR(contact.contact_radius_m, 0.010, 1e-12);
  EXPECT_NEAR(hertz_peak_pressure_pa(contact), 2798.3e6, 0.1e6);
}

TEST(ClosedForms, HertzsEllipse) {
  // Timoshenko and Goodier, Theory of Elasticity, 125: for theta = 60 degrees, (1/R'' - 1/R') / (1/R'' + 1/R') = cos
  // theta, the semi-axes are 1.486 and 0.717 of the cube root of 3 F / (2 E* (1/R' + 1/R'')).
  const auto [long_m, short_m] = hertz_semi_axes_m(2.0, 3.0, 1.0, 5.0);
  const double root_m = std::cbrt(3.0 * 5.0 / (2.0 * 2.0 * (1.0 / 3.0 + 1.0)));
  EXPECT_NEAR(long_m / root_m, 1.486, 1e-3);
  EXPECT_NEAR(short_m / root_m, 0.717, 1e-3);
  // Of equal curvatures the circle.
  const Indentation round = hertz(2.0, 3.0, 0.1);
  const auto [a_m, b_m] = hertz_semi_axes_m(2.0, 3.001, 2.999, round.force_n);
  EXPECT_NEAR(a_m, round.contact_radius_m, 1e-3 * round.contact_radius_m);
  EXPECT_NEAR(b_m, round.contact_radius_m, 1e-3 * round.contact_radius_m);
}

TEST(ClosedForms, ThickSpherePressure) {
  for (const auto& [stretch, expected] : {std::pair{1.25, .551869}, {1.5, .755433}, {2.0, .806927}}) {
    EXPECT_NEAR(thick_sphere_pressure_pa(1.0, 1.0, 2.0, stretch), expected, 1e-6);
  }
}

TEST(ClosedForms, RoundedPunchIsABallWithoutFlatAndAFlatPunchWithoutFillet) {
  const RoundedPunch ball = rounded_punch(1.0, 0.0, 1.0, 0.6);
  EXPECT_NEAR(ball.depth_m, sneddon_depth_m(1.0, 0.6), 1e-12);
  EXPECT_NEAR(ball.force_n, sneddon_force_n(1.0, 1.0, 0.6), 1e-12);
  const RoundedPunch sharp = rounded_punch(1.0, 1.0, 1e-6, 1.0 + 5e-7);
  EXPECT_NEAR(sharp.force_n / (2.0 * sharp.depth_m), 1.0, 1e-6);
}

TEST(ClosedForms, FlatPunchSettlesTheSurfaceByItsDepthAtTheRim) {
  EXPECT_NEAR(flat_punch_settlement_m(2.0, 0.1, 2.0), 0.1, 1e-15);
  EXPECT_NEAR(flat_punch_settlement_m(2.0, 0.1, 4.0), 0.1 / 3.0, 1e-15);
  EXPECT_DOUBLE_EQ(flat_punch_force_n(3.0, 2.0, 0.1), 1.2);
}

TEST(ClosedForms, RoundedConeIsACone) {
  const double half_angle = 1.2;
  double depth_m = 0.0;
  const Indentation blunt = rounded_cone(1.0, half_angle, 1e-5, 1.0, depth_m);
  const Indentation sharp = cone(1.0, half_angle, depth_m);
  EXPECT_NEAR(sharp.contact_radius_m, 1.0, 1e-5);
  EXPECT_NEAR(blunt.force_n / sharp.force_n, 1.0, 1e-5);
  // Entirely inside its ball, the cone is a ball.
  EXPECT_NEAR(rounded_cone(1.0, half_angle, 4.0, 1.0, depth_m).force_n, sneddon_force_n(1.0, 4.0, 1.0), 1e-12);
  EXPECT_NEAR(depth_m, sneddon_depth_m(4.0, 1.0), 1e-12);
}

TEST(ClosedForms, CompressibleBarBecomesIncompressible) {
  for (const double stretch : {0.7, 1.5}) {
    const scene::Material rubber{3.0, 0.5}, nearly{3.0, 0.499999};
    EXPECT_NEAR(neo_hookean_bar_pa(nearly, stretch) / neo_hookean_bar_pa(rubber, stretch), 1.0, 1e-5);
  }
  const scene::Material foam{3.0, 0.0};
  EXPECT_NEAR(neo_hookean_bar_pa(foam, 1.0 + 1e-6) / 1e-6, 3.0, 1e-4);
}

TEST(ClosedForms, DisplacementOfSsnv187) {
  EXPECT_NEAR(plane_strain_stretch(2.0 * 1.2345, -0.876) - 1.0, -0.078180, 5e-7);
}

TEST(ClosedForms, CantileverOfOneMaterial) {
  EXPECT_DOUBLE_EQ(cantilever_tip_m(3.0, 2.0, 4.0), 3.0 * 8.0 / (3.0 * 4.0));
  EXPECT_NEAR(cantilever_tip_m(3.0, 2.0, 4.0, 4.0, 0.5, 1.0), cantilever_tip_m(3.0, 2.0, 4.0), 1e-15);
}

}  // namespace
}  // namespace touchstone::verification
