#include "fast/live/safety.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace touchstone::live {
namespace {

using scene::Vec3;

constexpr double period_s = 1e-3;
const WrenchLimits limits{40.0, 2e4, 0.1, 0.01};  // 20 N per tick
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

Wrench push(double z_n) { return {Vec3(0, 0, z_n), Vec3::Zero()}; }

double size_n(const Wrench& w) { return std::max(w.force_n.norm(), w.torque_nm.norm() / limits.lever_m); }

Wrench difference(const Wrench& a, const Wrench& b) { return {a.force_n - b.force_n, a.torque_nm - b.torque_nm}; }

TEST(WrenchLimiter, PassesOnWhatIsWithinTheLimitsToTheLastBit) {
  WrenchLimiter limiter(limits, period_s);
  for (int i = 0; i < 1000; ++i) {
    const Wrench asked{Vec3(1.3 * std::sin(0.1 * i), 0.01 * i / 7.0, 15.0 * std::cos(0.01 * i) - 14.0),
                       Vec3(0.01 * std::sin(0.3 * i), 0.0, 0.1)};
    const Wrench sent = limiter.next(asked, true);
    EXPECT_EQ(sent.force_n, asked.force_n);
    EXPECT_EQ(sent.torque_nm, asked.torque_nm);
    EXPECT_FALSE(limiter.limited());
  }
}

TEST(WrenchLimiter, KeepsTheDirectionOfWhatIsTooMuch) {
  WrenchLimiter limiter(limits, period_s);
  const Vec3 asked_n(300.0, -400.0, 1200.0);
  Wrench sent;
  for (int i = 0; i < 5; ++i) {
    sent = limiter.next({asked_n, Vec3::Zero()}, true);
    EXPECT_LT(sent.force_n.normalized().cross(asked_n.normalized()).norm(), 1e-12);
    EXPECT_NEAR(sent.force_n.norm(), std::min(40.0, 20.0 * (i + 1)), 1e-9);
    EXPECT_TRUE(limiter.limited());
  }
  EXPECT_LE(sent.force_n.norm(), 40.0);
}

TEST(WrenchLimiter, ScalesForceAndTorqueAlike) {
  // A wrench's line of action is kept: one factor for both parts, here from the torque.
  WrenchLimiter limiter(limits, period_s);
  const Wrench asked{Vec3(0, 0, 10), Vec3(4, 0, 0)};  // 400 N at the lever
  Wrench sent;
  for (int i = 0; i < 5; ++i) sent = limiter.next(asked, true);
  EXPECT_NEAR(sent.torque_nm.x(), 0.4, 1e-9);
  EXPECT_NEAR(sent.force_n.z(), 1.0, 1e-9);
}

TEST(WrenchLimiter, HoldsItsLimitsWhateverComesIn) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-320.0, 308.0), sign(-1.0, 1.0);
  std::uniform_int_distribution<int> kind(0, 9);
  const auto number = [&] {
    switch (kind(random)) {
      case 0:
        return nan;
      case 1:
        return inf;
      case 2:
        return -inf;
      case 3:
        return std::numeric_limits<double>::max();
      case 4:
        return 0.0;
      case 5:
        return std::pow(10.0, exponent(random)) * sign(random);
      default:
        return 100.0 * sign(random);
    }
  };
  for (const WrenchLimits& l : {limits, WrenchLimits{40.0, 500.0, 0.1, 0.01}, WrenchLimits{1e-3, 1e6, 1e-9, 0.01},
                                WrenchLimits{40.0, 2e4, 0.1, 0.0}}) {
    WrenchLimiter limiter(l, period_s);
    Wrench before;
    const double lever_m = std::max(l.lever_m, 1e-6);
    for (int i = 0; i < 20000; ++i) {
      Wrench asked{Vec3(number(), number(), number()), Vec3(number(), number(), number())};
      if (i % 3 != 0) asked = {100.0 * Vec3::Random(), Vec3::Random()};  // mostly within the limits
      const Wrench sent = limiter.next(asked, kind(random) != 0);
      ASSERT_TRUE(sent.force_n.allFinite() && sent.torque_nm.allFinite());
      ASSERT_LE(sent.force_n.norm(), l.force_max_n);
      ASSERT_LE(sent.torque_nm.norm(), l.force_max_n * lever_m);
      const Wrench change = difference(sent, before);
      ASSERT_LE(change.force_n.norm(), l.force_slew_n_per_s * period_s);
      ASSERT_LE(change.torque_nm.norm(), l.force_slew_n_per_s * period_s * lever_m);
      before = sent;
    }
  }
}

TEST(WrenchLimiter, FadesToZeroInTheReleaseTimeAndBack) {
  WrenchLimiter limiter(limits, period_s);
  Wrench sent;
  for (int i = 0; i < 10; ++i) sent = limiter.next(push(30.0), true);
  ASSERT_EQ(sent.force_n.z(), 30.0);
  for (int i = 1; i <= 100; ++i) {
    // The model's output has no effect meanwhile.
    sent = limiter.next(i % 2 == 0 ? push(nan) : push(1e9), false);
    EXPECT_NEAR(sent.force_n.z(), 30.0 * (1.0 - i / 100.0), 1e-9);
    EXPECT_TRUE(limiter.limited());
  }
  for (int i = 0; i < 50; ++i) EXPECT_NEAR(size_n(limiter.next(push(nan), true)), 0.0, 1e-9);
  for (int i = 1; i <= 100; ++i) EXPECT_NEAR(limiter.next(push(20.0), true).force_n.z(), 0.2 * i, 1e-9);
  EXPECT_EQ(limiter.next(push(20.0), true).force_n.z(), 20.0);
  EXPECT_FALSE(limiter.limited());
}

TEST(WrenchLimiter, SlewComesBeforeTheRelease) {
  // 1 N per tick, although the release would allow 4.
  WrenchLimiter limiter({40.0, 1000.0, 0.01, 0.01}, period_s);
  for (int i = 0; i < 100; ++i) (void)limiter.next(push(40.0), true);
  double before_n = limiter.next(push(40.0), true).force_n.z();
  ASSERT_NEAR(before_n, 40.0, 1e-9);
  for (int i = 0; i < 41; ++i) {
    const double now_n = limiter.next(push(40.0), false).force_n.z();
    EXPECT_LE(before_n - now_n, 1.0);
    before_n = now_n;
  }
  EXPECT_NEAR(before_n, 0.0, 1e-9);
}

TEST(WrenchLimiter, ABadFirstPoseSendsNothing) {
  WrenchLimiter limiter(limits, period_s);
  EXPECT_EQ(size_n(limiter.next(push(30.0), false)), 0.0);
  EXPECT_EQ(size_n(limiter.next(push(30.0), false)), 0.0);
}

}  // namespace
}  // namespace touchstone::live
