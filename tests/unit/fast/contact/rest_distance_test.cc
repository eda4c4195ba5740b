#include "fast/contact/rest_distance.h"

#include "scene/shape/solids.h"

#include <gtest/gtest.h>

#include <random>

namespace touchstone::fast {
namespace {

using scene::Vec3;

template <class Body>
void expect_the_shapes_answers(const Body& body) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.04, 0.04);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = Vec3(place(random), place(random), place(random)) + Vec3(0.0, 0.0, 0.03);
    const scene::SurfaceQuery truth = body.query(p);
    const RestDistance rest = rest_distance(body, p);
    ASSERT_EQ(rest.signed_distance_m < 0.0, truth.signed_distance_m < 0.0);
    if (truth.signed_distance_m >= 0.0) continue;
    ++inside;
    EXPECT_NEAR(rest.signed_distance_m, truth.signed_distance_m, 1e-16);
    EXPECT_LT((rest.normal - truth.normal).norm(), 1e-12);

    const Vec3 direction = Vec3(place(random), place(random), place(random)).normalized();
    const double way_m = exit_along(body, direction)(p);
    EXPECT_NEAR(body.signed_distance_m(p + way_m * direction), 0.0, 3e-14);
    EXPECT_LT(body.signed_distance_m(p + 0.5 * way_m * direction), 0.0);
  }
  EXPECT_GT(inside, 500);
}

TEST(RestDistance, OfABoxIsTheShapes) {
  expect_the_shapes_answers(scene::Box(Vec3(0, 0, 0.03), Vec3(0.06, 0.05, 0.04)));
}

TEST(RestDistance, OfASphereIsTheShapes) { expect_the_shapes_answers(scene::Sphere(Vec3(0, 0, 0.03), 0.03)); }

TEST(RestDistance, OfAnEllipsoidIsTheShapes) {
  expect_the_shapes_answers(scene::Ellipsoid(Vec3(0, 0, 0.03), Vec3(0.03, 0.025, 0.02)));
  expect_the_shapes_answers(scene::Ellipsoid(Vec3(0, 0, 0.03), Vec3(0.03, 0.03, 0.008)));
}

TEST(RestDistance, OfARevolutionIsTheShapes) {
  using Vec2 = Eigen::Vector2d;
  const Vec3 place(0, 0, 0.03);
  expect_the_shapes_answers(scene::Revolution(scene::capsule_profile(0.015, 0.02), place));
  expect_the_shapes_answers(scene::Revolution(scene::cylinder_profile(0.025, 0.04, 0.0), place));
  expect_the_shapes_answers(scene::Revolution(scene::cylinder_profile(0.025, 0.04, 0.005), place));
  expect_the_shapes_answers(scene::Revolution({{Vec2(0, -0.02), Vec2(0.03, 0), Vec2(0, 0.03)}, {}}, place));
  expect_the_shapes_answers(scene::Revolution({{Vec2(0, -0.03), Vec2(0.015, 0), Vec2(0, 0.03)}, {0.06, 0.06}}, place));
}

TEST(RestDistance, OfARevolutionThatIsASphereIsTheSpheres) {
  const scene::Revolution ball(
      {{Eigen::Vector2d(0, -0.02), Eigen::Vector2d(0.02, 0), Eigen::Vector2d(0, 0.02)}, {0.02, 0.02}});
  const scene::Sphere sphere(Vec3::Zero(), 0.02);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.012, 0.012);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p(place(random), place(random), place(random));
    const Vec3 direction = Vec3(place(random), place(random), place(random)).normalized();
    EXPECT_NEAR(exit_along(ball, direction)(p), exit_along(sphere, direction)(p), 2e-14);
  }
}

TEST(RestDistance, ExitAlongAnAxisIsTheFacesDistance) {
  const scene::Box box(Vec3(0, 0, 0.03), Vec3(0.06, 0.06, 0.06));
  EXPECT_DOUBLE_EQ(exit_along(box, Vec3(0, 0, 1))(Vec3(0.01, 0.02, 0.05)), 0.01);
  EXPECT_DOUBLE_EQ(exit_along(box, Vec3(0, -1, 0))(Vec3(0.01, 0.02, 0.05)), 0.05);
  EXPECT_EQ(exit_along(box, Vec3(0, 0, 1))(Vec3(0.0, 0.0, 0.07)), 0.0);
  EXPECT_EQ(exit_along(scene::Sphere(Vec3::Zero(), 0.01), Vec3(0, 0, 1))(Vec3(0.0, 0.0, -0.02)), 0.0);
}

}  // namespace
}  // namespace touchstone::fast
