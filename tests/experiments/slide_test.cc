// Fig. 14: moved along the cube, the ball first sticks and then slips; friction opposes the motion, F_n is constant.
#include "experiments/experiment.h"

#include <cmath>

namespace touchstone::test {
namespace {

constexpr double begins_s = 0.4, ends_s = 1.4;  ///< the motion along x

class Slide : public Experiment {
 protected:
  void SetUp() override {
    scene_.compare.instants = 301;  // every 0.1 mm of the motion
    for (scene::InstantRecord& instant : in_contact(scene_)) {
      if (instant.time_s <= begins_s + 1e-9) {
        before_.push_back(instant);
      } else if (instant.time_s <= ends_s + 1e-9) {
        (instant.regions[0].sliding ? sliding_ : stuck_).push_back(instant);
      } else {
        after_.push_back(instant);
      }
    }
    ASSERT_GT(before_.size(), 50u);
    ASSERT_GT(stuck_.size(), 5u);
    ASSERT_GT(sliding_.size(), 100u);
    ASSERT_GT(after_.size(), 15u);
  }
  [[nodiscard]] double limit_n(const scene::InstantRecord& instant) const {
    return scene_.contact.friction->K * std::pow(instant.force_n().z(), scene_.contact.friction->beta);
  }
  [[nodiscard]] static double friction_n(const scene::InstantRecord& instant) {
    return instant.regions[0].friction_n.norm();
  }

  scene::Scene scene_ = scene("ball-on-cube-slide");
  std::vector<scene::InstantRecord> before_, stuck_, sliding_, after_;
};

TEST_P(Slide, PressingAloneGivesNoFriction) {
  for (const scene::InstantRecord& instant : before_) {
    EXPECT_LT(friction_n(instant), 1e-12 * instant.force_n().z()) << instant.time_s;
    EXPECT_FALSE(instant.regions[0].sliding);
  }
}

TEST_P(Slide, SticksUntilTheLimitIsReached) {
  EXPECT_LT(stuck_.back().time_s, sliding_.front().time_s);
  double friction = 0.0;
  for (const scene::InstantRecord& instant : stuck_) {
    EXPECT_GT(friction_n(instant), friction) << instant.time_s;
    EXPECT_LE(friction_n(instant), limit_n(instant)) << instant.time_s;
    friction = friction_n(instant);
  }
  EXPECT_GT(friction, 0.9 * limit_n(stuck_.back()));
  EXPECT_LT(friction_n(sliding_.front()), friction) << "sliding friction is less than the most while stuck";
}

TEST_P(Slide, StuckForceLeansAsItsStretch) {
  // The force is along the direction of deformation, so F_t / F_n grows in proportion to the displacement along x.
  const double way_m = stuck_.front().tool.position_m.x() - before_.back().tool.position_m.x();
  const double lean = friction_n(stuck_.front()) / stuck_.front().force_n().z();
  for (const scene::InstantRecord& instant : stuck_) {
    const double dragged_m = instant.tool.position_m.x() - before_.back().tool.position_m.x();
    EXPECT_NEAR(friction_n(instant) / instant.force_n().z(), lean * dragged_m / way_m, 1e-6) << instant.time_s;
  }
}

TEST_P(Slide, SlidingFrictionOpposesTheMotionUnderAConstantNormalForce) {
  const double normal_n = sliding_.front().force_n().z(), mu_D = scene_.contact.friction->mu_D;
  for (const scene::InstantRecord& instant : sliding_) {
    const scene::Vec3 F_t = instant.regions[0].friction_n;
    EXPECT_NEAR(instant.force_n().z(), normal_n, 1e-9 * normal_n) << instant.time_s;
    EXPECT_NEAR(F_t.x(), -mu_D * normal_n, 1e-9 * normal_n) << instant.time_s;
    EXPECT_LT(std::hypot(F_t.y(), F_t.z()), 1e-9 * normal_n) << instant.time_s;
    EXPECT_NEAR(instant.force_n().x(), F_t.x(), 1e-9 * normal_n) << instant.time_s;
  }
}

TEST_P(Slide, RestAfterwardsKeepsTheFriction) {
  const double normal_n = sliding_.back().force_n().z();
  for (const scene::InstantRecord& instant : after_) {
    EXPECT_NEAR(instant.force_n().z(), normal_n, 1e-9 * normal_n) << instant.time_s;
    EXPECT_NEAR(friction_n(instant), friction_n(sliding_.back()), 1e-9 * normal_n) << instant.time_s;
    EXPECT_NEAR(instant.regions[0].friction_n.x(), -friction_n(instant), 1e-9 * normal_n) << instant.time_s;
  }
}

TEST_P(Slide, WithoutFrictionOnlyTheNormalForceIsLeft) {
  scene_.contact.friction.reset();
  const double normal_n = before_.back().force_n().z();
  for (const scene::InstantRecord& instant : in_contact(scene_)) {
    const scene::Vec3 F = instant.force_n();
    EXPECT_LT(std::hypot(F.x(), F.y()), 1e-12 * F.z()) << instant.time_s;
    if (instant.time_s < begins_s) continue;
    EXPECT_NEAR(F.z(), normal_n, 1e-9 * normal_n) << instant.time_s;
  }
}

INSTANTIATE_TEST_SUITE_P(Fig14, Slide, both_formulations, formulation_name);

}  // namespace
}  // namespace touchstone::test
