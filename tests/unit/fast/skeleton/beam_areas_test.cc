#include "fast/skeleton/beam_areas.h"

#include "support/bodies.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>
#include <random>

namespace touchstone::fast {
namespace {

using scene::Vec3;

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::unique_ptr<const AnchorPoints> anchors_of(const scene::Body& body) {
  return anchor_points(body, *scene::body_shape(body));
}

TEST(BeamAreas, OfABoxCoverItsSurface) {
  const scene::Box box(Vec3::Zero(), Vec3(0.06, 0.05, 0.04));
  const BoxAnchors anchors(box);
  const std::vector<double> areas_m2 = voronoi_areas_m2(area_triangles(anchors));
  EXPECT_NEAR(sum(areas_m2), box.area_m2(), 1e-15);
  // By symmetry each corner has a quarter of each of its three faces.
  for (const double area_m2 : areas_m2) EXPECT_NEAR(area_m2, box.area_m2() / 8.0, 1e-15);
}

TEST(BeamAreas, OfASphereAreEqualPartsOfTheStatedShare) {
  const scene::Sphere sphere(Vec3(0.0, 0.0, 0.03), 0.03);
  const EllipsoidAnchors anchors(sphere, 0.0);
  const std::vector<double> areas_m2 = voronoi_areas_m2(area_triangles(anchors));
  EXPECT_NEAR(sum(areas_m2) / sphere.area_m2(), 0.553, 0.0005);
  for (const double area_m2 : areas_m2) EXPECT_NEAR(area_m2, areas_m2[0], 1e-15);
}

TEST(BeamAreas, OfACylinderAreThoseOfItsFlatTriangles) {
  const double r = 0.02, h = 0.05;
  const auto anchors = anchors_of(test::round_body(scene::cylinder_profile(r, h, 0.0)));
  const std::vector<double> areas_m2 = voronoi_areas_m2(area_triangles(*anchors));
  // By hand: on a cap the inscribed square. On the side, seen from (r, 0, 0), the points half round at the same height
  // and half up: two triangles with the edges (e, 0), (e, h / 2) and (e, h / 2), (0, h / 2), on either side.
  const Vec3 e(r * (std::sqrt(0.5) - 1.0), r * std::sqrt(0.5), 0.0), up(0.0, 0.0, 0.5 * h);
  const double side_m2 = 2.0 * 0.5 * (e.cross(Vec3(e + up)).norm() + Vec3(e + up).cross(up).norm());
  for (const double area_m2 : areas_m2) EXPECT_NEAR(area_m2, 2.0 * r * r / 4.0 + side_m2, 1e-12);
}

TEST(BeamAreas, OfAPieceWrittenTwiceCountOnce) {
  // The half-round rim as two arcs has the areas that it has as one.
  const auto anchors = anchors_of(test::round_body(test::pill_profile()));
  const AreaTriangles triangles = area_triangles(*anchors);
  // Two caps of four corners, and four bands of four; four corners make two triangles each.
  EXPECT_EQ(triangles.triangle.size(), (2u + 4u) * 4u * 2u);
}

TEST(BeamAreas, SharesSumToOneOnEveryBody) {
  for (const auto& [name, body] : test::bodies()) {
    const auto anchors = anchors_of(body);
    const std::vector<double> shares = voronoi_shares(area_triangles(*anchors));
    ASSERT_EQ(shares.size(), anchors->points_m().size());
    EXPECT_NEAR(sum(shares), 1.0, 1e-14) << name;
    for (const double share : shares) EXPECT_GT(share, 1e-3) << name;
  }
}

TEST(BeamAreas, AtRestTheCurrentSurfaceIsTheRestSurface) {
  for (const auto& [name, body] : test::bodies()) {
    const auto anchors = anchors_of(body);
    const AreaTriangles triangles = area_triangles(*anchors);
    const std::vector<double> rest = voronoi_shares(triangles);
    std::vector<double> current(rest.size());
    voronoi_shares(triangles, std::vector<Vec3>(rest.size(), Vec3::Zero()), current);
    EXPECT_EQ(current, rest) << name;
    // A translation as a whole changes nothing.
    voronoi_shares(triangles, std::vector<Vec3>(rest.size(), Vec3(0.01, -0.02, 0.005)), current);
    for (std::size_t i = 0; i < rest.size(); ++i) EXPECT_NEAR(current[i], rest[i], 1e-15) << name;
  }
}

TEST(BeamAreas, FollowAStretchedBoxExactly) {
  const Vec3 size(0.06, 0.05, 0.04), stretch(1.3, 0.8, 1.1);
  const scene::Box box(Vec3::Zero(), size), stretched(Vec3::Zero(), size.cwiseProduct(stretch));
  const BoxAnchors anchors(box), goal(stretched);
  const AreaTriangles triangles = area_triangles(anchors);
  std::vector<Vec3> u;
  for (std::size_t i = 0; i < 8; ++i) u.push_back(goal.points_m()[i] - anchors.points_m()[i]);
  // One corner moves further than the stretch; otherwise all fractions would be equal.
  u[7] += Vec3(0.004, 0.002, 0.003);
  std::vector<double> shares(8);
  voronoi_shares(triangles, u, shares);
  // On flat faces p_ij is the middle of the corners: compare with newly built triangles.
  std::vector<double> anew(8, 0.0);
  for (int patch = 0; patch < 6; ++patch) {
    const std::vector<int> around = anchors.around(patch);
    const auto place = [&](std::size_t k) {
      const auto i = static_cast<std::size_t>(around[k % 4]);
      return Vec3(anchors.points_m()[i] + u[i]);
    };
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t step = 1; step < 3; ++step) {
        const Vec3 a = 0.5 * (place(i + step) - place(i)), b = 0.5 * (place(i + step + 1) - place(i));
        anew[static_cast<std::size_t>(around[i])] += 0.5 * a.cross(b).norm();
      }
    }
  }
  const double whole = sum(anew);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(shares[i], anew[i] / whole, 1e-14);
  EXPECT_GT(shares[7], 1.02 * shares[0]);
}

TEST(BeamAreas, StayPositiveWhenAnchorPointsFallTogether) {
  const BoxAnchors anchors(scene::Box(Vec3::Zero(), Vec3(0.06, 0.05, 0.04)));
  const AreaTriangles triangles = area_triangles(anchors);
  std::vector<Vec3> u(8, Vec3::Zero());
  std::vector<double> shares(8);
  for (std::size_t i = 0; i < 8; ++i) u[i] = -anchors.points_m()[i];
  voronoi_shares(triangles, u, shares);
  for (const double share : shares) EXPECT_EQ(share, 0.125);
  // Corner 0 and its neighbours at one point, the rest unchanged.
  std::fill(u.begin(), u.end(), Vec3::Zero());
  for (const std::size_t i : {1u, 2u, 3u, 4u, 5u, 6u}) u[i] = anchors.points_m()[0] - anchors.points_m()[i];
  voronoi_shares(triangles, u, shares);
  double total = 0.0;
  for (const double share : shares) {
    EXPECT_GT(share, 0.0);
    total += share;
  }
  EXPECT_NEAR(total, 1.0, 1e-14);
}

}  // namespace
}  // namespace touchstone::fast
