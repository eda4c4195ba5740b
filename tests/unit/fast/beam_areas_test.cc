#include "fast/beam_areas.h"

#include <gtest/gtest.h>

#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

TEST(BeamAreas, OfABoxCoverItsSurface) {
  const scene::Box box(Vec3::Zero(), Vec3(0.06, 0.05, 0.04));
  const BoxAnchors anchors(box);
  const std::vector<double> areas_m2 = voronoi_areas_m2(anchors);
  EXPECT_NEAR(sum(areas_m2), box.area_m2(), 1e-15);
  // By symmetry each corner owns a quarter of each of its three faces.
  for (const double area_m2 : areas_m2) EXPECT_NEAR(area_m2, box.area_m2() / 8.0, 1e-15);
}

TEST(BeamAreas, OfASphereAreEqualPartsOfTheStatedShare) {
  const scene::Sphere sphere(Vec3(0.0, 0.0, 0.03), 0.03);
  const SphereAnchors anchors(sphere, 0.0);
  const std::vector<double> areas_m2 = voronoi_areas_m2(anchors);
  EXPECT_NEAR(sum(areas_m2) / sphere.area_m2(), 0.553, 0.0005);
  for (const double area_m2 : areas_m2) EXPECT_NEAR(area_m2, areas_m2[0], 1e-15);
}

TEST(BeamAreas, SharesSumToOne) {
  const BoxAnchors on_box(scene::Box(Vec3::Zero(), Vec3(0.06, 0.05, 0.04)));
  const SphereAnchors on_sphere(scene::Sphere(Vec3::Zero(), 0.03), 0.0);
  for (const AnchorPoints* anchors :
       {static_cast<const AnchorPoints*>(&on_box), static_cast<const AnchorPoints*>(&on_sphere)}) {
    const std::vector<double> shares = voronoi_shares(*anchors);
    ASSERT_EQ(shares.size(), anchors->points_m().size());
    EXPECT_NEAR(sum(shares), 1.0, 1e-15);
  }
}

}  // namespace
}  // namespace touchstone::fast
