#include "fast/contact_law.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::fast {
namespace {

struct Constants {
  const char* name;
  double k1, k3;
};

class ContactLawBattery : public testing::TestWithParam<Constants> {
 protected:
  DuffingLaw law{GetParam().k1, GetParam().k3};
  double deep_m = std::min(0.02, law.peak_depth_m());
};

TEST_P(ContactLawBattery, IsZeroAtRest) {
  EXPECT_EQ(law.force_n(0.0), 0.0);
  EXPECT_EQ(law.energy_j(0.0), 0.0);
  EXPECT_EQ(law.depth_m(0.0), 0.0);
}

TEST_P(ContactLawBattery, FollowsEquationOne) {
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

TEST_P(ContactLawBattery, NeverFallsWithDepth) {
  double before_n = 0.0;
  for (int i = 1; i <= 100; ++i) {
    const double here_n = law.force_n(3.0 * deep_m * i / 100.0);
    EXPECT_GE(here_n, before_n);
    before_n = here_n;
  }
}

TEST_P(ContactLawBattery, InverseReturnsTheDepth) {
  for (int i = 1; i <= 90; ++i) {
    const double D = deep_m * i / 100.0;
    EXPECT_NEAR(law.depth_m(law.force_n(D)), D, 1e-14 * D);
  }
}

INSTANTIATE_TEST_SUITE_P(Duffing, ContactLawBattery,
                         testing::Values(Constants{"hardening", 40.0, 3e8}, Constants{"cubic", 0.0, 3e8},
                                         Constants{"linear", 40.0, 0.0}, Constants{"softening", 4000.0, -3e6}),
                         [](const auto& test) { return test.param.name; });

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

TEST(ContactLaw, NotANumberPassesThrough) {
  for (const DuffingLaw& law : {DuffingLaw(40.0, 3e8), DuffingLaw(0.0, 3e8), DuffingLaw(4000.0, -3e6)}) {
    EXPECT_TRUE(std::isnan(law.force_n(std::nan(""))));
    EXPECT_TRUE(std::isnan(law.depth_m(std::nan(""))));
  }
}

TEST(ContactLaw, PaperConstantsGiveTheForcesOfErrataE2) {
  const DuffingLaw law(40.0, 3e8);
  EXPECT_NEAR(law.force_n(0.001), 0.34, 0.005);
  EXPECT_NEAR(law.force_n(0.002), 2.48, 0.005);
  EXPECT_NEAR(law.force_n(0.003), 8.22, 0.005);
}

}  // namespace
}  // namespace touchstone::fast
