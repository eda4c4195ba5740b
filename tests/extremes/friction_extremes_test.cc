// The extremes: friction that never slips, always slips or is zero, and the work of friction.
#include "extremes/rig.h"

#include <numbers>
#include <random>

namespace touchstone::fast {
namespace {

using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

scene::Scene rubbing(scene::Scene scene, const scene::Friction& friction) {
  scene.contact.friction = friction;
  return scene;
}

/// Pressed in and moved along x.
void drag(Rig& rig, double depth_m, double way_m, int ticks = 20) {
  rig.to(test::pressed(-0.001));
  for (int i = 0; i <= ticks && !rig.broken(); ++i) rig.to(test::pressed(depth_m, way_m * i / ticks));
}

// K = 0: no friction to 1e-12, and the stretch is 0 in every tick. As printed: f_max = 0 makes the "impossible case"
// F_n = f_max / mu_D = 0: the tool falls through the face (E5).
TEST(FrictionExtremes, KOfZeroIsFrictionless) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene plain = extremes::cube(formulation);
    Rig without(plain), with(rubbing(plain, {0.0, 0.75, 0.4}));
    for (Rig* rig : {&without, &with}) {
      rig->may = StepStatus::anchors_limited;
      drag(*rig, 0.002, 0.01);
    }
    if (formulation == Formulation::corrected) {
      EXPECT_LE((with.force_n() - without.force_n()).norm(), 1e-12 * without.force_n().norm());
      EXPECT_EQ(with.region().friction.stretch_m, Vec3::Zero());
    } else {
      EXPECT_EQ(with.force_n(), Vec3::Zero());
    }
  }
}

// mu_D = 0: once it slips there is no friction, and the normal force is that without friction. As printed: F_n keeps
// the depths as stretched at the onset (E5).
TEST(FrictionExtremes, MuOfZeroSlipsWithoutFriction) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene plain = extremes::cube(formulation);
    Rig without(plain), with(rubbing(plain, {0.2, 0.75, 0.0}));
    for (Rig* rig : {&without, &with}) {
      rig->may = StepStatus::anchors_limited;
      drag(*rig, 0.002, 0.01);
    }
    EXPECT_TRUE(with.region().friction.sliding);
    EXPECT_EQ(with.region().force.tangential_n.norm(), 0.0);
    if (formulation == Formulation::corrected) {
      EXPECT_LE((with.force_n() - without.force_n()).norm(), 1e-12 * without.force_n().norm());
    } else {
      EXPECT_GE(with.force_n().norm(), without.force_n().norm());
    }
  }
}

// f_max going to 0: the force goes to that without friction; the difference is at most what f_max allows. As printed:
// The normal force goes to 0 with f_max, since F_n = f_max / mu_D (E5).
TEST(FrictionExtremes, VanishingLimitConvergesToTheFrictionlessForce) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene plain = extremes::cube(formulation);
    Rig without(plain);
    without.may = StepStatus::anchors_limited;
    drag(without, 0.002, 0.01);
    const Vec3 plain_n = without.force_n();
    for (double K = 1e-1; K > 1e-15; K /= 100.0) {
      Rig with(rubbing(plain, {K, 0.75, 0.4}));
      with.may = StepStatus::anchors_limited;
      drag(with, 0.002, 0.01);
      const double f_max_n = K * std::pow(plain_n.norm(), 0.75);
      if (formulation == Formulation::corrected) {
        EXPECT_LE((with.force_n() - plain_n).norm(), 1.5 * f_max_n + 1e-12 * plain_n.norm()) << K;
      } else {
        EXPECT_LE(with.region().force.normal_n, 2.0 * f_max_n / 0.4) << K;
      }
    }
  }
}

// The largest K that a scene may have: never slips, and 1e3 ticks back and forth end where they began to 1e-12. As
// printed: The same: with Table I's K alone, f_max is 4 to 13 times F_n (E5).
TEST(FrictionExtremes, HugeKNeverSlips) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(rubbing(extremes::cube(formulation), {1e6, 0.75, 0.4}));
    rig.may = StepStatus::anchors_limited;
    rig.to(test::pressed(-0.001));
    rig.to(test::pressed(0.002));
    const Vec3 start_n = rig.force_n();
    for (int i = 1; i <= 1000; ++i) {
      step_force(rig.model, test::pressed(0.002, 0.003 * std::sin(2.0 * std::numbers::pi * i / 100.0)), rig.state);
      ASSERT_FALSE(rig.region().friction.sliding);
    }
    rig.to(test::pressed(0.002));
    EXPECT_LE((rig.force_n() - start_n).norm(), 1e-12 * start_n.norm());
  }
}

