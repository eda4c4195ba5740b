#include "fast/contact/contact_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::fast {
namespace {

struct LawCase {
  const char* name;
  scene::Contact contact;
  double radius_m;  ///< of the contact
  double k1, k3;    ///< the cubic it must be
};

scene::Contact duffing(double k1, double k3) { return {scene::ContactLaw::duffing, k1, k3, 0.0, {}}; }
scene::Contact area_aware(double k1_per_radius, double k3) {
  // k1 belongs to the other law and must not count.
  return {scene::ContactLaw::area_aware, 77.0, k3, k1_per_radius, {}};
}

class ContactLawBattery : public testing::TestWithParam<LawCase> {
 protected:
  DuffingLaw law = ContactLaw(GetParam().contact).at(GetParam().radius_m);
  double deep_m = law.peak_depth_m() > 0.0 ? std::min(0.02, law.peak_depth_m()) : 0.02;
  bool forceless = GetParam().k1 == 0.0 && GetParam().k3 <= 0.0;
};

TEST_P(ContactLawBattery, IsZeroAtRest) {
  EXPECT_EQ(law.force_n(0.0), 0.0);
  EXPECT_EQ(law.energy_j(0.0), 0.0);
  EXPECT_EQ(law.depth_m(0.0), 0.0);
  EXPECT_DOUBLE_EQ(law.secant_n_per_m(0.0), GetParam().k1);
}

TEST_P(ContactLawBattery, FollowsTheCubic) {
  for (const double D : {1e-6, 1e-4, 1e-3, 5e-3}) {
    if (D > law.peak_depth_m()) continue;
    EXPECT_NEAR(law.force_n(D), GetParam().k1 * D + GetParam().k3 * D * D * D, 1e-15 * law.force_n(D));
  }
}

TEST_P(ContactLawBattery, SlopeIsTheForcesDerivative) {
  for (int i = 1; i < 20; ++i) {
    const double D = deep_m * i / 20.0, h = 1e-5 * deep_m;
    const double difference = (law.force_n(D + h) - law.force_n(D - h)) / (2.0 * h);
    EXPECT_NEAR(law.slope_n_per_m(D), difference, 1e-8 * law.slope_n_per_m(0.5 * deep_m) + 1e-9);
  }
}

TEST_P(ContactLawBattery, ForceIsTheEnergysDerivative) {
  for (int i = 1; i < 30; ++i) {
    const double D = deep_m * i / 20.0, h = 1e-5 * deep_m;  // past the peak too
    const double difference = (law.energy_j(D + h) - law.energy_j(D - h)) / (2.0 * h);
    EXPECT_NEAR(law.force_n(D), difference, 1e-7 * law.force_n(deep_m));
  }
}

TEST_P(ContactLawBattery, SecantIsForceOverDepth) {
  for (int i = 1; i < 60; ++i) {
    const double D = deep_m * i / 20.0;  // past the peak too
    EXPECT_NEAR(law.secant_n_per_m(D) * D, law.force_n(D), 1e-15 * law.force_n(D));
  }
}

TEST_P(ContactLawBattery, NeverFallsWithDepth) {
  double before_n = 0.0;
  for (int i = 1; i <= 100; ++i) {
    const double here_n = law.force_n(3.0 * deep_m * i / 100.0);
    EXPECT_GE(here_n, before_n);
    EXPECT_EQ(here_n > 0.0, !forceless);
    before_n = here_n;
  }
}

TEST_P(ContactLawBattery, InverseReturnsTheDepthOverTwelveDecades) {
  if (forceless) {
    EXPECT_EQ(law.depth_m(1.0), 0.0);
    return;
  }
  for (int i = 1; i <= 90; ++i) {
    for (double part = 1.0; part > 1e-13; part *= 0.1) {
      const double D = part * deep_m * i / 100.0;
      EXPECT_NEAR(law.depth_m(law.force_n(D)), D, 1e-13 * D);
    }
  }
}

TEST_P(ContactLawBattery, SaturatesWhereItSoftens) {
  if (GetParam().k3 >= 0.0) {
    EXPECT_EQ(law.peak_depth_m(), std::numeric_limits<double>::infinity());
    return;
  }
  const double peak_m = law.peak_depth_m(), peak_n = law.force_n(peak_m);
  EXPECT_NEAR(peak_n, 2.0 / 3.0 * GetParam().k1 * peak_m, 1e-15 * peak_n);
  EXPECT_EQ(law.force_n(peak_m + 5.0), peak_n);
  EXPECT_EQ(law.slope_n_per_m(peak_m + 5.0), 0.0);
  EXPECT_EQ(law.depth_m(2.0 * peak_n), peak_m);
}

TEST_P(ContactLawBattery, NotANumberPassesThrough) {
  const double nan = std::nan("");
  EXPECT_TRUE(std::isnan(law.force_n(nan)));
  EXPECT_TRUE(std::isnan(law.slope_n_per_m(nan)));
  EXPECT_TRUE(std::isnan(law.secant_n_per_m(nan)));
  EXPECT_TRUE(std::isnan(law.energy_j(nan)));
  EXPECT_TRUE(std::isnan(law.depth_m(nan)));
}

INSTANTIATE_TEST_SUITE_P(Laws, ContactLawBattery,
                         testing::Values(LawCase{"duffing_hardening", duffing(40.0, 3e8), 0.003, 40.0, 3e8},
                                         LawCase{"duffing_cubic", duffing(0.0, 3e8), 0.003, 0.0, 3e8},
                                         LawCase{"duffing_linear", duffing(40.0, 0.0), 0.003, 40.0, 0.0},
                                         LawCase{"duffing_softening", duffing(4000.0, -3e6), 0.003, 4000.0, -3e6},
                                         LawCase{"duffing_almost_linear", duffing(40.0, 1e-310), 0.003, 40.0, 1e-310},
                                         LawCase{"duffing_almost_cubic", duffing(1e-300, 3e8), 0.003, 1e-300, 3e8},
                                         LawCase{"area_aware_hardening", area_aware(2e6, 3e8), 0.003, 6000.0, 3e8},
                                         LawCase{"area_aware_larger", area_aware(2e6, 3e8), 0.010, 20000.0, 3e8},
                                         LawCase{"area_aware_speck", area_aware(2e6, 3e8), 1e-12, 2e-6, 3e8},
                                         LawCase{"area_aware_point", area_aware(2e6, 3e8), 0.0, 0.0, 3e8},
                                         LawCase{"area_aware_linear", area_aware(2e6, 0.0), 0.003, 6000.0, 0.0},
                                         LawCase{"area_aware_softening", area_aware(2e6, -3e6), 0.003, 6000.0, -3e6},
                                         LawCase{"area_aware_softening_point", area_aware(2e6, -3e6), 0.0, 0.0, -3e6},
                                         LawCase{"area_aware_linear_point", area_aware(2e6, 0.0), 0.0, 0.0, 0.0}),
                         [](const auto& test) { return test.param.name; });

TEST(ContactLaw, OnlyTheAreaAwareOneGrowsWithTheContact) {
  const ContactLaw aware(area_aware(2e6, 3e8)), plain(duffing(40.0, 3e8));
  const double a = contact_radius_m(4.0 * std::numbers::pi * 1e-6);
  EXPECT_DOUBLE_EQ(a, 0.002);
  // Four times the area is twice the radius and twice the linear part.
  const double D = 1e-3, cubic_n = 3e8 * D * D * D;
  EXPECT_NEAR(aware.at(2.0 * a).force_n(D) - cubic_n, 2.0 * (aware.at(a).force_n(D) - cubic_n), 1e-14);
  EXPECT_EQ(plain.at(2.0 * a).force_n(D), plain.at(0.0).force_n(D));
  EXPECT_EQ(contact_radius_m(0.0), 0.0);
}

TEST(ContactLaw, HardeningInverseHoldsOverEverySize) {
  for (double k1 = 1e-6; k1 <= 1e9; k1 *= 1e3) {
    for (double k3 = 1e-6; k3 <= 1e18; k3 *= 1e3) {
      const DuffingLaw law(k1, k3);
      for (double D = 1e-9; D <= 10.0; D *= 10.0) {
        EXPECT_NEAR(law.depth_m(law.force_n(D)), D, 1e-14 * D) << "k1 " << k1 << " k3 " << k3;
      }
    }
  }
}

TEST(ContactLaw, SofteningLawSaturatesAtItsPeak) {
  const DuffingLaw law(4000.0, -3e6);
  const double peak_m = std::sqrt(4000.0 / 9e6), peak_n = 2.0 / 3.0 * 4000.0 * peak_m;
  EXPECT_DOUBLE_EQ(law.peak_depth_m(), peak_m);
  EXPECT_NEAR(law.force_n(3.0 * peak_m), peak_n, 1e-12 * peak_n);  // as printed: nine times the peak and rising
  EXPECT_EQ(law.slope_n_per_m(2.0 * peak_m), 0.0);
  EXPECT_EQ(law.depth_m(2.0 * peak_n), peak_m);
  EXPECT_LT(law.depth_m(0.999 * peak_n), peak_m);
}

TEST(ContactLaw, PaperConstantsGiveTheForcesOfErrataE2) {
  const DuffingLaw law(40.0, 3e8);
  EXPECT_NEAR(law.force_n(0.001), 0.34, 0.005);
  EXPECT_NEAR(law.force_n(0.002), 2.48, 0.005);
  EXPECT_NEAR(law.force_n(0.003), 8.22, 0.005);
}

}  // namespace
}  // namespace touchstone::fast
