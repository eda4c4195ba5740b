// The springs of a contact with friction against Cattaneo's and Mindlin's contact of a ball, and their energy.
#include "fast/response/slip_springs.h"

#include "support/press.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace touchstone::fast {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double R_m = 0.010, nu = 0.3, mu = 0.4, depth_m = 0.001;
const scene::Material material{3.0e6, nu};
const double mean_radius_m = std::sqrt(R_m * depth_m);

/// A ball on a linear half space, moved without a body around it.
class SlipSpringsTest : public ::testing::Test {
 protected:
  explicit SlipSpringsTest(const scene::Friction& friction = {.K = mu, .beta = 1.0, .mu_D = mu})
      : table_(scene::ToolTip{.radius_m = R_m}, LocalShape{}, material.contact_modulus_pa(), FiniteStrain{}),
        springs_(friction, nu, table_) {}

  Slip move(double x_m, double y_m, double at_m = depth_m) {
    const Slip out = slip(springs_, table_.at(at_m), at_m, compliance_m_per_n_, Vector2d::Zero(), {x_m, y_m}, state_);
    work_j_ += (out.force_n + last_n_).dot(Vector2d(x_m, y_m)) / 2.0;
    last_n_ = out.force_n;
    return out;
  }
  /// Of Mindlin's contact, with the force as the table has it.
  [[nodiscard]] double mindlin_n(double u_m) const {
    const double F = table_.at(depth_m).force_n, core_m = depth_m - u_m * springs_.shear_ratio() / mu;
    return mu * (F - table_.at(std::max(core_m, 0.0)).force_n);
  }

  ContactTable table_;
  SlipSprings springs_;
  SlipState state_;
  Matrix2d compliance_m_per_n_ = Matrix2d::Zero();
  Vector2d last_n_ = Vector2d::Zero();
  double work_j_ = 0.0;
};

TEST_F(SlipSpringsTest, BeginAsMindlinsAndSlideAtTheLimit) {
  (void)move(0.0, 0.0);
  // 8 G a / (2 - nu), Johnson (1985), 7.42.
  const double a = table_.at(depth_m).radius_m, tangent = 8.0 * material.shear_modulus_pa() * a / (2.0 - nu);
  EXPECT_NEAR(a, mean_radius_m, 0.03 * a);
  const double little_m = 1e-9;
  EXPECT_NEAR(move(little_m, 0.0).force_n.x() / little_m, tangent, 2e-3 * tangent);
  const double F = table_.at(depth_m).force_n, last_m = mu * depth_m / springs_.shear_ratio();
  double u_m = little_m;
  for (int i = 1; i <= 60; ++i) {
    const double next_m = last_m * i / 50.0;
    const Slip now = move(next_m - u_m, 0.0);
    u_m = next_m;
    EXPECT_NEAR(now.force_n.x(), mindlin_n(u_m), 1e-3 * mu * F) << i;
    EXPECT_EQ(state_.sliding, i >= 50) << i;
    EXPECT_EQ(now.force_n.y(), 0.0);
  }
  EXPECT_NEAR(last_n_.x(), mu * F, 1e-12 * F);
  // Where all of it slips the shear has the pressure's distribution, and Hertz's moves the middle by this.
  const Slip slid = move(last_m, 0.0);
  EXPECT_NEAR(slid.moment_n_m2.x(), mu * F * a * a / 5.0, 0.01 * mu * F * a * a / 5.0);
  EXPECT_NEAR(slid.displacement_m.x(), last_m, 2e-3 * last_m);
}

TEST(SlipSpringsLimit, IsMindlinsWithEveryPoissonsRatio) {
  for (const double any_nu : {0.0, 0.3, 0.5}) {
    const scene::Material any{3.0e6, any_nu};
    const ContactTable table(scene::ToolTip{.radius_m = R_m}, LocalShape{}, any.contact_modulus_pa(), FiniteStrain{});
    const SlipSprings springs({.K = mu, .beta = 1.0, .mu_D = mu}, any_nu, table);
    SlipState state;
    double last_n = 0.0, gone_m = 0.0;
    const LocalContact law = table.at(depth_m);
    const auto to = [&](double u_m) {
      last_n = slip(springs, law, depth_m, Matrix2d::Zero(), Vector2d::Zero(), {u_m - gone_m, 0.0}, state).force_n.x();
      gone_m = u_m;
      return last_n;
    };
    (void)to(0.0);
    const double G = any.shear_modulus_pa(), a = law.radius_m, F = law.force_n;
    EXPECT_NEAR(to(1e-9) / 1e-9, 8.0 * G * a / (2.0 - any_nu), 2e-3 * 8.0 * G * a / (2.0 - any_nu)) << any_nu;
    // u = 3 mu F (2 - nu) / (16 G a) (1 - (1 - Q / (mu F))^(2/3)), Johnson (1985), 7.44.
    for (const double share : {0.2, 0.5, 0.8}) {
      const double u_m = 3.0 * mu * F * (2.0 - any_nu) / (16.0 * G * a) * (1.0 - std::pow(1.0 - share, 2.0 / 3.0));
      EXPECT_NEAR(to(u_m), share * mu * F, 0.03 * mu * F) << any_nu << ' ' << share;
    }
  }
}

