// The extremes: poses that are mirrored, rotated or moved, and must have mirrored, rotated or equal forces.
#include "extremes/rig.h"

namespace touchstone::fast {
namespace {

using extremes::Rig;
using scene::Formulation;
using scene::Vec3;

/// The force at the end of a straight press to this depth.
Vec3 force_at(const scene::Scene& scene, double depth_m, double x_m, double y_m,
              const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity()) {
  Rig rig(scene);
  rig.may = StepStatus::anchors_limited | StepStatus::depth_limited;
  for (const double share : {-0.2, 0.5, 1.0}) {
    scene::Pose pose = test::pressed(share * depth_m, x_m, y_m);
    pose.orientation = turn;
    rig.to(pose);
  }
  return rig.force_n();
}

// Mirrored at the symmetry planes of the cube: a mirrored force, to 2 %, since the samples of a ball are not mirrored.
// As printed: The same, if the tool's mesh is mirrored, too.
TEST(SymmetryExtremes, MirroredPlaces) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene scene = extremes::cube(formulation);
    const Vec3 one_n = force_at(scene, 0.004, 0.028, 0.011);
    ASSERT_GT(one_n.norm(), 0.0);
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        const Vec3 other_n = force_at(scene, 0.004, 0.028 * x, 0.011 * y);
        EXPECT_LE((other_n - Vec3(x * one_n.x(), y * one_n.y(), one_n.z())).norm(), 0.02 * one_n.norm()) << x << y;
      }
    }
  }
}

// Rotated by right angles about the cube's axis: the same force rotated, to 1e-9, since the samples have this symmetry.
// As printed: The same, if the tool's mesh has this symmetry.
TEST(SymmetryExtremes, QuarterTurns) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene scene = extremes::cube(formulation);
    const Vec3 one_n = force_at(scene, 0.004, 0.028, 0.011);
    const Vec3 turned_n = force_at(scene, 0.004, -0.011, 0.028);
    const Vec3 back_n = force_at(scene, 0.004, -0.028, -0.011);
    EXPECT_LE((turned_n - Vec3(-one_n.y(), one_n.x(), one_n.z())).norm(), 1e-9 * one_n.norm());
    EXPECT_LE((back_n - Vec3(-one_n.x(), -one_n.y(), one_n.z())).norm(), 1e-9 * one_n.norm());
  }
}

// Tool and pose rotated together about the axis of an axisymmetric body, by any angle: the same force rotated, to 1e-9.
// As printed: The same on a smooth body; a mesh has no such symmetry.
TEST(SymmetryExtremes, AnyRotationOfAnAxisymmetricBody) {
  IN_BOTH_FORMULATIONS(formulation) {
    Vec3 first_n = Vec3::Zero();
    for (const double angle : {0.0, 0.1, 1.0, 2.5, 6.0}) {
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
      Rig rig(extremes::ball(formulation));
      rig.may = StepStatus::anchors_limited;
      for (const double depth_m : {-0.001, 0.003}) {
        const Vec3 from = Vec3(1.0, 0.0, 2.0).normalized();
        rig.to({turn * (Vec3(0.0, 0.0, 0.03) + (0.04 - depth_m) * from), turn});
      }
      const Vec3 force_n = turn.inverse() * rig.force_n();
      if (angle == 0.0) first_n = force_n;
      ASSERT_GT(force_n.norm(), 0.0);
      EXPECT_LE((force_n - first_n).norm(), 1e-9 * first_n.norm()) << angle;
    }
  }
}

// A ball in any orientation: the same force, up to the effect of the samples. As printed: The same, up to the effect of
// the vertices.
TEST(SymmetryExtremes, AnyRotationOfABall) {
  IN_BOTH_FORMULATIONS(formulation) {
    scene::Scene scene = extremes::cube(formulation);
    scene.fast.tool_samples = 20000;
    const Vec3 upright_n = force_at(scene, 0.004, 0.003, 0.005);
    for (const Vec3& axis : {Vec3(1.0, 0.0, 0.0), Vec3(1.0, 2.0, 3.0), Vec3(0.0, 1.0, -5.0)}) {
      for (const double angle : {0.3, 1.0, 3.1}) {
        const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, axis.normalized()));
        EXPECT_LE((force_at(scene, 0.004, 0.003, 0.005, turn) - upright_n).norm(), 0.03 * upright_n.norm()) << angle;
      }
    }
  }
}

// Moved along the middle of a wide face: the same force, independent of edges that are far away. As printed: The same.
TEST(SymmetryExtremes, PlacesOnAFace) {
  IN_BOTH_FORMULATIONS(formulation) {
    const scene::Scene scene = extremes::cube(formulation);
    const Vec3 middle_n = force_at(scene, 0.003, 0.0, 0.0);
    for (const double x_m : {-0.015, -1e-9, 1e-12, 0.0123}) {
      EXPECT_LE((force_at(scene, 0.003, x_m, 0.5 * x_m) - middle_n).norm(), 1e-9 * middle_n.norm()) << x_m;
    }
  }
}

// Along the face and back without friction: the same forces, to 1e-9. As printed: The same.
TEST(SymmetryExtremes, ThereAndBack) {
  IN_BOTH_FORMULATIONS(formulation) {
    Rig rig(extremes::cube(formulation));
    rig.may = StepStatus::anchors_limited;
    constexpr int ticks = 40;
    std::vector<Vec3> there_n;
    rig.to(test::pressed(-0.001));
    for (int i = 0; i <= 2 * ticks; ++i) {
      const int at = i <= ticks ? i : 2 * ticks - i;
      rig.to(test::pressed(0.003, 0.0003 * at, 0.0001 * at));
      if (i <= ticks) there_n.push_back(rig.force_n());
      const Vec3& first_n = there_n[static_cast<std::size_t>(at)];
      EXPECT_LE((rig.force_n() - first_n).norm(), 1e-9 * first_n.norm()) << at;
    }
  }
}

// A press straight down the axis: no lateral force and no torque, to 1e-9 of the normal force. As printed: The same, if
// the tool's mesh is mirrored at both planes.
TEST(SymmetryExtremes, NoLateralForce) {
  IN_BOTH_FORMULATIONS(formulation) {
    for (const scene::Scene& scene : {extremes::cube(formulation), extremes::punch_on_cube(formulation)}) {
      Rig rig(scene);
      rig.may = StepStatus::anchors_limited;
      for (const double depth_m : {-0.001, 0.001, 0.004}) rig.to(extremes::in(scene, depth_m));
      const Vec3 force_n = rig.force_n(), torque_nm = rig.region().force.torque_nm;
      ASSERT_GT(force_n.z(), 0.0);
      EXPECT_LE(force_n.head<2>().norm(), 1e-9 * force_n.z());
      EXPECT_LE(torque_nm.norm(), 1e-9 * force_n.z() * 0.01);
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
