#include "fast/skeleton/beam_stress.h"

#include "support/press.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Mat3;
using scene::Vec3;

struct StressedCube {
  scene::Scene scene = test::ball_on_cube();
  scene::Box box{Vec3(0.0, 0.0, 0.03), scene.body.size_m};
  BoxAnchors anchors{box};
  BeamSkeleton skeleton = beam_skeleton(anchors, scene);
  BeamEnds ends{8};
  std::vector<BeamStress> stress{8};
};

/// Shear stresses tau_xy and tau_xz on a disc under a unit F_y, by the printed form with the bending function that
/// beam_stress.h states.
Eigen::Vector2d shear(double y, double z, double radius, double nu) {
  const double I = std::numbers::pi * std::pow(radius, 4) / 4.0, c = 1.0 / (2.0 * (1.0 + nu) * I);
  const double phi_y = (3.0 + 2.0 * nu) * radius * radius / 4.0 + (1.0 + 2.0 * nu) * (y * y - z * z) / 4.0;
  const double phi_z = -(1.0 + 2.0 * nu) * y * z / 2.0;
  return {c * (phi_y + nu * z * z - (1.0 + nu) * y * y), c * phi_z};
}

TEST(BeamStress, TheBendingFunctionOfADiscLeavesItsRimFreeAndCarriesTheForce) {
  const double R = 0.003;
  for (const double nu : {0.0, 0.3, 0.5}) {
    const double mean = 1.0 / (std::numbers::pi * R * R);
    for (double angle = 0.0; angle < 6.3; angle += 0.1) {
      const Eigen::Vector2d normal(std::cos(angle), std::sin(angle));
      EXPECT_NEAR(shear(R * normal.x(), R * normal.y(), R, nu).dot(normal) / mean, 0.0, 1e-12);
    }
    // Equilibrium inside: d tau_xy / dy + d tau_xz / dz = -d sigma_x / dx = -y / I.
    const double I = std::numbers::pi * std::pow(R, 4) / 4.0, y = 0.3 * R, z = -0.5 * R, h = 1e-4 * R;
    const double divergence = (shear(y + h, z, R, nu).x() - shear(y - h, z, R, nu).x() + shear(y, z + h, R, nu).y() -
                               shear(y, z - h, R, nu).y()) /
                              (2.0 * h);
    EXPECT_NEAR(divergence, -y / I, 1e-6 * std::abs(y / I));
    double force = 0.0;
    constexpr int n = 400;
    for (int i = 0; i < n; ++i) {
      const double r = (i + 0.5) * R / n;
      for (int k = 0; k < n; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / n;
        force += shear(r * std::cos(angle), r * std::sin(angle), R, nu).x() * r * (R / n) * 2.0 * std::numbers::pi / n;
      }
    }
    EXPECT_NEAR(force, 1.0, 1e-4);
    EXPECT_NEAR(shear(0.0, 0.0, R, nu).x() / mean, centre_shear_factor(nu), 1e-12);
  }
}

TEST(BeamStress, InverseElasticityIsSymmetricAndRightUpToIncompressible) {
  for (const double nu : {0.0, 0.33, 0.5}) {
    const double E = 3.0e6;
    const auto D = inverse_elasticity_per_pa(E, nu);
    EXPECT_EQ(D, D.transpose());
    // Uniaxial tension, hydrostatic pressure and pure shear.
    const Eigen::Matrix<double, 6, 1> pull{1.0, 0, 0, 0, 0, 0}, press{-1.0, -1.0, -1.0, 0, 0, 0},
        turn{0, 0, 0, 1.0, 0, 0};
    EXPECT_NEAR((D * pull)(0), 1.0 / E, 1e-20);
    EXPECT_NEAR((D * pull)(1), -nu / E, 1e-20);
    EXPECT_NEAR((D * press).head<3>().sum(), -3.0 * (1.0 - 2.0 * nu) / E, 1e-20);
    EXPECT_NEAR((D * turn)(3), 2.0 * (1.0 + nu) / E, 1e-20);
  }
  // (9) is the inverse of this.
  const double E = 3.0e6, nu = 0.3, lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), G = E / (2 * (1 + nu));
  Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
  stiffness.topLeftCorner<3, 3>().setConstant(lambda);
  stiffness.diagonal() += (Eigen::Matrix<double, 6, 1>() << 2 * G, 2 * G, 2 * G, G, G, G).finished();
  EXPECT_LT((stiffness * inverse_elasticity_per_pa(E, nu) - Eigen::Matrix<double, 6, 6>::Identity()).norm(), 1e-12);
}

