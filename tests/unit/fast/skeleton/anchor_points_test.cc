#include "fast/skeleton/anchor_points.h"

#include "scene/shape/surface.h"
#include "support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace touchstone::fast {
namespace {

using scene::Vec3;

const scene::Box box(Vec3(0.0, 0.0, 0.02), Vec3(0.06, 0.05, 0.04));
const scene::Sphere sphere(Vec3(0.0, 0.0, 0.03), 0.03);

/// A body with its anchor points and the points of a mesh on it.
struct Standing {
  explicit Standing(const test::NamedBody& named)
      : name(named.name),
        body(named.body),
        shape(scene::body_shape(body)),
        anchors(anchor_points(body, *shape)),
        surface(scene::tessellate(*shape, 1200)) {}
  std::string name;
  scene::Body body;
  std::unique_ptr<const scene::Shape> shape;
  std::unique_ptr<const AnchorPoints> anchors;
  scene::Surface surface;

  [[nodiscard]] int patches() const { return shape->patch_count(); }
  /// Weight of every anchor point at a point of a patch.
  [[nodiscard]] std::vector<double> weights(int patch, const Vec3& p_m) const {
    std::vector<double> by_anchor(anchors->points_m().size(), 0.0);
    const PatchPlace at = anchors->at(patch, p_m);
    const auto& corner = anchors->patches()[static_cast<std::size_t>(patch)];
    for (std::size_t k = 0; k < corner.size(); ++k) by_anchor[static_cast<std::size_t>(corner[k])] += at.weight[k];
    return by_anchor;
  }
  /// Whether a point is on the fixed surface by its definition, with a margin for rounding.
  [[nodiscard]] bool below_support(const Vec3& p_m, int patch) const {
    if (body.shape == scene::BodyShape::box) return patch == 4;
    return body.flat_bottom() ? patch == 0 : p_m.z() < body.support_height_m - 1e-12;
  }
  template <class Visit>
  void on_every_vertex(Visit visit) const {
    for (int patch = 0; patch < patches(); ++patch) {
      for (std::int32_t v = surface.patch_begin[static_cast<std::size_t>(patch)];
           v < surface.patch_begin[static_cast<std::size_t>(patch) + 1]; ++v) {
        visit(patch, Vec3(surface.points_m.col(v)));
      }
    }
  }
};

class EveryBody : public testing::TestWithParam<test::NamedBody> {};
INSTANTIATE_TEST_SUITE_P(Anchors, EveryBody, testing::ValuesIn(test::bodies()), [](const auto& named) {
  std::string name = named.param.name;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
});

TEST_P(EveryBody, WeightsArePartsOfOne) {
  const Standing on(GetParam());
  on.on_every_vertex([&](int patch, const Vec3& p) {
    const PatchPlace at = on.anchors->at(patch, p);
    EXPECT_NEAR(std::accumulate(at.weight.begin(), at.weight.end(), 0.0), 1.0, 1e-13);
    for (const double weight : at.weight) EXPECT_GE(weight, 0.0);
    EXPECT_GE(at.free, 0.0);
    EXPECT_LE(at.free, 1.0 + 1e-15);
    // A point that is not fixed can move.
    if (!on.below_support(p, patch) && p.z() > on.body.support_height_m + 1e-9) {
      EXPECT_GT(at.free, 1e-4) << on.name;
    }
  });
}

TEST_P(EveryBody, FreeAnchorsOwnTheirPlace) {
  const Standing on(GetParam());
  const auto& anchors = *on.anchors;
  for (int patch = 0; patch < on.patches(); ++patch) {
    for (const int self : anchors.around(patch)) {
      const Vec3& p = anchors.points_m()[static_cast<std::size_t>(self)];
      EXPECT_NEAR(on.shape->signed_distance_m(p), 0.0, 1e-12) << on.name;
      if (anchors.held()[static_cast<std::size_t>(self)] || !anchors.first_between_its_anchors(patch)) continue;
      // If a band has several patches, the anchor point may lie on another one of them.
      if (on.name.starts_with("pill") || on.name.starts_with("capsule of five")) continue;
      const std::vector<double> weight = on.weights(patch, p);
      for (std::size_t i = 0; i < weight.size(); ++i) {
        if (anchors.held()[i]) continue;
        EXPECT_NEAR(weight[i], static_cast<int>(i) == self ? 1.0 : 0.0, 1e-12) << on.name << " patch " << patch;
      }
    }
  }
}

TEST_P(EveryBody, HeldSurfaceHangsOnHeldAnchorsOnly) {
  const Standing on(GetParam());
  int below = 0, above = 0;
  on.on_every_vertex([&](int patch, const Vec3& p) {
    const std::vector<double> weight = on.weights(patch, p);
    double free = 0.0;
    for (std::size_t i = 0; i < weight.size(); ++i) free += on.anchors->held()[i] ? 0.0 : weight[i];
    if (on.below_support(p, patch)) {
      ++below;
      EXPECT_EQ(free, 0.0) << on.name << " patch " << patch << " at " << p.transpose();  // exactly: no displacement
      EXPECT_TRUE(on.anchors->at(patch, p).held()) << on.name;
    } else {
      ++above;
    }
    // Just above the support the displacement starts from zero.
    if (!on.body.flat_bottom() && std::abs(p.z() - on.body.support_height_m) < 1e-9) {
      EXPECT_LT(free, 1e-6) << on.name;
    }
  });
  if (on.body.support_height_m > 0.0 || on.body.flat_bottom()) {
    EXPECT_GT(below, 5) << on.name;
  }
  EXPECT_GT(above, 30) << on.name;
}

/// Vertices of different patches at one place.
std::map<std::tuple<long, long, long>, std::vector<std::pair<int, Vec3>>> shared_places(const Standing& on) {
  std::map<std::tuple<long, long, long>, std::vector<std::pair<int, Vec3>>> places;
  on.on_every_vertex([&](int patch, const Vec3& p) {
    const auto key = [&](int axis) { return std::lround(p[axis] * 1e8); };
    places[{key(0), key(1), key(2)}].push_back({patch, p});
  });
  return places;
}

TEST_P(EveryBody, NeighbouringPatchesAgreeOnTheirBorder) {
  const Standing on(GetParam());
  int compared = 0;
  for (const auto& [key, vertices] : shared_places(on)) {
    for (std::size_t k = 1; k < vertices.size(); ++k) {
      const std::vector<double> first = on.weights(vertices[0].first, vertices[0].second),
                                other = on.weights(vertices[k].first, vertices[k].second);
      for (std::size_t i = 0; i < first.size(); ++i) {
        if (on.anchors->held()[i])
          continue;  // which fixed anchor point has the weight of fixed surface does not matter
        EXPECT_NEAR(other[i], first[i], 1e-6) << on.name << " patches " << vertices[0].first << " and "
                                              << vertices[k].first << " at " << vertices[0].second.transpose();
        ++compared;
      }
    }
  }
  // If every anchor point is fixed there is nothing to compare.
  const auto& held = on.anchors->held();
  if (std::count(held.begin(), held.end(), false) > 0) {
    EXPECT_GT(compared, 50) << on.name;
  }
}

TEST_P(EveryBody, LinearInBetweenAndWithoutJumps) {
  // The displacement is continuous: it changes little over a small distance.
  const Standing on(GetParam());
  for (int patch = 0; patch < on.patches(); ++patch) {
    for (const double v : {0.05, 0.37, 0.74, 0.97}) {
      std::vector<double> before;
      Vec3 before_m = Vec3::Zero();
      for (int i = 0; i <= 400; ++i) {
        const Vec3 p = on.shape->at(patch, i / 400.0, v).point_m;
        const std::vector<double> here = on.weights(patch, p);
        for (std::size_t k = 0; k < here.size() && !before.empty(); ++k) {
          EXPECT_LT(std::abs(here[k] - before[k]), 0.02 + 500.0 * (p - before_m).norm()) << on.name;
        }
        before = here;
        before_m = p;
      }
    }
  }
}

TEST_P(EveryBody, HalfwayPointsLieOnTheSurfaceBetweenTheirAnchors) {
  const Standing on(GetParam());
  for (int patch = 0; patch < on.patches(); ++patch) {
    const std::vector<int> around = on.anchors->around(patch);
    for (const int i : around) {
      for (const int j : around) {
        if (i == j) continue;
        const Vec3 half = on.anchors->halfway_m(patch, i, j);
        EXPECT_NEAR(on.shape->signed_distance_m(half), 0.0, 1e-9) << on.name;
        EXPECT_LT((half - on.anchors->halfway_m(patch, j, i)).norm(), 1e-9) << on.name;
        const Vec3 &p_i = on.anchors->points_m()[static_cast<std::size_t>(i)],
                   &p_j = on.anchors->points_m()[static_cast<std::size_t>(j)];
        // Half way from either; the longest distance is across the pole of a cap that is more than a hemisphere.
        EXPECT_LT((half - p_i).norm() + (half - p_j).norm(), 1.8 * (p_i - p_j).norm()) << on.name;
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
    EXPECT_EQ(anchors.reasons()[i], AnchorReason::natural_vertex);
  }
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
        EXPECT_EQ(at.held(), p.z() == 0.0);  // the bottom face and its edges
      }
    }
  }
}

