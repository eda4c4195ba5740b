#include "scene/shape/surface.h"
#include "scene/model/scene.h"
#include "support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace touchstone::scene {
namespace {

const Box box_body(Vec3(0.0, 0.0, 0.03), Vec3(0.06, 0.04, 0.06));
const Sphere sphere_body(Vec3(0.0, 0.0, 0.03), 0.03);

double signed_volume_m3(const Surface& surface) {
  double volume = 0.0;
  for (const auto& [a, b, c] : surface.triangles) {
    volume += surface.points_m.col(a).dot(surface.points_m.col(b).cross(surface.points_m.col(c))) / 6.0;
  }
  return volume;
}

TEST(Tessellate, GivesAboutTheTrianglesAskedFor) {
  for (int wished : {12, 1000, 3952, 100000}) {
    EXPECT_NEAR(tessellate(box_body, wished).triangle_count(), wished, 0.12 * wished + 8) << wished;
    EXPECT_NEAR(tessellate(sphere_body, wished).triangle_count(), wished, 0.12 * wished + 8) << wished;
  }
}

TEST(Tessellate, VerticesLieOnTheShapeSortedByPatch) {
  for (const Shape* shape : {static_cast<const Shape*>(&box_body), static_cast<const Shape*>(&sphere_body)}) {
    const Surface s = tessellate(*shape, 2000);
    ASSERT_EQ(s.patch_begin.size(), static_cast<std::size_t>(shape->patch_count()) + 1);
    EXPECT_EQ(s.patch_begin.front(), 0);
    EXPECT_EQ(s.patch_begin.back(), s.vertex_count());
    for (int i = 0; i < s.vertex_count(); ++i) EXPECT_NEAR(shape->signed_distance_m(s.points_m.col(i)), 0.0, 1e-16);
  }
}

TEST(Tessellate, IsClosedAndTurnedOutward) {
  EXPECT_NEAR(signed_volume_m3(tessellate(box_body, 500)), box_body.volume_m3(), 1e-15);
  const Surface s = tessellate(sphere_body, 2000);
  EXPECT_GT(signed_volume_m3(s), 0.99 * sphere_body.volume_m3());
  // Closed: vector areas sum to zero.
  for (const Surface& surface : {s, tessellate(box_body, 500)}) {
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
  // Vertices on a smooth surface: the chord error, and so that of area and volume, decreases with h^2.
  std::vector<double> area_error, volume_error;
  for (int triangles : {8 * 64, 8 * 256, 8 * 1024}) {
    const Surface s = tessellate(sphere_body, triangles);
    const double area_m2 = std::accumulate(s.vertex_area_m2.begin(), s.vertex_area_m2.end(), 0.0);
    area_error.push_back(1.0 - area_m2 / sphere_body.area_m2());
    volume_error.push_back(1.0 - signed_volume_m3(s) / sphere_body.volume_m3());
  }
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::log2(area_error[i] / area_error[i + 1]), 2.0, 0.05);
    EXPECT_NEAR(std::log2(volume_error[i] / volume_error[i + 1]), 2.0, 0.05);
  }
}

TEST(Tessellate, VertexAreasSumToTheBox) {
  const Surface s = tessellate(box_body, 1000);
  EXPECT_NEAR(std::accumulate(s.vertex_area_m2.begin(), s.vertex_area_m2.end(), 0.0), box_body.area_m2(), 1e-15);
}

class EveryTessellation : public testing::TestWithParam<test::NamedShape> {};
INSTANTIATE_TEST_SUITE_P(Shapes, EveryTessellation, testing::ValuesIn(test::every_shape()),
                         [](const auto& shape) { return shape.param.name; });

/// Merges vertices at exactly the same place: borders of patches must coincide bitwise.
std::vector<int> welded(const Surface& s, int& count) {
  std::map<std::array<double, 3>, int> first;
  std::vector<int> vertex;
  for (int i = 0; i < s.vertex_count(); ++i) {
    const Vec3 p = s.points_m.col(i);
    vertex.push_back(first.insert({{p.x(), p.y(), p.z()}, static_cast<int>(first.size())}).first->second);
  }
  count = static_cast<int>(first.size());
  return vertex;
}

TEST_P(EveryTessellation, IsOneClosedSurfaceWithoutCracksOrHandles) {
  for (int wished : {8, 60, 1000, 3952}) {
    const Surface s = tessellate(*GetParam().shape, wished);
    int vertices = 0;
    const std::vector<int> vertex = welded(s, vertices);
    std::map<std::pair<int, int>, int> uses;
    for (const auto& t : s.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const int a = vertex[static_cast<std::size_t>(t[k])], b = vertex[static_cast<std::size_t>(t[(k + 1) % 3])];
        EXPECT_NE(a, b);
        // Every edge occurs once in each direction.
        EXPECT_EQ(++uses[std::make_pair(a, b)], 1);
      }
    }
    for (const auto& [edge, count] : uses) EXPECT_EQ(uses.count({edge.second, edge.first}), 1u);
    EXPECT_EQ(vertices - static_cast<int>(uses.size()) / 2 + s.triangle_count(), 2) << wished;
  }
}

TEST_P(EveryTessellation, HasAboutTheTrianglesAskedForOfAboutOneSize) {
  const Shape& shape = *GetParam().shape;
  for (int wished : {1000, 3952, 20000}) {
    const Surface s = tessellate(shape, wished);
    EXPECT_NEAR(s.triangle_count(), wished, 0.12 * wished) << wished;
    double least_m2 = INFINITY, most_m2 = 0.0;
    for (const auto& [a, b, c] : s.triangles) {
      const Vec3 pa = s.points_m.col(a);
      const double area_m2 = 0.5 * (s.points_m.col(b) - pa).cross(s.points_m.col(c) - pa).norm();
      least_m2 = std::min(least_m2, area_m2);
      most_m2 = std::max(most_m2, area_m2);
    }
    EXPECT_LT(most_m2, 3.0 * shape.area_m2() / wished) << wished;
    EXPECT_GT(least_m2, 0.2 * shape.area_m2() / wished) << wished;
  }
}

