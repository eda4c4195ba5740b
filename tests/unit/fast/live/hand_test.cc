// The closed loop: a virtual hand that reacts to the force, in virtual time.
#include "fast/live/hand_device.h"

#include "unit/fast/live/lock_step.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::live {
namespace {

using scene::Vec3;
using test::live_scene;
using test::lock_step;
using test::LockStep;

/// Force of the model at rest at this depth [N].
double force_at_n(const scene::Scene& scene, double depth_m) {
  fast::SkeletonEngine engine(scene);
  engine.step_force(test::pressed(-0.001));
  engine.step_force(test::pressed(depth_m));
  return engine.wrench().force_n.z();
}

TEST(Hand, SettlesWhereItsSpringEqualsTheContact) {
  scene::Scene scene = live_scene();
  for (const double stiffness_n_per_m : {100.0, 500.0, 3000.0}) {
    scene.live.hand_stiffness_n_per_m = stiffness_n_per_m;
    scene.live.hand_damping_n_s_per_m = 20.0;
    HandDevice hand(scene.track, scene.live, 1e-3);
    const LockStep run = lock_step(scene, hand, 8000);

    // Static solution of k (d_track - d) = F(d).
    const double asked_m = 0.006;
    double low_m = 0.0, high_m = asked_m;
    for (int i = 0; i < 60; ++i) {
      const double d_m = 0.5 * (low_m + high_m);
      (stiffness_n_per_m * (asked_m - d_m) > force_at_n(scene, d_m) ? low_m : high_m) = d_m;
    }
    const TickRecord& end = run.records.back();
    const double depth_m = 0.070 - end.pose.position_m.z();
    EXPECT_NEAR(depth_m, low_m, 1e-4 * low_m) << stiffness_n_per_m;
    EXPECT_NEAR(end.published.force_n.z(), stiffness_n_per_m * (asked_m - low_m),
                1e-3 * stiffness_n_per_m * (asked_m - low_m));
    EXPECT_GT(low_m, 1e-4);
    EXPECT_LT(low_m, 0.0059) << "it moves back";
    EXPECT_NEAR((end.pose.position_m - run.records[7990].pose.position_m).norm(), 0.0, 1e-9) << "at rest";
    EXPECT_LE(run.ledger.force_max_n, scene.live.force_max_n);
  }
}

TEST(Hand, InFreeSpaceItIsADampedOscillator) {
  // Released 20 mm from its place on the track: x(t) in closed form.
  scene::Scene scene = live_scene();
  const scene::Pose target = touchstone::test::at(0.02, 0.0, 0.2);
  scene.track = {{0.0, touchstone::test::at(0.0, 0.0, 0.2)}, {1e-9, target}, {1.0, target}};
  const double m = 0.2, c = 5.0, k = 500.0, rate_hz = 10000;
  HandDevice hand(scene.track, scene.live, 1.0 / rate_hz);
  const LockStep run = lock_step(scene, hand, 5000, static_cast<int>(rate_hz));
  const double decay = c / (2 * m), w = std::sqrt(k / m - decay * decay);
  for (std::size_t i = 100; i < run.records.size(); i += 100) {
    const double t = run.records[i].tick.time_s;
    const double x = 0.02 * (1.0 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
    // The damper reacts to the step of the track too: an impulse c dx, spread over the first period.
    const double jump = 0.02 * c / m * std::exp(-decay * t) * std::sin(w * t) / w;
    EXPECT_NEAR(run.records[i].pose.position_m.x(), x + jump, 1e-4) << t;
  }
}

TEST(Hand, EnergyOnlyFalls) {
  // Dropped onto the cube from 10 mm above, with the track 3 mm inside, at rest.
  scene::Scene scene = live_scene();
  scene.live.force_max_n = 200.0;
  scene.live.force_slew_n_per_s = 1e6;
  const scene::Pose high = test::pressed(-0.010), low = test::pressed(0.003);
  for (const double damping : {0.0, 5.0}) {
    scene.live.hand_damping_n_s_per_m = damping;
    scene.track = {{0.0, high}, {1e-9, low}, {1.0, low}};
    constexpr int rate_hz = 10000;
    HandDevice inner(scene.track, scene.live, 1.0 / rate_hz);
    std::vector<double> energy_j;
    energy_j.reserve(30000);
    /// The hand, and its energy after every tick.
    class Watched final : public Device {
     public:
      Watched(HandDevice& hand, std::vector<double>& energy) : hand_(hand), energy_(energy) {}
      [[nodiscard]] std::uint32_t capabilities() const noexcept override { return hand_.capabilities(); }
      [[nodiscard]] bool read(const Tick& tick, DeviceSample& sample) noexcept override {
        const bool good = hand_.read(tick, sample);
        energy_.push_back(hand_.energy_j());
        return good;
      }
      void write(const Wrench& wrench) noexcept override { hand_.write(wrench); }

     private:
      HandDevice& hand_;
      std::vector<double>& energy_;
    } device(inner, energy_j);
    const LockStep run = lock_step(scene, device, 30000, rate_hz);
    // Energy stored in the contact is not negative. So the hand never has more than at first, and without damping has
    // all of it again at the top of every bounce. The spring and the first tick's jump of the damper give the initial
    // energy.
    const double start_j = energy_j[2];
    EXPECT_GT(start_j, 0.5 * 500.0 * 0.012 * 0.012);
    double most_j = 0.0, least_j = start_j;
    for (std::size_t i = 2; i < energy_j.size(); ++i) {
      most_j = std::max(most_j, energy_j[i]);
      least_j = std::min(least_j, energy_j[i]);
    }
    EXPECT_LT(most_j, 1.02 * start_j) << damping;
    EXPECT_LT(least_j, 0.9 * start_j) << "it was in contact";
    if (damping > 0.0) {
      EXPECT_LT(energy_j.back(), 0.2 * start_j);
      EXPECT_NEAR(energy_j.back(), energy_j[29000], 1e-9);
    }
  }
}

TEST(Hand, EqualTicksGiveEqualBits) {
  const scene::Scene scene = live_scene();
  HandDevice first(scene.track, scene.live, 1e-3), second(scene.track, scene.live, 1e-3);
  EXPECT_EQ(lock_step(scene, first, 1500).answer_hash, lock_step(scene, second, 1500).answer_hash);
}

TEST(Hand, MovesOnUnderTheLastForceThroughMissedTicks) {
  const scene::Scene scene = live_scene();
  HandDevice every(scene.track, scene.live, 1e-3), some(scene.track, scene.live, 1e-3);
  const Wrench force{Vec3(0.3, -0.2, 1.0), Vec3::Zero()};
  every.write(force);
  some.write(force);
  DeviceSample a, b;
  for (std::int64_t k = 0; k <= 300; ++k) {
    const Tick tick{k, static_cast<double>(k) / 1000};
    ASSERT_TRUE(every.read(tick, a));
    if (k % 7 != 0 && k != 300) continue;
    ASSERT_TRUE(some.read(tick, b));
    EXPECT_EQ(a.pose.position_m, b.pose.position_m) << k;
    EXPECT_EQ(a.twist.linear_m_per_s, b.twist.linear_m_per_s) << k;
  }
  // A gap of hours counts as one second.
  ASSERT_TRUE(some.read({10'000'300, 10000.3}, b));
  for (std::int64_t k = 301; k <= 1300; ++k) ASSERT_TRUE(every.read({k, static_cast<double>(k) / 1000}, a));
  EXPECT_EQ(a.pose.position_m, b.pose.position_m);
}

TEST(Hand, RotationFollowsTheTrack) {
  scene::Scene scene = live_scene();
  scene.track[1].pose.orientation = touchstone::test::tilted();
  HandDevice hand(scene.track, scene.live, 1e-3);
  DeviceSample sample;
  for (std::int64_t k = 0; k <= 400; ++k) ASSERT_TRUE(hand.read({k, static_cast<double>(k) / 1000}, sample));
  EXPECT_LT(sample.pose.orientation.angularDistance(scene::pose_at(scene.track, 0.4).orientation), 1e-9);
}

TEST(Hand, RefusesAHandThatIsUnstableAtTheRate) {
  scene::Scene scene = live_scene();
  scene.live.hand_mass_kg = 1e-4;
  try {
    const HandDevice hand(scene.track, scene.live, 1e-3);
    FAIL();
  } catch (const scene::InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("live.hand_mass_kg = 0.0001"));
    EXPECT_THAT(error.what(), testing::HasSubstr("expected at least 0.00262"));
  }
  // Just above the required mass the hand comes to rest; just below, it would not.
  scene.live.hand_mass_kg = 0.00263;
  HandDevice hand(scene.track, scene.live, 1e-3);
  DeviceSample sample;
  for (std::int64_t k = 0; k < 20000; ++k) ASSERT_TRUE(hand.read({k, static_cast<double>(k) / 1000}, sample));
  EXPECT_LT((sample.pose.position_m - scene.track.back().pose.position_m).norm(), 1e-6);
}

}  // namespace
}  // namespace touchstone::live