TEST(EllipsoidAnchors, AreTheSixEndsOfTheAxes) {
  const EllipsoidAnchors anchors(sphere, 0.005);
  ASSERT_EQ(anchors.points_m().size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR((anchors.points_m()[i] - sphere.center_m()).norm(), 0.03, 1e-15);
    EXPECT_EQ(anchors.held()[i], i == 5);
    EXPECT_EQ(anchors.reasons()[i], AnchorReason::sphere_axis);
  }
  const scene::Ellipsoid ellipsoid(Vec3(0.0, 0.0, 0.02), Vec3(0.04, 0.03, 0.02));
  const EllipsoidAnchors on_ellipsoid(ellipsoid, 0.0);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 out = on_ellipsoid.points_m()[i] - ellipsoid.center_m();
    EXPECT_NEAR(out.cwiseAbs().cwiseQuotient(ellipsoid.semi_axes_m()).sum(), 1.0, 1e-15);
    EXPECT_EQ(on_ellipsoid.reasons()[i], i < 2   ? AnchorReason::curvature_maximum
                                         : i < 4 ? AnchorReason::curvature_saddle
                                                 : AnchorReason::curvature_minimum);
  }
}

TEST(EllipsoidAnchors, ASphereIsTheEllipsoidOfEqualAxes) {
  const EllipsoidAnchors as_sphere(sphere, 0.005);
  const EllipsoidAnchors as_ellipsoid(scene::Ellipsoid(sphere.center_m(), Vec3::Constant(0.03)), 0.005);
  EXPECT_EQ(as_sphere.points_m(), as_ellipsoid.points_m());
  for (int patch = 0; patch < 8; ++patch) {
    const Vec3 p = sphere.at(patch, 0.3, 0.6).point_m;
    EXPECT_EQ(as_sphere.at(patch, p).weight, as_ellipsoid.at(patch, p).weight);
    EXPECT_EQ(as_sphere.at(patch, p).free, as_ellipsoid.at(patch, p).free);
  }
}

