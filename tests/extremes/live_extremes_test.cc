// The extremes: the force sent to the device.
#include "extremes/rig.h"
#include "unit/fast/live/lock_step.h"

#include <limits>
#include <random>

namespace touchstone::live {
namespace {

using scene::Vec3;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

scene::Scene live_scene(scene::Formulation formulation) {
  scene::Scene scene = test::live_scene();
  scene.fast.formulation = formulation;
  return scene;
}

// A device whose poses jump, are NaN, are missing or have quaternions of length zero: every force is finite, at most
// force_max_n, and changes at most at its largest rate. As printed: Not mentioned: the computed force goes to the
// device.
TEST(LiveExtremes, AnyDevicePoseKeepsTheForceLimits) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const double K : {0.5, 1e6}) {
      scene::Scene scene = live_scene(formulation);
      scene.contact.friction = scene::Friction{K, 0.75, 0.4};
      std::mt19937 random(3);
      std::uniform_real_distribution<double> uniform(-1.0, 1.0);
      std::uniform_int_distribution<int> kind(0, 19);
      test::FakeDevice device([&](const Tick& tick, DeviceSample& sample) {
        const int what = kind(random);
        sample.pose = test::pressed(0.003 + 0.003 * uniform(random), 1e-4 * static_cast<double>(tick.index % 100));
        if (what == 0) sample.pose.position_m = Vec3(0.03 * uniform(random), 0.03 * uniform(random), 0.03);
        if (what == 1) sample.pose.position_m[kind(random) % 3] = nan;
        if (what == 2) sample.pose.orientation.coeffs().setZero();
        if (what == 3) sample.pose.position_m *= 1e300;
        return what != 4;
      });
      const test::LockStep run = test::lock_step(scene, device, 1000);
      ASSERT_EQ(run.records.size(), 1000u);
      EXPECT_GT(run.ledger.model_force_max_n, scene.live.force_max_n);
      EXPECT_GT(run.ledger.bad_poses, 50);
      Vec3 before_n = Vec3::Zero();
      for (const TickRecord& record : run.records) {
        const Wrench& sent = record.published;
        ASSERT_TRUE(sent.force_n.allFinite() && sent.torque_nm.allFinite());
        ASSERT_LE(sent.force_n.norm(), scene.live.force_max_n);
        ASSERT_LE((sent.force_n - before_n).norm(), scene.live.force_slew_n_per_s * 1e-3);
        before_n = sent.force_n;
      }
    }
  }
}

// A device that sends no more poses while in contact: the force fades to 0 within release_s, never rising, and stays
// there. As printed: Not mentioned.
TEST(LiveExtremes, SilentDeviceFadesToZero) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene scene = live_scene(formulation);
    test::FakeDevice device([](const Tick& tick, DeviceSample& sample) {
      sample.pose = test::pressed(std::min(0.003, 1e-5 * static_cast<double>(tick.index)));
      return tick.index < 400;
    });
    const test::LockStep run = test::lock_step(scene, device, 1000);
    ASSERT_GT(run.records[399].published.force_n.norm(), 1.0);
    const auto silent_ticks = static_cast<std::size_t>(scene.live.release_s * 1000);
    for (std::size_t k = 400; k < 1000; ++k) {
      const double force_n = run.records[k].published.force_n.norm();
      EXPECT_LE(force_n, run.records[k - 1].published.force_n.norm());
      if (k >= 400 + silent_ticks) {
        EXPECT_LE(force_n, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::live