TEST_F(SlipSpringsTest, TheWayBackIsTwiceAsLong) {
  // Q = Q* - 2 Q((u* - u) / 2) on the way back (Mindlin and Deresiewicz 1953).
  (void)move(0.0, 0.0);
  const double top_m = 0.6 * mu * depth_m / springs_.shear_ratio(), F = table_.at(depth_m).force_n;
  const int steps = 40;
  for (int i = 0; i < steps; ++i) (void)move(top_m / steps, 0.0);
  const double Q = last_n_.x();
  for (int i = 1; i <= 2 * steps; ++i) {
    const Slip now = move(-top_m / steps, 0.0);
    EXPECT_NEAR(now.force_n.x(), Q - 2.0 * mindlin_n(0.5 * top_m * i / steps), 2e-3 * mu * F) << i;
  }
  // And forth again: the loop closes.
  for (int i = 0; i < 2 * steps; ++i) (void)move(top_m / steps, 0.0);
  EXPECT_NEAR(last_n_.x(), Q, 1e-9 * Q);
}

TEST_F(SlipSpringsTest, StepsOfAnyLengthAndDirectionAreContinuous) {
  (void)move(0.0, 0.0);
  const double F = table_.at(depth_m).force_n, step_m = 1e-6;
  // No step changes the force by more than the stuck contact's stiffness allows; nor does a pause change it.
  const double stiffness = springs_.shear_ratio() * table_.at(depth_m).stiffness_n_per_m;
  Vector2d before_n = last_n_;
  for (int i = 0; i < 4000; ++i) {
    const double angle = 0.01 * i * (i % 1000 < 500 ? 1.0 : 0.2);
    const Slip now = move(step_m * std::cos(angle), step_m * std::sin(angle));
    EXPECT_LE((now.force_n - before_n).norm(), stiffness * step_m * (1.0 + 1e-9)) << i;
    EXPECT_LE(now.force_n.norm(), mu * F * (1.0 + 1e-12));
    before_n = now.force_n;
  }
  const bool sliding = state_.sliding;
  for (int i = 0; i < 3; ++i) EXPECT_LT((move(0.0, 0.0).force_n - before_n).norm(), 1e-12 * F);
  EXPECT_EQ(state_.sliding, sliding);
}

TEST_F(SlipSpringsTest, ClosedPathsDissipate) {
  // Loops of place and depth, with a body that gives way: no more work comes back than was put in.
  compliance_m_per_n_ << 2e-4, 5e-5, 5e-5, 1e-4;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int path = 0; path < 40; ++path) {
    state_ = {};
    last_n_.setZero();
    work_j_ = 0.0;
    const double ax = any(random), ay = any(random), down = 0.5 * any(random), lag = 3.0 * any(random);
    const auto at = [&](double angle) {
      return Vector2d(4e-4 * ax * std::sin(angle), 4e-4 * ay * std::sin(angle + lag));
    };
    const int steps = 2000;
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < steps; ++i) {
        const double angle = 2.0 * EIGEN_PI * i / steps, step = 2.0 * EIGEN_PI / steps;
        const Vector2d way_m = at(angle + step) - at(angle);
        (void)move(way_m.x(), way_m.y(), depth_m * (1.0 + down * std::sin(angle + step)));
      }
    }
    EXPECT_GT(work_j_, -1e-9) << path;
  }
}

TEST_F(SlipSpringsTest, PressedHarderItSticksAndLeavingItForgets) {
  for (int i = 0; i < 20; ++i) (void)move(1e-4, 0.0);
  EXPECT_TRUE(state_.sliding);
  const double Q = last_n_.x();
  // Deeper without a step: the force stays; shallower: it falls with the limit.
  EXPECT_NEAR(move(0.0, 0.0, 1.2 * depth_m).force_n.x(), Q, 1e-12 * Q);
  EXPECT_FALSE(state_.sliding);
  const double shallow_m = 0.3 * depth_m;
  EXPECT_LE(move(0.0, 0.0, shallow_m).force_n.x(), mu * table_.at(shallow_m).force_n * (1.0 + 1e-12));
}

TEST_F(SlipSpringsTest, TheBodyIsInSeries) {
  compliance_m_per_n_ << 3e-3, 0.0, 0.0, 1e-3;
  (void)move(0.0, 0.0);
  const double u_m = 2e-4;
  const Slip now = move(u_m, 0.0);
  EXPECT_NEAR(mindlin_n(u_m - 3e-3 * now.force_n.x()), now.force_n.x(), 3e-3 * now.force_n.x());
  // In one step or in many: in one direction the way does not matter.
  const double Q = now.force_n.x();
  state_ = {};
  (void)move(0.0, 0.0);
  for (int i = 0; i < 50; ++i) (void)move(u_m / 50, 0.0);
  EXPECT_NEAR(last_n_.x(), Q, 1e-9 * Q);
}

class SlipSpringsLaw : public SlipSpringsTest {
 protected:
  SlipSpringsLaw() : SlipSpringsTest({.K = 0.5, .beta = 0.8, .mu_D = 0.2}) {}
};

TEST_F(SlipSpringsLaw, SticksUpToItsLimitAndSlidesAtTheOther) {
  const double F = table_.at(depth_m).force_n, limit_n = 0.5 * std::pow(F, 0.8);
  double highest_n = 0.0;
  for (int i = 0; i < 400 && !state_.sliding; ++i) highest_n = std::max(highest_n, move(2e-6, 0.0).force_n.x());
  EXPECT_TRUE(state_.sliding);
  EXPECT_LE(highest_n, limit_n);
  EXPECT_GT(highest_n, 0.98 * limit_n);
  EXPECT_NEAR(last_n_.x(), 0.2 * F, 1e-12 * F);
  // Back: it sticks, and then may reach the higher limit again.
  EXPECT_LT(move(-2e-6, 0.0).force_n.x(), 0.2 * F);
  EXPECT_FALSE(state_.sliding);
}

}  // namespace
}  // namespace touchstone::fast
