// The extremes: invalid poses, jumps, pauses, and many ticks.
#include "extremes/rig.h"

#include <limits>
#include <numbers>
#include <random>

namespace touchstone::fast {
namespace {

using extremes::has;
using extremes::in;
using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

scene::Friction rubber() { return {0.6, 0.75, 0.4}; }

/// Scenes with different kinds of state: plain, with friction, with two regions.
std::vector<scene::Scene> scenes_with_memory(Formulation formulation) {
  scene::Scene plain = extremes::cube(formulation), rubbing = plain;
  rubbing.contact.friction = rubber();
  scene::Scene pins = extremes::pins_on_cube(formulation, {Vec3(-0.01, 0, 0), Vec3(0.012, 0.003, 0.0003)});
  pins.contact.friction = rubber();
  return {plain, rubbing, pins};
}
// A pose with a number that is NaN or infinite in any place: exactly the last result, and the next valid pose gives the
// result as if the invalid one had not occurred. As printed: Not mentioned: it passes through every formula to the
// device.
TEST(TimeExtremes, InvalidPoseIsIgnored) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : scenes_with_memory(formulation)) {
      Rig rig(scene), other(scene);
      rig.may = other.may = StepStatus::anchors_limited;
      for (const double bad : {nan, inf, -inf}) {
        rig.to(in(scene, 0.002));
        other.to(in(scene, 0.002));
        const std::uint64_t before = rig.hash();
        for (int place = 0; place < 7; ++place) {
          scene::Pose pose = in(scene, 0.001, 0.001);
          (place < 3 ? pose.position_m[place] : pose.orientation.coeffs()[place - 3]) = bad;
          EXPECT_EQ(rig.to(pose), StepStatus::not_finite);
          EXPECT_EQ(rig.hash(), before);
        }
        rig.to(in(scene, 0.001, 0.001));
        other.to(in(scene, 0.001, 0.001));
        EXPECT_EQ(rig.hash(), other.hash());
      }
    }
  }
}

// No valid pose from the first tick on: no contact, no force, a surface at rest. As printed: NaN from the first tick
// on.
TEST(TimeExtremes, NoValidPoseIsNoContact) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : scenes_with_memory(formulation)) {
      Rig rig(scene);
      for (int i = 0; i < 100; ++i) EXPECT_EQ(rig.to(test::at(nan, 0.0, 0.065)), StepStatus::not_finite);
      EXPECT_FALSE(rig.state.in_contact());
      EXPECT_EQ(rig.force_n(), Vec3::Zero());
      EXPECT_EQ(rig.largest_displacement_m(), 0.0);
    }
  }
}

// A quaternion of any length from 1e-320 to 1e308: between 0.5 and 2 it is normalised, any other is an invalid pose. As
// printed: Not mentioned.
TEST(TimeExtremes, QuaternionOfAnyLength) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene scene = extremes::punch_on_cube(formulation);
    const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.05, Vec3(1, 2, 3).normalized()));
    const Vec3 place_m = extremes::punched(0.002).position_m;
    Rig unit(scene);
    unit.may = StepStatus::anchors_limited;
    unit.to({place_m, tilt});
    std::vector<double> lengths{0.0, 0.499, 0.501, 0.8, 1.5, 1.999, 2.001};
    for (int power = -320; power <= 308; power += 10) lengths.push_back(std::pow(10.0, power));
    for (const double length : lengths) {
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      const StepStatus status = rig.to({place_m, Eigen::Quaterniond(length * tilt.coeffs())});
      const bool taken = length > 0.5 && length < 2.0;
      EXPECT_EQ(has(status, StepStatus::not_finite), !taken) << length;
      EXPECT_EQ(rig.state.placed, taken) << length;
      if (!taken) continue;
      EXPECT_LE((rig.force_n() - unit.force_n()).norm(), 1e-9 * unit.force_n().norm()) << length;
    }
  }
}

// The largest finite distance, and from there into contact in one tick: no contact, then the force of a new press. As
// printed: Not mentioned: slow motion is assumed.
TEST(TimeExtremes, FromTheLargestDistanceIntoContact) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : scenes_with_memory(formulation)) {
      for (const double far_m : {1e9, 1e160, 1e308}) {
        for (const Vec3& way : {Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(1, 1, 1)}) {
          Rig rig(scene), fresh(scene);
          rig.may = fresh.may = StepStatus::anchors_limited;
          rig.to({far_m * way, Eigen::Quaterniond::Identity()});
          EXPECT_FALSE(rig.state.in_contact());
          rig.to(in(scene, 0.002));
          fresh.to(in(scene, 0.002));
          EXPECT_LE((rig.force_n() - fresh.force_n()).norm(), 1e-9 * fresh.force_n().norm());
        }
      }
    }
  }
}

