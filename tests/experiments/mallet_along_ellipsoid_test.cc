// Fig. 16: along an ellipsoid F_x changes its sign and the upward force is largest at the top. The figure shows normal
// force and friction separately, and so do the tests; the paper's y is z here and its z is -y.
#include "experiments/experiment.h"

#include <cmath>

namespace touchstone::test {
namespace {

using scene::InstantRecord;
using scene::Vec3;

class MalletAlongEllipsoid : public Experiment {
 protected:
  void SetUp() override {
    for (const InstantRecord& instant : in_contact(scene_)) {
      if (instant.time_s > 0.33 + 1e-9) along_.push_back(instant);  // after the pause on the left slope
    }
    ASSERT_GT(along_.size(), 45u);
  }
  [[nodiscard]] static double x_m(const InstantRecord& instant) { return instant.tool.position_m.x(); }
  [[nodiscard]] static Vec3 friction_n(const InstantRecord& instant) { return instant.regions[0].friction_n; }
  [[nodiscard]] static Vec3 normal_n(const InstantRecord& instant) { return instant.force_n() - friction_n(instant); }
  /// Of the rest surface under the tail's half ball, 67.456 mm below the mass centre.
  [[nodiscard]] Vec3 outward(const InstantRecord& instant) const {
    return body_->query(instant.tool.position_m - Vec3(0.0, 0.0, 0.067456)).normal;
  }
  /// Mean upward normal force between two distances from the top, on one side.
  [[nodiscard]] double mean_up_n(double from_m, double to_m) const {
    double sum_n = 0.0;
    int count = 0;
    for (const InstantRecord& instant : along_) {
      if (x_m(instant) < from_m || x_m(instant) > to_m) continue;
      sum_n += normal_n(instant).z();
      ++count;
    }
    return sum_n / count;
  }
  /// The place where a quantity changes from negative to positive, along x [m]; it does so once.
  template <class Quantity>
  [[nodiscard]] double rises_through_zero_m(Quantity quantity) const {
    double where_m = NAN;
    for (std::size_t k = 1; k < along_.size(); ++k) {
      const double before = quantity(along_[k - 1]), after = quantity(along_[k]);
      EXPECT_FALSE(before > 0.0 && after <= 0.0) << x_m(along_[k]);
      if (before > 0.0 || after <= 0.0) continue;
      const double s = -before / (after - before);
      where_m = (1.0 - s) * x_m(along_[k - 1]) + s * x_m(along_[k]);
    }
    return where_m;
  }

  scene::Scene scene_ = scene("mallet-along-ellipsoid");
  const std::unique_ptr<const scene::Shape> body_ = scene::body_shape(scene_.body);
  std::vector<InstantRecord> along_;
};

TEST_P(MalletAlongEllipsoid, NormalForceTurnsWithTheSurface) {
  for (const InstantRecord& instant : along_) {
    EXPECT_GT(normal_n(instant).normalized().dot(outward(instant)), std::cos(0.01)) << x_m(instant);
    EXPECT_GT(normal_n(instant).z(), 0.0);
    EXPECT_LT(normal_n(instant).y(), 0.0) << "small, on the side the mallet keeps to";
    EXPECT_GT(normal_n(instant).y(), -0.25 * normal_n(instant).z());
  }
}

TEST_P(MalletAlongEllipsoid, NormalForceAlongXChangesSignAtTheTop) {
  EXPECT_NEAR(rises_through_zero_m([](const InstantRecord& instant) { return normal_n(instant).x(); }), 0.0, 2e-4);
}

TEST_P(MalletAlongEllipsoid, UpwardNormalForceIsLargestAtTheTop) {
  const double top_n = mean_up_n(-0.005, 0.005);
  for (const double side : {-1.0, 1.0}) {
    const auto mean_n = [&](double near_m, double far_m) {
      return side < 0.0 ? mean_up_n(-far_m, -near_m) : mean_up_n(near_m, far_m);
    };
    EXPECT_LT(mean_n(0.015, 0.020), 0.99 * top_n) << side;
    EXPECT_LT(mean_n(0.020, 0.025), mean_n(0.015, 0.020)) << side;
    EXPECT_LT(mean_n(0.025, 0.030), mean_n(0.020, 0.025)) << side;
  }
}

TEST_P(MalletAlongEllipsoid, FrictionOpposesTheMotion) {
  for (std::size_t k = 1; k + 1 < along_.size(); ++k) {
    const Vec3 normal = outward(along_[k]), way_m = along_[k + 1].tool.position_m - along_[k - 1].tool.position_m;
    const Vec3 motion = (way_m - way_m.dot(normal) * normal).normalized();
    EXPECT_TRUE(along_[k].regions[0].sliding) << x_m(along_[k]);
    EXPECT_LT(friction_n(along_[k]).normalized().dot(motion), -std::cos(0.03)) << x_m(along_[k]);
    EXPECT_NEAR(friction_n(along_[k]).norm() / normal_n(along_[k]).norm(), scene_.contact.friction->mu_D, 1e-9);
    EXPECT_LT(friction_n(along_[k]).x(), 0.0);
    EXPECT_LT(std::abs(friction_n(along_[k]).y()), 0.1 * friction_n(along_[k]).norm());
  }
  // Downwards while the mallet moves up, upwards while it moves down.
  EXPECT_NEAR(rises_through_zero_m([](const InstantRecord& instant) { return friction_n(instant).z(); }), 0.0, 2e-3);
}

TEST_P(MalletAlongEllipsoid, WholeForceAlongXChangesSignWhereTheSlopeIsTheFrictionAngle) {
  const double where_m = rises_through_zero_m([](const InstantRecord& instant) { return instant.force_n().x(); });
  const auto there = std::min_element(along_.begin(), along_.end(), [&](const auto& a, const auto& b) {
    return std::abs(x_m(a) - where_m) < std::abs(x_m(b) - where_m);
  });
  ASSERT_NE(there, along_.end());
  const Vec3 normal = outward(*there);
  EXPECT_NEAR(normal.x() / normal.z(), scene_.contact.friction->mu_D, 0.03);
}

TEST_P(MalletAlongEllipsoid, WithoutFrictionTheWholeForceChangesSignAtTheTop) {
  scene_.contact.friction.reset();
  along_ = in_contact(scene_);
  EXPECT_NEAR(rises_through_zero_m([](const InstantRecord& instant) { return instant.force_n().x(); }), 0.0, 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Fig16, MalletAlongEllipsoid, both_formulations, formulation_name);

}  // namespace
}  // namespace touchstone::test
