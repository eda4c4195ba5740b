#include "fast/beam.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace touchstone::fast {
namespace {

constexpr double rubber_pa = 3.0e6, pvc_pa = 33.77e3;

TEST(Beam, OneSegmentGivesEquationsTwoAndThree) {
  const double l = 0.05, s = 1e-4, I = second_moment_m4(s);
  const BeamSegment beam{l, rubber_pa, s, I};
  EXPECT_NEAR(bending_compliance_m_per_n({&beam, 1}), l * l * l / (3.0 * rubber_pa * I), 1e-12);
  EXPECT_NEAR(axial_compliance_m_per_n({&beam, 1}), l / (rubber_pa * s), 1e-18);
}

TEST(Beam, SecondMomentIsThatOfADisc) {
  const double radius = 0.004;
  const double pi = std::numbers::pi;
  EXPECT_NEAR(second_moment_m4(pi * radius * radius), pi * std::pow(radius, 4) / 4.0, 1e-22);
}

TEST(Beam, CuttingABeamChangesNothing) {
  const double s = 1e-4, I = second_moment_m4(s);
  const BeamSegment whole{0.05, rubber_pa, s, I};
  const std::array<BeamSegment, 3> cut{{{0.01, rubber_pa, s, I}, {0.025, rubber_pa, s, I}, {0.015, rubber_pa, s, I}}};
  const double bending = bending_compliance_m_per_n({&whole, 1}), axial = axial_compliance_m_per_n({&whole, 1});
  EXPECT_NEAR(bending_compliance_m_per_n(cut), bending, 1e-14 * bending);
  EXPECT_NEAR(axial_compliance_m_per_n(cut), axial, 1e-14 * axial);
}

TEST(Beam, TwoMaterialCantileverHasTheClosedForm) {
  // Errata E13: k = ((l - l_a)^3 - (l - l_b)^3) / 3, x from the fixed end.
  const double l = 0.06, E1 = rubber_pa, E2 = pvc_pa, s = 1.2e-4, I1 = second_moment_m4(s), I2 = 0.7 * I1;
  for (const auto& [a, b] : {std::pair{0.0, 0.2}, {0.3, 0.6}, {0.8, 1.0}, {1.0 / 3.0, 2.0 / 3.0}}) {
    const double l_a = a * l, l_b = b * l;
    const std::array<BeamSegment, 3> beam{{{l_a, E1, s, I1}, {l_b - l_a, E2, s, I2}, {l - l_b, E1, s, I1}}};
    const double k = (std::pow(l - l_a, 3) - std::pow(l - l_b, 3)) / 3.0;
    const double exact = (l * l * l / 3.0 - k) / (E1 * I1) + k / (E2 * I2);
    EXPECT_NEAR(bending_compliance_m_per_n(beam), exact, 1e-12 * exact);
    EXPECT_NEAR(axial_compliance_m_per_n(beam), (l - (l_b - l_a)) / (E1 * s) + (l_b - l_a) / (E2 * s), 1e-12);
  }
}

/// Tip deflection of a cantilever under a unit force, y'' = M / (E I) stepped from the fixed end by the explicit
/// trapezoid rule.
double integrated_tip_m(const std::vector<BeamSegment>& segments, int steps_per_segment) {
  double l = 0.0, x = 0.0, slope = 0.0, y = 0.0;
  for (const BeamSegment& segment : segments) l += segment.length_m;
  for (const BeamSegment& segment : segments) {
    const double h = segment.length_m / steps_per_segment, EI = segment.youngs_modulus_pa * segment.second_moment_m4;
    for (int i = 0; i < steps_per_segment; ++i) {
      const double here = (l - x) / EI, there = (l - x - h) / EI;
      const double slope_there = slope + 0.5 * h * (here + there);
      y += 0.5 * h * (slope + slope_there);
      slope = slope_there;
      x += h;
    }
  }
  return y;
}

TEST(Beam, ThreeMaterialsAreTheIntegralsLimitAtSecondOrder) {
  const double s = 1e-4, I = second_moment_m4(s);
  const std::vector<BeamSegment> beam{
      {0.013, rubber_pa, s, I}, {0.021, pvc_pa, 0.8 * s, 0.64 * I}, {0.017, 5.0 * rubber_pa, s, I}};
  const double exact = bending_compliance_m_per_n(beam);
  const double coarse = integrated_tip_m(beam, 8) - exact, middle = integrated_tip_m(beam, 16) - exact,
               fine = integrated_tip_m(beam, 32) - exact;
  EXPECT_NEAR(std::log2(coarse / middle), 2.0, 0.05);
  EXPECT_NEAR(std::log2(middle / fine), 2.0, 0.05);
  EXPECT_LT(std::abs(fine), 1e-3 * exact);
}

TEST(Beam, ExtremeModulusRatiosStayFinite) {
  const double s = 1e-4, I = second_moment_m4(s);
  double before = 0.0;
  for (double ratio = 1e6; ratio >= 1e-6; ratio /= 10.0) {
    const std::array<BeamSegment, 3> beam{
        {{0.02, rubber_pa, s, I}, {0.02, ratio * rubber_pa, s, I}, {0.02, rubber_pa, s, I}}};
    const double here = bending_compliance_m_per_n(beam);
    EXPECT_TRUE(std::isfinite(here));
    EXPECT_GT(here, before);
    before = here;
  }
}

}  // namespace
}  // namespace touchstone::fast
