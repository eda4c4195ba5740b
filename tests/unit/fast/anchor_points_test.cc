#include "fast/anchor_points.h"

#include "unit/fast/press.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace touchstone::fast {
namespace {

using scene::Vec3;

const scene::Box box(Vec3(0.0, 0.0, 0.02), Vec3(0.06, 0.05, 0.04));
const scene::Sphere sphere(Vec3(0.0, 0.0, 0.03), 0.03);

template <class Anchors>
void expect_each_anchor_to_own_its_corner(const Anchors& anchors) {
  for (int patch = 0; patch < static_cast<int>(anchors.patches().size()); ++patch) {
    const auto& corner = anchors.patches()[static_cast<std::size_t>(patch)];
    for (const int self : anchors.around(patch)) {
      if (anchors.held()[static_cast<std::size_t>(self)]) continue;
      const PatchPlace at = anchors.at(patch, anchors.points_m()[static_cast<std::size_t>(self)]);
      for (std::size_t k = 0; k < corner.size(); ++k) {
        if (anchors.held()[static_cast<std::size_t>(corner[k])]) continue;
        if (k > 0 && corner[k] == corner[0]) continue;  // the repeated first of a patch of three
        EXPECT_NEAR(at.weight[k], corner[k] == self ? 1.0 : 0.0, 1e-15);
      }
    }
  }
}

TEST(BoxAnchors, AreTheEightVerticesOfWhichFourAreHeld) {
  const BoxAnchors anchors(box);
  ASSERT_EQ(anchors.points_m().size(), 8u);
  EXPECT_EQ(std::count(anchors.held().begin(), anchors.held().end(), true), 4);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR((anchors.points_m()[i] - box.center_m()).cwiseAbs().cwiseQuotient(box.half_m()).sum(), 3.0, 1e-14);
    EXPECT_EQ(anchors.held()[i], anchors.points_m()[i].z() < 1e-12);
  }
  expect_each_anchor_to_own_its_corner(anchors);
}

TEST(BoxAnchors, FaceWeightsReproduceThePlaceOnTheFace) {
  const BoxAnchors anchors(box);
  for (int patch = 0; patch < 6; ++patch) {
    for (const double u : {0.0, 0.2, 0.7, 1.0}) {
      for (const double v : {0.0, 0.4, 0.9}) {
        const Vec3 p = box.at(patch, u, v).point_m;
        const PatchPlace at = anchors.at(patch, p);
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = 0; k < 4; ++k) {
          sum += at.weight[k] *
                 anchors.points_m()[static_cast<std::size_t>(anchors.patches()[static_cast<std::size_t>(patch)][k])];
        }
        EXPECT_LT((sum - p).norm(), 1e-15);
        EXPECT_NEAR(std::accumulate(at.weight.begin(), at.weight.end(), 0.0), 1.0, 1e-15);
        EXPECT_EQ(at.held(), patch == 4);
        if (patch != 4) {
          const bool on_edge = u == 0.0 || u == 1.0 || v == 0.0;
          EXPECT_NEAR(*std::min_element(at.edge.begin(), at.edge.end()), on_edge ? 0.0 : std::min({u, 1 - u, v, 1 - v}),
                      1e-12);
        }
      }
    }
  }
}

TEST(SphereAnchors, AreTheSixAxisPoints) {
  const SphereAnchors anchors(sphere, 0.005);
  ASSERT_EQ(anchors.points_m().size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR((anchors.points_m()[i] - sphere.center_m()).norm(), 0.03, 1e-15);
    EXPECT_EQ(anchors.held()[i], i == 5);
  }
  expect_each_anchor_to_own_its_corner(anchors);
}

TEST(SphereAnchors, OctantsShareTheirSides) {
  const SphereAnchors anchors(sphere, 0.005);
  const auto value = [&](int patch, const Vec3& p) {
    const PatchPlace at = anchors.at(patch, p);
    double sum = 0.0;
    for (std::size_t k = 0; k < 4; ++k)
      sum += at.weight[k] * (1.0 + anchors.patches()[static_cast<std::size_t>(patch)][k]);
    return sum;
  };
  for (const double angle : {0.1, 0.7, 1.3}) {
    const Vec3 equator = sphere.center_m() + 0.03 * Vec3(std::cos(angle), std::sin(angle), 0.0);
    EXPECT_NEAR(value(0, equator), value(4, equator), 1e-12);
    const Vec3 meridian = sphere.center_m() + 0.03 * Vec3(0.0, std::cos(angle), std::sin(angle));
    EXPECT_NEAR(value(0, meridian), value(1, meridian), 1e-12);
    const Vec3 below = sphere.center_m() + 0.03 * Vec3(0.0, std::cos(angle), -std::sin(angle));
    EXPECT_NEAR(value(4, below), value(5, below), 1e-12);
  }
}

TEST(SphereAnchors, HeldSurfaceHangsOnTheHeldPole) {
  const SphereAnchors anchors(sphere, 0.005);
  for (const double z : {0.0, 0.001, 0.0049}) {
    const double across = std::sqrt(0.03 * 0.03 - (0.03 - z) * (0.03 - z));
    const PatchPlace at = anchors.at(4, Vec3(0.6 * across, 0.8 * across, z));
    EXPECT_TRUE(at.held());
    EXPECT_EQ(at.weight, (std::array<double, 4>{0.0, 0.0, 1.0, 0.0}));  // all on the held pole
  }
  const double z = 0.0175, across = std::sqrt(0.03 * 0.03 - (0.03 - z) * (0.03 - z));
  const PatchPlace at = anchors.at(4, Vec3(0.6 * across, 0.8 * across, z));
  EXPECT_NEAR(at.weight[0] + at.weight[1], 0.5, 1e-12);  // half way from the support to the equator
  EXPECT_NEAR(at.weight[2], 0.5, 1e-12);
}

}  // namespace
}  // namespace touchstone::fast
