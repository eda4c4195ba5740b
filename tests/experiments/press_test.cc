// Fig. 13: pressed straight down, the normal force rises nonlinearly with the depth.
#include "experiments/experiment.h"
#include "experiments/round_contact.h"

namespace touchstone::test {
namespace {

class Press : public Experiment {
 protected:
  const scene::Scene scene_ = scene("ball-on-cube-press");
  const std::vector<scene::InstantRecord> instants_ = in_contact(scene_);
  [[nodiscard]] double law_n(double depth_m) const {
    return depth_m * (scene_.contact.k1_n_per_m + scene_.contact.k3_n_per_m3 * depth_m * depth_m);
  }
};

TEST_P(Press, ForceAndStiffnessRise) {
  ASSERT_GT(instants_.size(), 15u);
  double force_n = 0.0, secant_n_per_m = 0.0;
  for (const scene::InstantRecord& instant : instants_) {
    const double F = instant.force_n().z();
    EXPECT_GT(F, force_n) << instant.depth_m;
    EXPECT_GT(F / instant.depth_m, secant_n_per_m) << instant.depth_m;
    force_n = F;
    secant_n_per_m = F / instant.depth_m;
  }
}

TEST_P(Press, TwiceAsDeepIsMoreThanTwiceTheForce) {
  // The linear term alone gives 2, the cubic term 8; slightly more because the contact area of the ball grows.
  double ratio = 0.0;
  for (std::size_t k = 0; 2 * k + 1 < instants_.size(); ++k) {
    const scene::InstantRecord &once = instants_[k], &twice = instants_[2 * k + 1];
    ASSERT_NEAR(twice.depth_m, 2.0 * once.depth_m, 1e-12);
    ratio = twice.force_n().z() / once.force_n().z();
    EXPECT_GT(ratio, 2.0) << once.depth_m;
    EXPECT_LT(ratio, 9.0) << once.depth_m;
  }
  EXPECT_GT(ratio, 7.0);
}

TEST_P(Press, ForceIsTheLawsMeanOverTheContact) {
  for (const scene::InstantRecord& instant : instants_) {
    const double d = instant.depth_m, F = instant.force_n().z();
    const RoundContact contact = ball_contact(scene_.tool.radius_m, d);
    EXPECT_LT(F, law_n(d));
    if (d < 1e-3) continue;  // too few samples for a mean
    const double expected_n = mean_force_n(
        GetParam(), [&](double d_i) { return law_n(d_i); }, contact);
    EXPECT_NEAR(F, expected_n, 0.02 * expected_n) << d;
    EXPECT_NEAR(instant.regions[0].area_m2, contact.area_m2(), 0.02 * contact.area_m2()) << d;
  }
}

TEST_P(Press, ForceIsUprightAndTheSupportHoldsIt) {
  for (const scene::InstantRecord& instant : instants_) {
    const scene::Vec3 F = instant.force_n();
    EXPECT_LT(std::hypot(F.x(), F.y()), 1e-12 * F.z());
    EXPECT_LT((instant.support_force_n - F).norm(), 1e-9 * F.z());
  }
}

INSTANTIATE_TEST_SUITE_P(Fig13, Press, both_formulations, formulation_name);

}  // namespace
}  // namespace touchstone::test