TEST(EllipsoidAnchors, HalvesAQuarterOfTheSectionByItsLength) {
  const EllipsoidAnchors anchors(scene::Ellipsoid(Vec3::Zero(), Vec3(0.04, 0.02, 0.03)), -0.01);
  const Vec3 half = anchors.halfway_m(0, 0, 2);
  // Both parts of the quarter by their chords.
  const auto length_m = [](double from, double to) {
    double sum = 0.0;
    for (int i = 0; i < 20000; ++i) {
      const double a = from + (to - from) * i / 20000.0, b = from + (to - from) * (i + 1) / 20000.0;
      sum += std::hypot(0.04 * (std::cos(b) - std::cos(a)), 0.02 * (std::sin(b) - std::sin(a)));
    }
    return sum;
  };
  const double t = std::atan2(half.y() / 0.02, half.x() / 0.04);
  EXPECT_NEAR(length_m(0.0, t), length_m(t, std::acos(0.0)), 1e-8);
}

TEST(EllipsoidAnchors, HeldSurfaceHangsOnTheHeldPole) {
  const EllipsoidAnchors anchors(sphere, 0.005);
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

TEST(RevolutionAnchors, StandOnFourAxesFromTheBottomUp) {
  const scene::Body body = test::round_body(scene::cylinder_profile(0.02, 0.05, 0.0));
  const auto shape = scene::body_shape(body);
  const auto anchors = anchor_points(body, *shape);
  ASSERT_EQ(anchors->points_m().size(), 8u);
  const Vec3 out[] = {{0.02, 0, 0}, {0, 0.02, 0}, {-0.02, 0, 0}, {0, -0.02, 0}};
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LT((anchors->points_m()[i] - out[i % 4] - Vec3(0, 0, i < 4 ? 0.0 : 0.05)).norm(), 1e-15);
    EXPECT_EQ(anchors->held()[i], i < 4);
    EXPECT_EQ(anchors->reasons()[i], AnchorReason::profile_corner);
  }
}