TEST_P(EveryTessellation, VerticesLieOnTheirPatchWithItsNormal) {
  const Shape& shape = *GetParam().shape;
  const Surface s = tessellate(shape, 2000);
  ASSERT_EQ(s.patch_begin.size(), static_cast<std::size_t>(shape.patch_count()) + 1);
  EXPECT_EQ(s.patch_begin.back(), s.vertex_count());
  for (std::size_t patch = 0; patch + 1 < s.patch_begin.size(); ++patch) {
    for (int i = s.patch_begin[patch]; i < s.patch_begin[patch + 1]; ++i) {
      const Vec3 p = s.points_m.col(i), n = s.normals.col(i);
      EXPECT_NEAR(shape.signed_distance_m(p), 0.0, 1e-16);
      EXPECT_NEAR(n.norm(), 1.0, 1e-15);
      // Outwards along the patch's own normal the vertex remains the closest point.
      EXPECT_NEAR(shape.signed_distance_m(p + 1e-3 * n), 1e-3, 1e-15);
    }
  }
  for (const auto& triangle : s.triangles) {
    const Vec3 pa = s.points_m.col(triangle[0]);
    const Vec3 area = (s.points_m.col(triangle[1]) - pa).cross(s.points_m.col(triangle[2]) - pa);
    for (const std::int32_t v : triangle) EXPECT_GT(area.dot(s.normals.col(v)), 0.5 * area.norm());
    const auto patch_of = [&](std::int32_t v) {
      return std::upper_bound(s.patch_begin.begin(), s.patch_begin.end(), v) - s.patch_begin.begin();
    };
    EXPECT_EQ(patch_of(triangle[0]), patch_of(triangle[1]));
    EXPECT_EQ(patch_of(triangle[0]), patch_of(triangle[2]));
  }
}

TEST_P(EveryTessellation, AreaAndVolumeConvergeToTheShapes) {
  const Shape& shape = *GetParam().shape;
  std::vector<double> area_error, volume_error;
  for (int triangles : {2000, 8000, 32000}) {
    const Surface s = tessellate(shape, triangles);
    const double area_m2 = std::accumulate(s.vertex_area_m2.begin(), s.vertex_area_m2.end(), 0.0);
    area_error.push_back(1.0 - area_m2 / shape.area_m2());
    volume_error.push_back(1.0 - signed_volume_m3(s) / shape.volume_m3());
  }
  if (GetParam().name == "Box") {
    EXPECT_NEAR(area_error[0], 0.0, 1e-14);
    EXPECT_NEAR(volume_error[0], 0.0, 1e-13);
    return;
  }
  for (const auto& error : {area_error, volume_error}) {
    EXPECT_GT(error[2], 0.0);
    EXPECT_LT(error[0], 2e-2);
    // Four times the triangles, a quarter of the error; ring counts are whole numbers, so over both steps.
    EXPECT_NEAR(0.5 * std::log2(error[0] / error[2]), 2.0, 0.2);
  }
}

TEST_P(EveryTessellation, IsFourfoldSymmetric) {
  // A quarter turn about the shape's axis maps vertices to vertices, if the shape has that symmetry.
  const auto* shape = dynamic_cast<const Revolution*>(GetParam().shape.get());
  if (!shape) return;
  const Surface s = tessellate(*shape, 1000);
  std::map<std::array<long, 3>, int> places;
  const auto key = [&](const Vec3& p) {
    return std::array<long, 3>{std::lround(p.x() * 1e10), std::lround(p.y() * 1e10), std::lround(p.z() * 1e10)};
  };
  for (int i = 0; i < s.vertex_count(); ++i) ++places[key(s.points_m.col(i) - shape->offset_m())];
  for (int i = 0; i < s.vertex_count(); ++i) {
    const Vec3 p = s.points_m.col(i) - shape->offset_m();
    EXPECT_EQ(places.count(key(Vec3(-p.y(), p.x(), p.z()))), 1u);
  }
}

TEST(SurfaceOf, DrawsAnyTool) {
  Tool tool;
  tool.shape = ToolShape::mesh;
  const Surface ball = tessellate(sphere_body, 200);
  tool.mesh = std::make_shared<TriangleMesh>(TriangleMesh{ball.points_m, ball.triangles});
  const Surface flat = tool_surface(tool, 8);
  EXPECT_EQ(flat.triangle_count(), ball.triangle_count());
  EXPECT_NEAR(signed_volume_m3(flat), signed_volume_m3(ball), 1e-18);
  // The mass centre of the ball is at the origin.
  EXPECT_LT(flat.points_m.rowwise().mean().norm(), 1e-15);
  for (const auto& [a, b, c] : flat.triangles) {
    const Vec3 pa = flat.points_m.col(a);
    const Vec3 normal = (flat.points_m.col(b) - pa).cross(flat.points_m.col(c) - pa).normalized();
    EXPECT_LT((normal - flat.normals.col(c)).norm(), 1e-12);
  }
  tool.shape = ToolShape::capsule;
  tool.radius_m = 0.01;
  tool.length_m = 0.02;
  EXPECT_NEAR(tool_surface(tool, 500).triangle_count(), 500, 60);
}

}  // namespace
}  // namespace touchstone::scene
