#include "unit/scene/shapes.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace touchstone::scene {
namespace {

const Box box(Vec3(0.1, -0.2, 0.3), Vec3(0.06, 0.04, 0.08));
const Sphere sphere(Vec3(-0.1, 0.2, 0.05), 0.03);

class EveryShape : public testing::TestWithParam<test::NamedShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryShape, testing::ValuesIn(test::every_shape()),
                         [](const auto& shape) { return shape.param.name; });

TEST_P(EveryShape, PatchPointsLieOnTheSurfaceWithTheQueriesNormal) {
  const Shape& shape = *GetParam().shape;
  for (int patch = 0; patch < shape.patch_count(); ++patch) {
    for (double u : {0.1, 0.5, 0.8}) {
      for (double v : {0.2, 0.5, 0.7}) {
        const SurfacePoint p = shape.at(patch, u, v);
        EXPECT_NEAR(shape.signed_distance_m(p.point_m), 0.0, 1e-16);
        // A little outside, the closest point is the point again.
        const SurfaceQuery q = shape.query(p.point_m + 1e-3 * p.normal);
        EXPECT_EQ(q.patch, patch);
        EXPECT_NEAR(q.signed_distance_m, 1e-3, 1e-15);
        EXPECT_LT((q.point_m - p.point_m).norm(), 1e-15);
        EXPECT_LT((q.normal - p.normal).norm(), 1e-12);
      }
    }
  }
}

TEST_P(EveryShape, PatchesCoverTheArea) {
  // Midpoint rule over (u, v) with |x_u cross x_v| by central differences; second order in the step.
  const Shape& shape = *GetParam().shape;
  constexpr int n = 64;
  double area_m2 = 0.0;
  for (int patch = 0; patch < shape.patch_count(); ++patch) {
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double u = (i + 0.5) / n, v = (j + 0.5) / n, d = 0.5 / n;
        const Vec3 xu = (shape.at(patch, u + d, v).point_m - shape.at(patch, u - d, v).point_m) / (2 * d);
        const Vec3 xv = (shape.at(patch, u, v + d).point_m - shape.at(patch, u, v - d).point_m) / (2 * d);
        area_m2 += xu.cross(xv).norm() / (n * n);
      }
    }
  }
  EXPECT_NEAR(area_m2 / shape.area_m2(), 1.0, 3e-4);
}

TEST_P(EveryShape, DistanceIsExactInsideAndOutside) {
  const Shape& shape = *GetParam().shape;
  std::mt19937 random(1);
  const Bounds b = shape.bounds();
  const Vec3 size = b.upper_m - b.lower_m;
  std::uniform_real_distribution<double> spread(-0.5, 1.5);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = b.lower_m + size.cwiseProduct(Vec3(spread(random), spread(random), spread(random)));
    const SurfaceQuery q = shape.query(p);
    EXPECT_NEAR(shape.signed_distance_m(p), q.signed_distance_m, 1e-15);
    EXPECT_NEAR(q.normal.norm(), 1.0, 1e-12);
    EXPECT_NEAR(shape.signed_distance_m(q.point_m), 0.0, 1e-15);
    EXPECT_LT((q.point_m + q.signed_distance_m * q.normal - p).norm(), 1e-14);
    // Nothing on the surface is nearer: exactness, not only consistency.
    for (int patch = 0; patch < shape.patch_count(); ++patch) {
      const SurfacePoint other = shape.at(patch, 0.5 * (spread(random) + 0.5), 0.5 * (spread(random) + 0.5));
      EXPECT_GE((other.point_m - p).norm(), std::abs(q.signed_distance_m) - 1e-14);
    }
  }
}

TEST(Sphere, HasItsCurvatureEverywhereAndABoxNone) {
  EXPECT_DOUBLE_EQ(sphere.at(3, 0.3, 0.4).curvature_max_per_m, 1.0 / 0.03);
  EXPECT_DOUBLE_EQ(sphere.at(3, 0.3, 0.4).curvature_min_per_m, 1.0 / 0.03);
  EXPECT_EQ(box.at(1, 0.3, 0.4).curvature_max_per_m, 0.0);
  EXPECT_DOUBLE_EQ(sphere.volume_m3(), 4.0 / 3.0 * std::numbers::pi * 0.03 * 0.03 * 0.03);
  EXPECT_DOUBLE_EQ(box.volume_m3(), 0.06 * 0.04 * 0.08);
}

TEST(Sphere, CentreHasADefiniteAnswer) {
  const SurfaceQuery q = sphere.query(sphere.center_m());
  EXPECT_DOUBLE_EQ(q.signed_distance_m, -0.03);
  EXPECT_EQ(q.normal, Vec3::UnitZ());
}

TEST(Box, CornerDistanceIsToTheCorner) {
  const Vec3 corner = box.center_m() + box.half_m();
  EXPECT_NEAR(box.signed_distance_m(corner + Vec3(3e-3, 4e-3, 12e-3)), 13e-3, 1e-16);
}

}  // namespace
}  // namespace touchstone::scene