TEST(RevolutionAnchors, ACapIsLinearOverItsDiamond) {
  const scene::Body body = test::round_body(scene::capsule_profile(0.02, 0.03), 0.006);
  const auto shape = scene::body_shape(body);
  const auto anchors = anchor_points(body, *shape);
  const int cap = shape->patch_count() - 1;
  const PatchPlace pole = anchors->at(cap, Vec3(0.0, 0.0, 0.07));
  for (const double weight : pole.weight) EXPECT_NEAR(weight, 0.25, 1e-15);
  // A displacement that is linear over the square is reproduced: +x rises by 1, -x falls by 1, half way out by half.
  const Vec3 half(0.02 * std::sqrt(0.5), 0.0, 0.05 + 0.02 * std::sqrt(0.5));
  const PatchPlace at = anchors->at(cap, half);
  EXPECT_NEAR(at.weight[0] - at.weight[2], 0.5, 1e-12);
  EXPECT_NEAR(at.weight[1] - at.weight[3], 0.0, 1e-12);
}

TEST(RevolutionAnchors, ABandIsLinearInTheArcLengthAndAlongTheChord) {
  const scene::Body body = test::round_body(test::barrel_profile());
  const auto shape = scene::body_shape(body);
  const auto anchors = anchor_points(body, *shape);
  for (const double u : {0.0, 0.3, 0.5, 1.0}) {
    for (const double v : {0.0, 0.25, 0.8, 1.0}) {       // of the arc, whose parameter is its length
      const scene::SurfacePoint p = shape->at(2, u, v);  // the second quadrant of the side
      const PatchPlace at = anchors->at(2, p.point_m);
      EXPECT_NEAR(at.weight[2] + at.weight[3], v, 1e-12);
      const double phi = u * std::acos(0.0);
      EXPECT_NEAR(at.weight[1] + at.weight[3], std::sin(phi) / (std::sin(phi) + std::cos(phi)), 1e-12);
    }
  }
}

TEST(RevolutionAnchors, ADomeStandsOnItsHeldPole) {
  const scene::Body body = test::round_body(scene::capsule_profile(0.02, 0.03), 0.006);
  const auto shape = scene::body_shape(body);
  const auto anchors = anchor_points(body, *shape);
  ASSERT_EQ(anchors->points_m().size(), 9u);
  EXPECT_LT(anchors->points_m()[0].norm(), 1e-15);
  EXPECT_EQ(anchors->reasons()[0], AnchorReason::support);
  EXPECT_TRUE(anchors->held()[0]);
  EXPECT_EQ(std::count(anchors->held().begin(), anchors->held().end(), true), 1);
  // Half way in height from the support to the circle, half the circle's displacement.
  const double z = 0.013, r = std::sqrt(0.02 * 0.02 - (0.02 - z) * (0.02 - z));
  const PatchPlace at = anchors->at(0, Vec3(0.6 * r, 0.8 * r, z));
  EXPECT_NEAR(at.weight[2], 0.5, 1e-12);
  EXPECT_NEAR(at.weight[1] / at.weight[0], 0.8 / 0.6, 1e-12);
}

TEST(RevolutionAnchors, ASpheresProfileHasCirclesWhereItsPiecesMeet) {
  const scene::Body body = test::round_body(test::sphere_profile(), 0.004);
  const auto shape = scene::body_shape(body);
  const auto anchors = anchor_points(body, *shape);
  EXPECT_EQ(anchors->points_m().size(), 5u);  // four on the joint's circle, and the held pole
  EXPECT_EQ(anchors->reasons()[1], AnchorReason::sphere_axis);
}

}  // namespace
}  // namespace touchstone::fast