// A sticking contact a thousand times softer or stiffer along the surface than normal to it: slips late or at once,
// always with friction mu_D F_n. As printed: There is no such constant.
TEST(FrictionExtremes, StiffnessRatioOverSixDecades) {
  for (const double kappa : {1e-3, 1.0, 1e3}) {
    Rig rig(rubbing(extremes::cube(Formulation::corrected), {1.0, 1.0, 0.4, kappa}));
    rig.may = StepStatus::anchors_limited;
    drag(rig, 0.002, 0.0001);
    EXPECT_EQ(rig.region().friction.sliding, kappa > 1.0) << kappa;
    drag(rig, 0.002, 0.01, 1000);
    const double friction_n = rig.region().force.tangential_n.norm(), normal_n = rig.region().force.normal_n;
    EXPECT_EQ(rig.region().friction.sliding, kappa >= 1.0) << kappa;
    if (kappa >= 1.0) {
      EXPECT_NEAR(friction_n, 0.4 * normal_n, 1e-9 * normal_n) << kappa;
    } else {
      EXPECT_NEAR(friction_n / normal_n, kappa * 0.01 / rig.region().displacement_m.dot(rig.region().d),
                  0.05 * friction_n / normal_n);
    }
  }
}

// A limit far below mu_D F_n: the friction is limited to f_max, and the normal force is unchanged. As printed: The
// "impossible case": F_n is replaced by f_max / mu_D, which changes the next f_max (E5).
TEST(FrictionExtremes, DynamicFrictionAboveTheStaticLimit) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene plain = extremes::cube(formulation);
    Rig without(plain), with(rubbing(plain, {0.1, 0.75, 1.0}));
    for (Rig* rig : {&without, &with}) {
      rig->may = StepStatus::anchors_limited;
      drag(*rig, 0.002, 0.01);
    }
    ASSERT_LT(with.model.friction->bound_n(), without.force_n().norm());
    const double normal_n = with.region().force.normal_n;
    if (formulation == Formulation::corrected) {
      EXPECT_NEAR(with.region().force.tangential_n.norm() / with.model.friction->limit_n(normal_n), 1.0, 1e-9);
      EXPECT_NEAR(normal_n / without.force_n().norm(), 1.0, 0.05);
    } else {
      EXPECT_LT(normal_n, 0.5 * without.force_n().norm());
    }
  }
}

/// Work of the tool on the body along a closed path over the face, always in contact [J]; and the sum of force times
/// path, for comparison.
struct Work {
  double net_j = 0.0, turned_over_j = 0.0;
};
Work closed_path(Rig& rig, unsigned seed, double swell_m) {
  constexpr int ticks = 300;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Eigen::Array<double, 3, 4> amplitude_m, phase;
  for (double& a : amplitude_m.reshaped()) a = 0.002 * uniform(random);
  for (double& p : phase.reshaped()) p = std::numbers::pi * uniform(random);
  const auto pose_at = [&](int i) {
    const double t = 2.0 * std::numbers::pi * i / ticks;
    Vec3 p_m(0.0, 0.0, 0.0675);
    for (int k = 0; k < 4; ++k) {
      const Eigen::Array3d wave = amplitude_m.col(k) * ((k + 1) * t + phase.col(k)).sin();
      p_m += Vec3(wave.x(), wave.y(), swell_m / 0.002 * wave.z());
    }
    return scene::Pose{p_m, Eigen::Quaterniond::Identity()};
  };
  // One round in advance, so that the state is periodic, too.
  rig.to({pose_at(0).position_m + Vec3(0, 0, 0.02), Eigen::Quaterniond::Identity()});
  for (int i = 0; i <= ticks; ++i) step_force(rig.model, pose_at(i), rig.state);
  Work work;
  Vec3 before_n = rig.force_n(), before_m = pose_at(0).position_m;
  for (int i = 1; i <= ticks; ++i) {
    const Vec3 here_m = pose_at(i).position_m;
    step_force(rig.model, pose_at(i), rig.state);
    const double way_j = -0.5 * (rig.force_n() + before_n).dot(here_m - before_m);
    work.net_j += way_j;
    work.turned_over_j += std::abs(way_j);
    before_n = rig.force_n();
    before_m = here_m;
  }
  rig.to(pose_at(ticks));
  return work;
}

// Random closed paths over the face at one depth, several rounds: friction never gives work back, whatever its
// constants. As printed: Slip is opposite to the motion, so friction takes work; at the onset the force jumps (E5).
TEST(FrictionExtremes, ClosedPathsAtOneDepthDissipate) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const double K : {1e-3, 0.3, 1e6}) {
      scene::Scene scene = rubbing(extremes::cube(formulation), {K, 0.75, std::min(0.4, K)});
      scene.fast.tool_samples = 300;
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      for (unsigned seed = 0; seed < 2; ++seed) {
        const Work work = closed_path(rig, seed, 0.0);
        EXPECT_GE(work.net_j, -1e-4 * work.turned_over_j) << "K = " << K << ", seed " << seed;
        if (K < 1.0) {
          EXPECT_GE(work.net_j, 0.5 * work.turned_over_j);
        }
      }
    }
  }
}

