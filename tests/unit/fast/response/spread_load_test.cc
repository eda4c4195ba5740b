// Displacement under a patch of pressure: against point loads summed over the patch, and closed forms on the surface.
#include "fast/response/spread_load.h"

#include "scene/response/point_load.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

const Vec3 normal = Vec3(0.2, -0.3, 0.9).normalized(), center_m(0.01, 0.02, 0.05);

/// By point loads on rings of the patch, total force 1 against the normal or else along the surface: of the ball's
/// distribution, of the punch's.
Vec3 summed_m(const scene::Material& material, double a, double flat, const Vec3& x_m,
              const Vec3& along = Vec3::Zero()) {
  const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
  const int rings = 400, around = 64;
  Vec3 sum_m = Vec3::Zero();
  for (int i = 0; i < rings; ++i) {
    // Radii r = a sqrt(1 - s^2): the punch's pressure is even in s, the ball's 3 s^2.
    const double s = (i + 0.5) / rings, r = a * std::sqrt(1.0 - s * s);
    const double force_n = ((1.0 - flat) * 3.0 * s * s + flat) / rings / around;
    for (int j = 0; j < around; ++j) {
      const double phi = 2.0 * std::numbers::pi * (j + 0.5 * (i % 2)) / around;
      const Vec3 at_m = center_m + r * (std::cos(phi) * first + std::sin(phi) * second);
      const double against_n = along.isZero(0.0) ? force_n : 0.0;
      sum_m += scene::half_space_displacement_m({at_m, normal, against_n, force_n * along}, material, x_m);
    }
  }
  return sum_m;
}

TEST(SpreadLoad, IsASumOfPointLoads) {
  const Vec3 side = normal.unitOrthogonal();
  const double a = 0.004;
  for (const double nu : {0.0, 0.3, 0.5}) {
    const scene::Material material{3.0e6, nu};
    for (const double flat : {0.0, 0.4, 1.0}) {
      const SpreadLoad load{center_m, normal, 1.0, a, flat};
      for (const auto& [r, z] : {std::pair(0.0, 0.002),
                                 {0.001, 0.003},
                                 {0.003, 0.001},
                                 {0.006, 0.0},
                                 {0.005, 0.004},
                                 {0.0, 0.02},
                                 {0.012, 0.002}}) {
        const Vec3 x_m = center_m + r * side - z * normal;
        const Vec3 expected_m = summed_m(material, a, flat, x_m);
        const Vec3 found_m = spread_displacement_m(load, HalfSpace(material), x_m);
        EXPECT_LT((found_m - expected_m).norm(), 2e-3 * expected_m.norm()) << nu << ' ' << flat << ' ' << r << ' ' << z;
      }
    }
  }
}

