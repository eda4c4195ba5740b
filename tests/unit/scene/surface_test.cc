#include "scene/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>

namespace touchstone::scene {
namespace {

const Box box(Vec3(0.0, 0.0, 0.03), Vec3(0.06, 0.04, 0.06));
const Sphere sphere(Vec3(0.0, 0.0, 0.03), 0.03);

double signed_volume_m3(const Surface& surface) {
  double volume = 0.0;
  for (const auto& [a, b, c] : surface.triangles) {
    volume += surface.points_m.col(a).dot(surface.points_m.col(b).cross(surface.points_m.col(c))) / 6.0;
  }
  return volume;
}

TEST(Tessellate, GivesAboutTheTrianglesAskedFor) {
  for (int wished : {12, 1000, 3952, 100000}) {
    EXPECT_NEAR(tessellate(box, wished).triangle_count(), wished, 0.12 * wished + 8) << wished;
    EXPECT_NEAR(tessellate(sphere, wished).triangle_count(), wished, 0.12 * wished + 8) << wished;
  }
}

TEST(Tessellate, VerticesLieOnTheShapeSortedByPatch) {
  for (const Shape* shape : {static_cast<const Shape*>(&box), static_cast<const Shape*>(&sphere)}) {
    const Surface s = tessellate(*shape, 2000);
    ASSERT_EQ(s.patch_begin.size(), static_cast<std::size_t>(shape->patch_count()) + 1);
    EXPECT_EQ(s.patch_begin.front(), 0);
    EXPECT_EQ(s.patch_begin.back(), s.vertex_count());
    for (int i = 0; i < s.vertex_count(); ++i) EXPECT_NEAR(shape->signed_distance_m(s.points_m.col(i)), 0.0, 1e-16);
  }
}

TEST(Tessellate, IsClosedAndTurnedOutward) {
  EXPECT_NEAR(signed_volume_m3(tessellate(box, 500)), box.volume_m3(), 1e-15);
  const Surface s = tessellate(sphere, 2000);
  EXPECT_GT(signed_volume_m3(s), 0.99 * sphere.volume_m3());
  // Closed: vector areas sum to zero.
  for (const Surface& surface : {s, tessellate(box, 500)}) {
    Vec3 sum = Vec3::Zero();
    for (const auto& [a, b, c] : surface.triangles) {
      const Vec3 pa = surface.points_m.col(a);
      const Vec3 area = 0.5 * (surface.points_m.col(b) - pa).cross(surface.points_m.col(c) - pa);
      EXPECT_GT(area.dot(surface.normals.col(a)), 0.0);
      sum += area;
    }
    EXPECT_LT(sum.norm(), 1e-16);
  }
}

TEST(Tessellate, VolumeAndAreaConvergeWithSecondOrder) {
  // Vertices on a smooth surface: the chord error, and so area and volume, fall with h^2.
  std::vector<double> area_error, volume_error;
  for (int triangles : {8 * 64, 8 * 256, 8 * 1024}) {
    const Surface s = tessellate(sphere, triangles);
    const double area_m2 = std::accumulate(s.vertex_area_m2.begin(), s.vertex_area_m2.end(), 0.0);
    area_error.push_back(1.0 - area_m2 / sphere.area_m2());
    volume_error.push_back(1.0 - signed_volume_m3(s) / sphere.volume_m3());
  }
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::log2(area_error[i] / area_error[i + 1]), 2.0, 0.05);
    EXPECT_NEAR(std::log2(volume_error[i] / volume_error[i + 1]), 2.0, 0.05);
  }
}

TEST(Tessellate, VertexAreasSumToTheBox) {
  const Surface s = tessellate(box, 1000);
  EXPECT_NEAR(std::accumulate(s.vertex_area_m2.begin(), s.vertex_area_m2.end(), 0.0), box.area_m2(), 1e-15);
}

}  // namespace
}  // namespace touchstone::scene