// Random closed paths over the face with a varying depth: a flat punch gains no work; a ball that never slips gains
// less than 1 % of the exchanged work, since its equivalent depth is a mean. As printed: The same.
TEST(FrictionExtremes, ClosedPathsWithVaryingDepth) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const bool flat : {true, false}) {
      for (const double K : {1e-3, 0.3, 1e6}) {
        scene::Scene scene = flat ? extremes::punch_on_cube(formulation) : extremes::cube(formulation);
        scene = rubbing(scene, {K, 0.75, std::min(0.4, K)});
        scene.fast.tool_samples = 300;
        Rig rig(scene);
        rig.may = StepStatus::anchors_limited;
        for (unsigned seed = 0; seed < 2; ++seed) {
          const Work work = closed_path(rig, seed, 0.0005);
          EXPECT_GE(work.net_j, (flat || K < 1.0 ? -1e-4 : -0.01) * work.turned_over_j)
              << "K = " << K << ", seed " << seed;
        }
      }
    }
  }
}

// Reversal after a slip: the contact sticks, and the force changes by at most the law's slope times the step. As
// printed: The friction changes its sign at once (E5).
TEST(FrictionExtremes, ReversalIsContinuous) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(rubbing(extremes::cube(formulation), {3.0, 0.75, 0.4}));
    rig.may = StepStatus::anchors_limited;
    drag(rig, 0.002, 0.01, 100);
    ASSERT_TRUE(rig.region().friction.sliding);
    const double friction_n = rig.region().force.tangential_n.norm();
    const auto turned_over = [&](double step_m) {
      const Vec3 before_n = rig.force_n();
      rig.to(test::pressed(0.002, 0.01 - step_m));
      return (rig.force_n() - before_n).norm();
    };
    const double jump_n = turned_over(1e-9);
    if (formulation == Formulation::corrected) {
      const double D = rig.region().displacement_m.norm();
      EXPECT_LE(jump_n, 2.0 * rig.law().slope_n_per_m(D) * 1e-9);
      EXPECT_FALSE(rig.region().friction.sliding);
    } else {
      EXPECT_NEAR(jump_n / friction_n, 2.0, 0.1);
    }
  }
}

// A step of length zero, and one of 1e-300 m: the same force and stretch, sticking or slipping. As printed: A step of
// zero has no direction (E5); here it keeps the last one.
TEST(FrictionExtremes, StepOfZeroChangesNothing) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const double K : {0.2, 1e6}) {
      Rig rig(rubbing(extremes::cube(formulation), {K, 0.75, 0.1}));
      rig.may = StepStatus::anchors_limited;
      drag(rig, 0.002, 0.004);
      rig.to(test::pressed(0.002, 0.004));
      const Vec3 force_n = rig.force_n(), stretch_m = rig.region().friction.stretch_m;
      for (const double y_m : {0.0, 1e-300, 0.0}) {
        rig.to(test::pressed(0.002, 0.004, y_m));
        EXPECT_LE((rig.force_n() - force_n).norm(), 1e-290);
        EXPECT_LE((rig.region().friction.stretch_m - stretch_m).norm(), 1e-290);
      }
    }
  }
}

// A punch moved along the face at depths from 1e-15 m to 10 mm: friction within its limit, and with beta = 1 it slips
// at every depth. As printed: F_n = f_max / mu_D exceeds the limit of the new F_n (E5); here only finite and not
// adhesive.
TEST(FrictionExtremes, EveryDepthKeepsTheLimit) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Friction& friction : {scene::Friction{0.6, 2.0 / 3.0, 0.5}, scene::Friction{0.6, 1.0, 0.6}}) {
      scene::Scene scene = rubbing(extremes::punch_on_cube(formulation), friction);
      for (double depth_m = 1e-15; depth_m < 0.02; depth_m *= 10.0) {
        Rig rig(scene);
        rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
        rig.to(extremes::punched(-0.001));
        for (int i = 0; i <= 20; ++i) rig.to(extremes::punched(depth_m, std::min(0.001, depth_m) * i));
        ASSERT_TRUE(rig.state.in_contact());
        if (formulation == Formulation::corrected && friction.beta == 1.0) {
          EXPECT_TRUE(rig.region().friction.sliding) << depth_m;
          EXPECT_GT(rig.region().force.tangential_n.norm(), 0.0);
        }
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
