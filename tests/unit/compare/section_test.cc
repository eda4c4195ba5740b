#include "compare/section.h"

#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

using scene::Vec3;

double perimeter_m(const scene::Surface& surface, const std::vector<EdgePoint>& outline) {
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    sum += (outline[(i + 1) % outline.size()].of(surface.points_m) - outline[i].of(surface.points_m)).norm();
  }
  return sum;
}

TEST(Section, OfABoxIsOneClosedRectangle) {
  const scene::Surface surface = scene::tessellate(scene::Box(Vec3(0.0, 0.0, 1.5), Vec3(1.0, 2.0, 3.0)), 400);
  for (const double y : {-0.71, 1e-7, 0.123}) {
    const auto outlines = cut_at_y(surface, y);
    ASSERT_EQ(outlines.size(), 1u) << y;
    EXPECT_NEAR(perimeter_m(surface, outlines[0]), 8.0, 1e-9) << y;
    for (const EdgePoint& p : outlines[0]) EXPECT_NEAR(p.of(surface.points_m).y(), y, 1e-12);
  }
}

TEST(Section, MissesABodyElsewhere) {
  const scene::Surface surface = scene::tessellate(scene::Box(Vec3(0.0, 0.0, 1.5), Vec3(1.0, 2.0, 3.0)), 400);
  EXPECT_TRUE(cut_at_y(surface, 1.5).empty());
}

TEST(Section, ClippedTrianglesCoverWhatLiesBehind) {
  const scene::Surface surface = scene::tessellate(scene::Box(Vec3(0.0, 0.0, 1.5), Vec3(1.0, 2.0, 3.0)), 400);
  double area_m2 = 0.0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const std::vector<EdgePoint> polygon = triangle_behind_y(surface, i, 0.25);
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      const Vec3 a = polygon[0].of(surface.points_m);
      area_m2 += 0.5 * (polygon[k - 1].of(surface.points_m) - a).cross(polygon[k].of(surface.points_m) - a).norm();
    }
    for (const EdgePoint& p : polygon) EXPECT_GE(p.of(surface.points_m).y(), 0.25 - 1e-12);
  }
  // The far end, and three quarters of a unit of the four long sides.
  EXPECT_NEAR(area_m2, 1.0 * 3.0 + 0.75 * 8.0, 1e-9);
}

}  // namespace
}  // namespace touchstone::compare