// 50 mm back and forth in every tick, in contact at both ends, with friction: bounded, and friction within its limit.
// As printed: Slow motion is assumed; the stretch of a jump is used as it is, until C4 limits it.
TEST(TimeExtremes, FiftyMillimetresInEveryTick) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : scenes_with_memory(formulation)) {
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      for (int i = 0; i < 200; ++i) {
        rig.to(in(scene, 0.002, i % 2 == 0 ? 0.025 : -0.025));
        EXPECT_LT(rig.force_n().norm(), 1e3);
      }
      rig.to(in(scene, -0.001));
      EXPECT_EQ(rig.force_n(), Vec3::Zero());
    }
  }
}

// Any pose in any tick, inside and around the body: finite, within the law's bound, and nothing left at the end. As
// printed: Each of the divisions by zero occurs at some time (E6, E8, E9).
TEST(TimeExtremes, AnyPoseInAnyTick) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : scenes_with_memory(formulation)) {
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
      std::mt19937 random(5);
      std::uniform_real_distribution<double> uniform(-1.0, 1.0);
      for (int i = 0; i < 150; ++i) {
        const Vec3 place_m = Vec3(0.0, 0.0, 0.03) + 0.045 * Vec3(uniform(random), uniform(random), uniform(random));
        const Eigen::Vector4d turn(uniform(random), uniform(random), uniform(random), uniform(random));
        rig.to({place_m, Eigen::Quaterniond(turn)});
      }
      rig.to(test::at(0.0, 0.0, 1.0));
      EXPECT_EQ(rig.largest_displacement_m(), 0.0);
    }
  }
}

// A tool that does not move: identical bits from the third tick on, sticking or slipping. As printed: The same while
// sticking; after slip friction continues to act against the last motion (E5).
TEST(TimeExtremes, APauseRepeatsTheAnswer) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : scenes_with_memory(formulation)) {
      for (const double drag_m : {1e-5, 2e-3}) {
        Rig rig(scene);
        rig.may = StepStatus::anchors_limited;
        rig.to(in(scene, 0.002));
        for (int i = 1; i <= 10; ++i) rig.to(in(scene, 0.002, 0.1 * i * drag_m));
        rig.to(in(scene, 0.002, drag_m));
        rig.to(in(scene, 0.002, drag_m));
        const std::uint64_t still = rig.hash();
        for (int i = 0; i < 10; ++i) {
          step(rig.model, in(scene, 0.002, drag_m), rig.state);
          ASSERT_EQ(rig.hash(), still) << i;
        }
      }
    }
  }
}

/// One round of the tool: down, along, deeper, rotated, back and off.
scene::Pose on_the_round(const scene::Scene& scene, int tick, int round) {
  const double t = 2.0 * std::numbers::pi * tick / round;
  scene::Pose pose = in(scene, 0.0015 - 0.0025 * std::cos(t), 0.004 * std::sin(2.0 * t));
  pose.position_m.y() = 0.003 * std::cos(3.0 * t);
  pose.orientation = Eigen::AngleAxisd(0.2 * std::sin(t), Vec3(1, 2, 3).normalized());
  return pose;
}

// 1e8 ticks of a periodic motion: the whole state has identical bits after one round. A tick is a function of state and
// pose alone, so this holds after every later round, and 1e8 ticks are the same as 300. As printed: Each shape is an
// update of the last time step's, so errors add up.
TEST(TimeExtremes, HundredMillionTicksArePeriodic) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : scenes_with_memory(formulation)) {
      constexpr int round = 150;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      std::array<std::uint64_t, round> first{};
      for (int tick = 0; tick < 3 * round; ++tick) {
        rig.to(on_the_round(scene, tick % round, round));
        const auto k = static_cast<std::size_t>(tick % round);
        if (tick < round) continue;
        if (tick < 2 * round) first[k] = rig.hash();
        if (tick >= 2 * round) {
          ASSERT_EQ(rig.hash(), first[k]) << "tick " << tick;
        }
      }
    }
  }
}

// The same, simulated: 1e5 ticks, half of them in each formulation, with the same bits after every round. As printed:
// As above.
TEST(TimeExtremes, HundredThousandTicksDoNotDrift) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = scenes_with_memory(formulation)[1];
    scene.fast.tool_samples = 20;
    scene.fast.triangles = 12;
    constexpr int round = 100, rounds = 500;
    Rig rig(scene);
    std::uint64_t first = 0;
    double most_n = 0.0;
    for (int k = 0; k < rounds; ++k) {
      for (int tick = 0; tick < round; ++tick) {
        step(rig.model, on_the_round(scene, tick, round), rig.state);
        most_n = std::max(most_n, rig.force_n().norm());
      }
      if (k == 1) first = rig.hash();
      if (k > 1) {
        ASSERT_EQ(rig.hash(), first) << "round " << k;
      }
    }
    EXPECT_GT(most_n, 0.01);
  }
}

}  // namespace
}  // namespace touchstone::fast
