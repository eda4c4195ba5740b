#include "scene/shape/surface.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
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
        // From slightly outside, the closest point is the same point.
        const SurfaceQuery q = shape.query(p.point_m + 1e-3 * p.normal);
        EXPECT_EQ(q.patch, patch);
        EXPECT_NEAR(q.signed_distance_m, 1e-3, 1e-15);
        EXPECT_LT((q.point_m - p.point_m).norm(), 1e-15);
        EXPECT_LT((q.normal - p.normal).norm(), 1e-12);
      }
    }
  }
}

TEST_P(EveryShape, PatchesOfOneFaceMeetSmoothly) {
  const Shape& shape = *GetParam().shape;
  ASSERT_EQ(shape.face_of(0), 0);
  for (int patch = 1; patch < shape.patch_count(); ++patch) {
    const int face = shape.face_of(patch), before = shape.face_of(patch - 1);
    EXPECT_TRUE(face == before || face == before + 1);
    if (face != before) continue;
    // Some border coincides with that of an earlier patch of the face.
    double nearest = 2.0;
    for (int other = 0; other < patch; ++other) {
      if (shape.face_of(other) != face) continue;
      for (double u : {0.0, 1.0}) {
        for (double v : {0.0, 1.0}) {
          const SurfacePoint p = shape.at(patch, u, v);
          for (double s : {0.0, 1.0}) {
            for (double t : {0.0, 1.0}) {
              const SurfacePoint q = shape.at(other, s, t);
              if ((p.point_m - q.point_m).norm() < 1e-12) nearest = std::min(nearest, (p.normal - q.normal).norm());
            }
          }
        }
      }
    }
    EXPECT_LT(nearest, 1e-6) << patch;
  }
}

TEST(Faces, MeetAtTheEdges) {
  EXPECT_EQ(box.face_of(5), 5);
  EXPECT_EQ(sphere.face_of(7), 0);
  const Revolution capsule(capsule_profile(0.01, 0.03)), cylinder(cylinder_profile(0.02, 0.03, 0.0));
  EXPECT_EQ(capsule.face_of(capsule.patch_count() - 1), 0);
  EXPECT_EQ(cylinder.face_of(cylinder.patch_count() - 1), 2);
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
    // No point of the surface is closer: exact, not only consistent.
    for (int patch = 0; patch < shape.patch_count(); ++patch) {
      const SurfacePoint other = shape.at(patch, 0.5 * (spread(random) + 0.5), 0.5 * (spread(random) + 0.5));
      EXPECT_GE((other.point_m - p).norm(), std::abs(q.signed_distance_m) - 1e-14);
    }
  }
}

TEST_P(EveryShape, NormalIsTheGradientOfTheDistance) {
  // This implies the Eikonal equation: the gradient has unit length.
  const Shape& shape = *GetParam().shape;
  std::mt19937 random(4);
  const Bounds b = shape.bounds();
  const Vec3 size = b.upper_m - b.lower_m;
  std::uniform_real_distribution<double> spread(-0.5, 1.5);
  int ridges = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = b.lower_m + size.cwiseProduct(Vec3(spread(random), spread(random), spread(random)));
    constexpr double step_m = 1e-7;
    Vec3 gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 e = step_m * Vec3::Unit(axis);
      gradient[axis] = (shape.signed_distance_m(p + e) - shape.signed_distance_m(p - e)) / (2.0 * step_m);
    }
    // Inside, the distance has ridges where two surface points are equally close; few places are so close to one.
    if ((gradient - shape.query(p).normal).norm() > 1e-5) ++ridges;
  }
  EXPECT_LE(ridges, 3);
}

TEST_P(EveryShape, DistanceIsThatOfManySurfacePoints) {
  const Shape& shape = *GetParam().shape;
  const Surface fine = tessellate(shape, 20000);
  // Distance of a vertex from its neighbours.
  double spacing_m = 0.0;
  for (const auto& [a, b, c] : fine.triangles) {
    spacing_m = std::max({spacing_m, (fine.points_m.col(a) - fine.points_m.col(b)).norm(),
                          (fine.points_m.col(b) - fine.points_m.col(c)).norm(),
                          (fine.points_m.col(c) - fine.points_m.col(a)).norm()});
  }
  std::mt19937 random(6);
  const Bounds b = shape.bounds();
  const Vec3 size = b.upper_m - b.lower_m, center = 0.5 * (b.upper_m + b.lower_m);
  std::uniform_real_distribution<double> spread(-0.7, 0.7);
  for (int i = 0; i < 200; ++i) {
    Vec3 p = center + size.cwiseProduct(Vec3(spread(random), spread(random), spread(random)));
    // Some on the axis and on planes of symmetry.
    for (int axis = 0; axis < 3; ++axis) {
      if (i % 8 >> axis & 1) p[axis] = center[axis];
    }
    const double nearest_m = (fine.points_m.colwise() - p).colwise().norm().minCoeff();
    const double d = std::abs(shape.signed_distance_m(p));
    EXPECT_LE(d, nearest_m + 1e-15);
    EXPECT_GE(d, nearest_m - spacing_m);
    if (d > 0.01) {
      EXPECT_GE(d, nearest_m - spacing_m * spacing_m / d);
    }
    // Outside the bounding box is outside; the shape's own centre is inside.
    if (((p - b.lower_m).array() < 0.0).any() || ((b.upper_m - p).array() < 0.0).any()) {
      EXPECT_GT(shape.signed_distance_m(p), 0.0);
    }
  }
  EXPECT_LT(shape.signed_distance_m(center), 0.0);
}

TEST_P(EveryShape, CurvaturesAreThoseOfFiniteDifferences) {
  // The shape operator dn from normals at neighbouring closest points, along two tangents.
  const Shape& shape = *GetParam().shape;
  for (int patch = 0; patch < shape.patch_count(); ++patch) {
    for (double u : {0.15, 0.6}) {
      for (double v : {0.3, 0.7}) {
        const SurfacePoint p = shape.at(patch, u, v);
        const Vec3 first = p.normal.unitOrthogonal(), second = p.normal.cross(first);
        constexpr double step_m = 1e-5;
        Eigen::Matrix2d bend;
        for (int k = 0; k < 2; ++k) {
          const Vec3 along = k == 0 ? first : second;
          const Vec3 change =
              (shape.query(p.point_m + step_m * along).normal - shape.query(p.point_m - step_m * along).normal) /
              (2.0 * step_m);
          bend.col(k) = Eigen::Vector2d(change.dot(first), change.dot(second));
        }
        const double mean = 0.5 * bend.trace();
        const double half_gap = std::sqrt(std::max(0.0, mean * mean - bend.determinant()));
        EXPECT_NEAR(p.curvature_max_per_m, mean + half_gap, 1e-2 + 1e-3 * p.curvature_max_per_m) << patch;
        EXPECT_NEAR(p.curvature_min_per_m, mean - half_gap, 1e-2 + 1e-3 * p.curvature_max_per_m) << patch;
      }
    }
  }
}

TEST(EveryRevolution, HasASoundProfile) {
  for (const auto& [name, profile] : test::profiles()) EXPECT_TRUE(profile_faults(profile).empty()) << name;
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