TEST(BeamStress, BelongsToTheForcesOfTheSplit) {
  for (const SplitForce split : {split_force_published, split_force_corrected}) {
    StressedCube cube;
    const Vec3 F(0.4, -0.3, -3.0);
    split(cube.skeleton, Vec3(0.008, -0.011, 0.06), F, 0.001 * F, cube.ends);
    beam_stresses(cube.skeleton, cube.ends, cube.stress);
    for (std::size_t i = 0; i < 8; ++i) {
      const BeamStress& end = cube.stress[i];
      const double s = cube.skeleton.area_m2[i];
      const Vec3 x = cube.ends.beam[i].x;
      EXPECT_LT((end.axes.transpose() * end.axes - Mat3::Identity()).norm(), 1e-12);
      EXPECT_NEAR(end.axes.determinant(), 1.0, 1e-12);
      // Traction on the section: F_x / s along, and the stress of F_y at the centre across.
      const Vec3 F_x = cube.ends.force_n[i].dot(x) * x, F_y = cube.ends.force_n[i] - F_x;
      const Vec3 traction = end.stress_W_pa * x;
      EXPECT_LT((traction - F_x / s - centre_shear_factor(0.5) * F_y / s).norm(), 1e-10 * traction.norm());
      // Directions that the section does not load are free of stress.
      const Vec3 z = end.axes.col(2);
      EXPECT_LT((end.stress_W_pa * z).norm(), 1e-10 * traction.norm());
      EXPECT_LT((end.stress_W_pa - end.stress_W_pa.transpose()).norm(), 1e-12 * traction.norm());
      // Strain by Hooke's law in the world frame, independent of the beam's: at nu = 0.5 it keeps the volume.
      const double E = 3.0e6, nu = 0.5;
      const Mat3 hooke = (1.0 + nu) / E * end.stress_W_pa - nu / E * end.stress_W_pa.trace() * Mat3::Identity();
      EXPECT_LT((end.strain_W - hooke).norm(), 1e-12 * hooke.norm());
      EXPECT_NEAR(end.strain_W.trace(), 0.0, 1e-12 * hooke.norm());
    }
  }
}

TEST(BeamStress, PressedBeamsAreUnderPressure) {
  StressedCube cube;
  split_force_corrected(cube.skeleton, Vec3(0.0, 0.0, 0.06), Vec3(0, 0, -3.0), Vec3(0, 0, -0.01), cube.ends);
  beam_stresses(cube.skeleton, cube.ends, cube.stress);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(cube.stress[i].stress_pa[0], 0.0);  // those to the bottom
}

TEST(BeamStress, SurvivesBeamsWithoutForceAndForcesAlongABeam) {
  StressedCube cube;
  split_force_corrected(cube.skeleton, Vec3(0.0, 0.0, 0.06), Vec3::Zero(), Vec3::Zero(), cube.ends);
  beam_stresses(cube.skeleton, cube.ends, cube.stress);
  for (const BeamStress& end : cube.stress) {
    EXPECT_EQ(end.stress_W_pa, Mat3::Zero());
    EXPECT_NEAR(end.axes.determinant(), 1.0, 1e-12);
  }
  for (std::size_t i = 0; i < 8; ++i) cube.ends.force_n[i] = -2.0 * cube.ends.beam[i].x;
  beam_stresses(cube.skeleton, cube.ends, cube.stress);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(cube.stress[i].axes.determinant(), 1.0, 1e-12);
    EXPECT_NEAR(cube.stress[i].stress_pa[0], -2.0 / cube.skeleton.area_m2[i], 1e-6);
    EXPECT_NEAR(cube.stress[i].stress_pa[3], 0.0, 1e-6);
  }
}

TEST(InterpolatedStress, IsTheAnchorsOwnAtAnAnchorAndTheirMeanInTheMiddle) {
  StressedCube cube;
  split_force_corrected(cube.skeleton, Vec3(0.008, -0.011, 0.06), Vec3(0.4, -0.3, -3.0), Vec3(0, 0, -0.01), cube.ends);
  beam_stresses(cube.skeleton, cube.ends, cube.stress);
  const auto& top = cube.anchors.patches()[5];
  const Mat3 corner = interpolated_stress_pa(cube.stress, top, cube.anchors.at(5, cube.anchors.points_m()[7]));
  EXPECT_LT((corner - cube.stress[7].stress_W_pa).norm(), 1e-9);
  const Mat3 middle = interpolated_stress_pa(cube.stress, top, cube.anchors.at(5, Vec3(0.0, 0.0, 0.06)));
  Mat3 mean = Mat3::Zero();
  for (const std::size_t i : {4u, 5u, 6u, 7u}) mean += 0.25 * cube.stress[i].stress_W_pa;
  EXPECT_LT((middle - mean).norm(), 1e-12 * mean.norm());
}

TEST(StressForce, IsTheTractionOverTheRegion) {
  const double p = 2.0e4;
  EXPECT_LT((stress_force_n(-p * Mat3::Identity(), Vec3::UnitZ(), 1e-4) - Vec3(0, 0, -2.0)).norm(), 1e-12);
  Mat3 shear_only = Mat3::Zero();
  shear_only(0, 2) = shear_only(2, 0) = p;
  EXPECT_LT((stress_force_n(shear_only, Vec3::UnitZ(), 1e-4) - Vec3(2.0, 0, 0)).norm(), 1e-12);
}

}  // namespace
}  // namespace touchstone::fast