TEST(SpreadLoad, ShearIsASumOfPointLoads) {
  const Vec3 side = normal.unitOrthogonal(), along = (side + 0.7 * normal.cross(side)).normalized();
  const double a = 0.004;
  for (const double nu : {0.0, 0.3, 0.5}) {
    const scene::Material material{3.0e6, nu};
    const HalfSpace half_space(material);
    for (const double flat : {0.0, 1.0}) {
      SpreadLoad load{center_m, normal, 0.0, a, 0.0};
      (flat == 0.0 ? load.ball_shear_n : load.punch_shear_n) = along;
      for (const auto& [r, z] : {std::pair(0.0, 0.002), {0.001, 0.003}, {0.003, 0.001}, {0.006, 0.0}, {0.005, 0.004}}) {
        const Vec3 x_m = center_m + r * side - z * normal;
        const Vec3 expected_m = summed_m(material, a, flat, x_m, along);
        const Vec3 found_m = spread_displacement_m(load, half_space, x_m);
        EXPECT_LT((found_m - expected_m).norm(), 2e-3 * expected_m.norm()) << nu << ' ' << flat << ' ' << r << ' ' << z;
      }
      // The punch's moves its face as a whole; a ball's middle moves by Mindlin's.
      const double G = material.shear_modulus_pa(), stuck_m = (2.0 - nu) / (8.0 * G * a);
      const double middle_m = flat == 1.0 ? stuck_m : 1.5 * stuck_m;
      EXPECT_LT((spread_displacement_m(load, half_space, center_m) - middle_m * along).norm(), 1e-6 * middle_m);
      const Vec3 inside_m = center_m + 0.6 * a * side;
      if (flat == 1.0) {
        EXPECT_LT((spread_displacement_m(load, half_space, inside_m) - middle_m * along).cross(normal).norm(),
                  1e-6 * middle_m);
      }
      // The loop, from the near vertices on.
      Columns3 rest_m, out_m;
      for (std::size_t axis = 0; axis < 3; ++axis) rest_m[axis].clear();
      std::vector<Vec3> places_m;
      for (const double z : {0.0, 0.004, 0.02}) {
        for (const double r : {0.013, 0.02, 0.05}) places_m.emplace_back(center_m + r * side - z * normal);
      }
      for (const Vec3& x_m : places_m) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          rest_m[axis].push_back(static_cast<float>(x_m[static_cast<Eigen::Index>(axis)]));
        }
      }
      out_m = rest_m;
      std::vector<std::int32_t> near(places_m.size());
      EXPECT_EQ(spread_displacements_m(load, half_space, rest_m, out_m, near.data()), 0);
      for (std::size_t i = 0; i < places_m.size(); ++i) {
        const Vec3 expected_m = spread_displacement_m(load, half_space, places_m[i]);
        const Vec3 found_m(out_m[0][i], out_m[1][i], out_m[2][i]);
        EXPECT_LT((found_m - expected_m).norm(), 2e-3 * expected_m.norm()) << nu << ' ' << flat << ' ' << i;
      }
    }
  }
}

TEST(SpreadLoad, HertzAndThePunchOnTheSurface) {
  const Vec3 side = normal.unitOrthogonal();
  const double a = 0.004, E_star_pa = 4.0e6;
  const HalfSpace rubber({3.0e6, 0.5});
  const auto inward_m = [&](double flat, double r) {
    return -spread_displacement_m({center_m, normal, 1.0, a, flat}, rubber, center_m + r * side).dot(normal);
  };
  for (const double r : {0.0, 0.001, 0.0039}) {
    // K. L. Johnson, Contact Mechanics (1985), (3.41a) and (3.37).
    const double p0_pa = 1.5 / (std::numbers::pi * a * a);
    EXPECT_NEAR(inward_m(0.0, r), std::numbers::pi * p0_pa / (4.0 * a * E_star_pa) * (2.0 * a * a - r * r), 1e-11) << r;
    EXPECT_NEAR(inward_m(1.0, r), 1.0 / (2.0 * a * E_star_pa), 1e-11) << r;
  }
  EXPECT_NEAR(inward_m(1.0, 0.01), std::asin(0.4) / (std::numbers::pi * a * E_star_pa), 1e-11);
}

/// Over the patch the pressure is the force; beside it there is none.
TEST(SpreadLoad, PressureCarriesTheForce) {
  const Vec3 side = normal.unitOrthogonal();
  const double a = 0.004, force_n = 7.0;
  for (const double flat : {0.0, 0.4, 1.0}) {
    const SpreadLoad load{center_m, normal, force_n, a / 1.1, flat, 1.1, 0.2 - 0.3 * flat};
    double sum_n = 0.0;
    constexpr int steps = 4000;
    for (int i = 0; i < steps; ++i) {  // r = a sin(angle), where the flat punch's pressure is smooth
      const double angle = 0.5 * std::numbers::pi * (i + 0.5) / steps, r = a * std::sin(angle);
      sum_n += spread_pressure_pa(load, center_m + r * side) * 2.0 * std::numbers::pi * r * a * std::cos(angle) * 0.5 *
               std::numbers::pi / steps;
    }
    EXPECT_NEAR(sum_n, force_n, 1e-3 * force_n) << flat;
    EXPECT_EQ(spread_pressure_pa(load, center_m + 1.01 * a * side), 0.0);
    EXPECT_EQ(spread_pressure_pa(load, center_m - 0.5 * a * normal), spread_pressure_pa(load, center_m));
    // A ball's ends in zero, though its field on the half space is a little like a flat punch's.
    const BallField field(0.5);
    SpreadLoad ball = load;
    ball.field = &field;
    EXPECT_LT(spread_pressure_pa(ball, center_m + 0.999999 * a * side), 0.01 * spread_pressure_pa(ball, center_m));
  }
}

