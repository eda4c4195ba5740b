// The closed form of a point load against the equations that it must satisfy.
#include "scene/response/point_load.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::scene {
namespace {

const Vec3 normal = Vec3(0.3, -0.5, 0.8).normalized();
const PointLoad load{Vec3(0.01, -0.02, 0.03), normal, 7.0, 5.0 * normal.unitOrthogonal(), 0.04};

Mat3 strain(const Material& material, const Vec3& x_m) {
  const double e_m = 1e-7;
  Mat3 gradient;
  for (int i = 0; i < 3; ++i) {
    const Vec3 step_m = e_m * Vec3::Unit(i);
    gradient.col(i) = (half_space_displacement_m(load, material, x_m + step_m) -
                       half_space_displacement_m(load, material, x_m - step_m)) /
                      (2.0 * e_m);
  }
  return 0.5 * (gradient + gradient.transpose());
}

TEST(PointLoad, StressIsThatOfTheDisplacement) {
  const Vec3 x_m = load.point_m - 0.02 * load.normal + Vec3(0.004, 0.007, -0.002);
  for (const double nu : {0.0, 0.3, 0.499}) {
    const Material material{3.0e6, nu};
    const Mat3 eps = strain(material, x_m);
    const Mat3 sigma =
        2.0 * material.shear_modulus_pa() * eps +
        (material.bulk_modulus_pa() - 2.0 / 3.0 * material.shear_modulus_pa()) * eps.trace() * Mat3::Identity();
    const Mat3 stress_pa = half_space_stress_pa(load, material, x_m);
    EXPECT_LT((sigma - stress_pa).norm(), 1e-5 * stress_pa.norm()) << nu;
  }
  // Incompressible: the deviator, and no change of volume.
  const Material rubber{3.0e6, 0.5};
  const Mat3 eps = strain(rubber, x_m), stress_pa = half_space_stress_pa(load, rubber, x_m);
  const Mat3 deviator_pa = stress_pa - stress_pa.trace() / 3.0 * Mat3::Identity();
  EXPECT_LT(std::abs(eps.trace()), 1e-7 * eps.norm());
  EXPECT_LT((2.0 * rubber.shear_modulus_pa() * eps - deviator_pa).norm(), 1e-6 * deviator_pa.norm());
}

TEST(PointLoad, HalfBallsAroundItCarryIt) {
  // The traction of any half ball about the load is the load, to which the double force adds nothing; the plane is
  // free.
  for (const double nu : {0.0, 0.3, 0.5}) {
    const Vec3 first = load.normal.unitOrthogonal(), second = load.normal.cross(first);
    Vec3 sum_n = Vec3::Zero();
    const double R_m = 0.013;
    const int steps = 200;
    for (int i = 0; i < steps; ++i) {
      const double theta = 0.5 * std::numbers::pi * (i + 0.5) / steps;
      for (int j = 0; j < 12; ++j) {
        const double phi = 2.0 * std::numbers::pi * j / 12;
        const Vec3 out =
            std::sin(theta) * (std::cos(phi) * first + std::sin(phi) * second) - std::cos(theta) * load.normal;
        const double area_m2 =
            R_m * R_m * std::sin(theta) * 0.5 * std::numbers::pi / steps * 2.0 * std::numbers::pi / 12;
        sum_n += half_space_stress_pa(load, {3.0e6, nu}, load.point_m + R_m * out) * out * area_m2;
      }
    }
    EXPECT_LT((sum_n - load.force_n * load.normal + load.along_n).norm(), 1e-4 * load.force_n) << nu;
    const Vec3 on_plane_m = load.point_m + 0.02 * first;
    EXPECT_LT((half_space_stress_pa(load, {3.0e6, nu}, on_plane_m) * load.normal).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace touchstone::scene
