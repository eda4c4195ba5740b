#include "fast/pull_back.h"

#include "fast/tool_samples.h"
#include "unit/fast/deformed_surface.h"
#include "unit/fast/points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

namespace touchstone::fast {
namespace {

using scene::Vec3;

/// A smooth dimple around a rest point.
struct Dimple {
  Vec3 center_m, displacement_m;
  double width_m;
  Vec3 operator()(const Vec3& rest_m) const {
    return std::exp(-(rest_m - center_m).squaredNorm() / (width_m * width_m)) * displacement_m;
  }
  Vec3 operator()(const scene::SurfaceQuery& at) const { return (*this)(at.point_m); }
};

constexpr double tool_radius_m = 0.008;
const ToolSamples& ball() {
  static const ToolSamples tool = sample_tool(scene::Sphere(Vec3::Zero(), tool_radius_m), 1000);
  return tool;
}

class PullBack : public testing::TestWithParam<bool> {
 protected:
  PullBack() {
    if (GetParam()) {
      body = std::make_unique<scene::Box>(Vec3(0.0, 0.0, 0.03), Vec3(0.06, 0.06, 0.06));
    } else {
      body = std::make_unique<scene::Ellipsoid>(Vec3(0.0, 0.0, 0.025), Vec3(0.04, 0.03, 0.025));
    }
  }
  std::unique_ptr<const scene::Shape> body;
  std::mt19937 random{GetParam() ? 1u : 2u};
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 on_top(double x_m, double y_m) const { return body->query(Vec3(x_m, y_m, 0.1)).point_m; }
};

TEST_P(PullBack, IsTheDistanceToTheDeformedSurface) {
  int samples = 0, inside = 0, disagree = 0;
  double worst_m = 0.0, facets_m = 0.0, ignored_m = 0.0;
  for (int scene = 0; scene < 14; ++scene) {
    const double turn = between(0.0, 6.3), width_m = between(0.008, 0.020);
    const Vec3 heading(std::cos(turn), std::sin(turn), 0.0);
    Dimple dimple{on_top(-0.010 * heading.x(), -0.010 * heading.y()), Vec3::Zero(), width_m};
    const Vec3 slant(between(-0.15, 0.15), between(-0.15, 0.15), between(-0.15, 0.15));
    dimple.displacement_m = between(0.002, 0.005) * (slant - body->query(dimple.center_m).normal).normalized();
    const test::DeformedSurface deformed(
        *body, [&](const Vec3& rest_m) { return dimple(rest_m); }, 20000);

    // The tool on the dimple's slope or beside it.
    const scene::SurfaceQuery under =
        body->query(dimple.center_m + between(0.6, 2.2) * width_m * heading + Vec3(0, 0, 0.001));
    const Vec3 at_m = under.point_m + dimple(under.point_m) + (tool_radius_m - between(0.001, 0.004)) * under.normal;
    for (std::size_t i = 0; i < static_cast<std::size_t>(ball().count()); ++i) {
      const Vec3 p_m = at_m + Vec3(ball().x_T_m[i], ball().y_T_m[i], ball().z_T_m[i]);
      if (body->signed_distance_m(p_m) > 0.001) continue;
      const test::DeformedSurface::Answer truth = deformed.query(p_m);
      const PulledBack back = pulled_back(*body, 0.06, dimple, p_m);
      EXPECT_NEAR(body->signed_distance_m(back.x_m), back.signed_distance_m, 1e-14);
      ++samples;
      disagree += (back.signed_distance_m < 0.0) != (truth.signed_distance_m < 0.0);
      if (truth.signed_distance_m >= 0.0) continue;
      ++inside;
      const double error_m = std::abs(back.signed_distance_m - truth.signed_distance_m);
      EXPECT_LT(error_m, std::max(15e-6, -0.01 * truth.signed_distance_m));
      worst_m = std::max(worst_m, error_m);
      facets_m = std::max(facets_m, std::abs(truth.facets_m - truth.signed_distance_m));
      ignored_m = std::max(ignored_m, std::abs(body->signed_distance_m(p_m) - truth.signed_distance_m));
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_LE(disagree, 0.002 * samples);
  EXPECT_LT(worst_m, 15e-6);
  EXPECT_GT(ignored_m, 1e-3);  // without the displacement
  RecordProperty("worst_um", std::to_string(1e6 * worst_m));
  RecordProperty("facets_um", std::to_string(1e6 * facets_m));
  RecordProperty("disagree_of", std::to_string(disagree) + "/" + std::to_string(samples));
}

TEST_P(PullBack, OfABodyAtRestLeavesThePoints) {
  for (int i = 0; i < 500; ++i) {
    const Vec3 p_m(between(-0.05, 0.05), between(-0.05, 0.05), between(-0.01, 0.07));
    const PulledBack back = pulled_back(
        *body, 0.06, [](const scene::SurfaceQuery&) noexcept { return Vec3(0, 0, 0); }, p_m);
    if (body->signed_distance_m(p_m) < 0.0) {
      EXPECT_LT((back.x_m - p_m).norm(), 1e-15);
    }
    EXPECT_NEAR(back.signed_distance_m, body->signed_distance_m(p_m),
                body->signed_distance_m(p_m) < 0.0 ? 1e-15 : 1e-2);
  }
}

TEST_P(PullBack, OfAMovedBodyIsTheMove) {
  const Vec3 move_m(0.001, -0.002, 0.0015);
  const Vec3 p_m = on_top(0.004, 0.003) - Vec3(0, 0, 0.002) + move_m;
  const PulledBack back = pulled_back(
      *body, 0.06, [&](const scene::SurfaceQuery&) noexcept { return move_m; }, p_m);
  EXPECT_LT((back.x_m + move_m - p_m).norm(), 2e-6);
}

TEST_P(PullBack, DropsWhatIsNoLongerInsideAndKeepsTheOrder) {
  const Dimple dimple{on_top(0.0, 0.0), Vec3(0, 0, -0.003), 0.012};
  Placement at;
  at.origin_W_m = on_top(0.010, 0.0) + Vec3(0, 0, tool_radius_m - 0.003);
  const Detection detection = detection_for(GetParam() ? scene::BodyShape::box : scene::BodyShape::ellipsoid);
  test::OwnedPoints points(ball().count()), before(ball().count());
  detection.find_inside(*body, ball(), at, 0.0, ball().count(), points);
  detection.find_inside(*body, ball(), at, 0.0, ball().count(), before);
  pull_back(*body, dimple, points);
  ASSERT_GT(points.count, 5);
  ASSERT_LT(points.count, before.count - 5);
  std::size_t k = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(before.count); ++i) {
    const PulledBack back = pulled_back(*body, GetParam() ? 0.06 : 0.08, dimple, before.p_W_m(i));
    if (back.signed_distance_m >= 0.0) continue;
    ASSERT_LT(k, static_cast<std::size_t>(points.count));
    EXPECT_EQ(points.sample[k], before.sample[i]);
    EXPECT_EQ(points.p_T_m(k), before.p_T_m(i));
    EXPECT_EQ(points.area_m2[k], before.area_m2[i]);
    EXPECT_LT((points.p_W_m(k) - back.x_m).norm(), 1e-15);
    EXPECT_NEAR(points.depth_m[k], -body->signed_distance_m(points.p_W_m(k)), 1e-14);
    ++k;
  }
  EXPECT_EQ(k, static_cast<std::size_t>(points.count));
}

INSTANTIATE_TEST_SUITE_P(Bodies, PullBack, testing::Bool(),
                         [](const auto& parameter) { return parameter.param ? "Box" : "Ellipsoid"; });

}  // namespace
}  // namespace touchstone::fast