TEST(SpreadLoad, FarFromABallItsFieldIsADoubleForce) {
  const Vec3 side = normal.unitOrthogonal();
  for (const double nu : {0.0, 0.3, 0.5}) {
    const scene::Material material{3.0e6, nu};
    const HalfSpace half_space(material);
    const BallField field(nu);
    SpreadLoad load{center_m, normal, 1.0, 0.004};
    SpreadLoad with = load;
    with.field = &field;
    with.field_m = 0.001;
    with.body_share = 0.3;
    const scene::PointLoad apart{
        .point_m = center_m, .normal = normal, .force_n = 0.0, .apart_nm = half_space.double_force_nm(with.apart_m3())};
    EXPECT_LT(apart.apart_nm, 0.0) << "the surface is drawn inwards";
    for (const auto& [r, z] : {std::pair(0.013, 0.0), {0.02, 0.0}, {0.02, 0.01}, {0.0, 0.03}}) {
      const Vec3 x_m = center_m + r * side - z * normal;
      const Vec3 expected_m = scene::half_space_displacement_m(apart, material, x_m);
      const Vec3 found_m = spread_displacement_m(with, half_space, x_m) - spread_displacement_m(load, half_space, x_m);
      EXPECT_LT((found_m - expected_m).norm(), 1e-9 * expected_m.norm()) << nu << ' ' << r << ' ' << z;
    }
    // Its tables end there.
    const double reach_m = BallField::reach * load.radius_m;
    const auto at = [&](double r_m) { return spread_displacement_m(with, half_space, center_m + r_m * side); };
    EXPECT_LT((at(reach_m * (1.0 - 1e-9)) - at(reach_m * (1.0 + 1e-9))).norm(), 1e-8 * with.field_m);
    // Flat bodies have less of it.
    EXPECT_GT(field.far(0.0), field.far(0.3));
  }
}

TEST(SpreadLoad, TheLoopAgreesFromTheNearVerticesOn) {
  const double a = 0.004;
  Columns3 rest_m, out_m;
  std::vector<std::int32_t> near;
  const Vec3 first = normal.unitOrthogonal(), second = normal.cross(first);
  for (int i = 0; i < 1000; ++i) {
    const double r = 1e-4 * i, phi = 0.7 * i, z = 3e-5 * (i % 37);
    const Vec3 x_m = center_m + r * (std::cos(phi) * first + std::sin(phi) * second) - z * normal;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rest_m[axis].push_back(static_cast<float>(x_m[static_cast<Eigen::Index>(axis)]));
      out_m[axis].push_back(0.0f);
    }
    near.push_back(0);
  }
  for (const double nu : {0.0, 0.5}) {
    for (const double flat : {0.0, 1.0}) {
      SpreadLoad load{center_m, normal, 20.0, a, flat};
      const BallField field(nu);
      load.field = &field;
      load.field_m = 0.05;
      const HalfSpace half_space({3.0e6, nu});
      const std::int32_t count = spread_displacements_m(load, half_space, rest_m, out_m, near.data());
      EXPECT_GT(count, 100);
      EXPECT_LT(count, 125);
      std::size_t next = 0;
      for (std::size_t i = 0; i < 1000; ++i) {
        if (next < static_cast<std::size_t>(count) && near[next] == static_cast<std::int32_t>(i)) {
          ++next;
          continue;
        }
        const Vec3 x_m(rest_m[0][i], rest_m[1][i], rest_m[2][i]), found_m(out_m[0][i], out_m[1][i], out_m[2][i]);
        const Vec3 expected_m = spread_displacement_m(load, half_space, x_m);
        EXPECT_LT((found_m - expected_m).norm(), 2e-3 * expected_m.norm()) << nu << ' ' << flat << ' ' << i;
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
