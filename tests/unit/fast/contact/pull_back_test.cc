#include "fast/contact/pull_back.h"

#include "fast/contact/tool_samples.h"
#include "support/deformed_surface.h"
#include "support/points.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>
#include <vector>

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
};

/// A surface displaced by any function of the rest point.
template <class Field>
class Displaced final : public DisplacedSurface {
 public:
  explicit Displaced(Field field) : field_(std::move(field)) {}
  void displace(int, PointLanes& lanes) const noexcept override {
    for (std::size_t v = 0; v < PointLanes::size; ++v) {
      const Vec3 u_m = field_(Vec3(lanes.point_m[0][v], lanes.point_m[1][v], lanes.point_m[2][v]));
      for (std::size_t axis = 0; axis < 3; ++axis) lanes.displacement_m[axis][v] = u_m[static_cast<int>(axis)];
    }
  }

 private:
  Field field_;
};

constexpr int samples_max = 4000;

constexpr double tool_radius_m = 0.008;
const ToolSamples& ball() {
  static const ToolSamples tool = sample_tool(test::ball(tool_radius_m), 1000);
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
  /// Points without a tool: all are one region.
  void lay(const std::vector<Vec3>& places_m) {
    points.count = static_cast<int>(places_m.size());
    for (std::size_t i = 0; i < places_m.size(); ++i) {
      points.x_W_m[i] = places_m[i].x();
      points.y_W_m[i] = places_m[i].y();
      points.z_W_m[i] = places_m[i].z();
      points.area_m2[i] = 1e-6;
      points.depth_m[i] = -body->signed_distance_m(places_m[i]);
      points.sample[i] = static_cast<std::int32_t>(i);
    }
  }
  /// Takes the laid points back. @returns per place the distance it has to the displaced surface, inf where dropped
  template <class Field>
  std::vector<double> distances_m(const std::vector<Vec3>& places_m, const Field& field) {
    lay(places_m);
    summary = detection().pull_back(*body, Displaced<Field>(field), points, scratch);
    std::vector<double> out(places_m.size(), std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < static_cast<std::size_t>(points.count); ++k)
      out[static_cast<std::size_t>(points.sample[k])] = -points.depth_m[k];
    return out;
  }
  Detection detection() const { return detection_for(*body); }
  std::unique_ptr<const scene::Shape> body;
  test::OwnedPoints points{samples_max};
  PullBackScratch scratch{samples_max};
  InsideSummary summary;
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
    std::vector<Vec3> places_m;
    for (std::size_t i = 0; i < static_cast<std::size_t>(ball().count()); ++i) {
      const Vec3 p_m = at_m + Vec3(ball().x_T_m[i], ball().y_T_m[i], ball().z_T_m[i]);
      if (body->signed_distance_m(p_m) <= 0.001) places_m.push_back(p_m);
    }
    const std::vector<double> distance_m = distances_m(places_m, dimple);
    for (std::size_t k = 0; k < static_cast<std::size_t>(points.count); ++k)
      EXPECT_NEAR(-body->signed_distance_m(points.p_W_m(k)), points.depth_m[k], 1e-14);
    for (std::size_t i = 0; i < places_m.size(); ++i) {
      const Vec3& p_m = places_m[i];
      const test::DeformedSurface::Answer truth = deformed.query(p_m);
      ++samples;
      disagree += (distance_m[i] < 0.0) != (truth.signed_distance_m < 0.0);
      if (truth.signed_distance_m >= 0.0 || distance_m[i] >= 0.0) continue;
      ++inside;
      const double error_m = std::abs(distance_m[i] - truth.signed_distance_m);
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

TEST_P(PullBack, OfABodyAtRestKeepsTheInsidePointsWhereTheyAre) {
  std::vector<Vec3> places_m;
  for (int i = 0; i < 500; ++i) places_m.emplace_back(between(-0.05, 0.05), between(-0.05, 0.05), between(-0.01, 0.07));
  distances_m(places_m, [](const Vec3&) { return Vec3(0, 0, 0); });
  std::vector<std::int32_t> inside;
  for (std::size_t i = 0; i < places_m.size(); ++i)
    if (body->signed_distance_m(places_m[i]) < 0.0) inside.push_back(static_cast<std::int32_t>(i));
  ASSERT_EQ(static_cast<std::size_t>(points.count), inside.size());
  for (std::size_t k = 0; k < inside.size(); ++k) {
    EXPECT_EQ(points.sample[k], inside[k]);
    EXPECT_LT((points.p_W_m(k) - places_m[static_cast<std::size_t>(inside[k])]).norm(), 1e-15);
  }
}

TEST_P(PullBack, OfAMovedBodyIsTheMove) {
  const Vec3 move_m(0.001, -0.002, 0.0015);
  const Vec3 p_m = on_top(0.004, 0.003) - Vec3(0, 0, 0.002) + move_m;
  distances_m({p_m}, [&](const Vec3&) { return move_m; });
  ASSERT_EQ(points.count, 1);
  EXPECT_LT((points.p_W_m(0) + move_m - p_m).norm(), 2e-5);
}

TEST_P(PullBack, DropsWhatIsNoLongerInsideAndKeepsTheRest) {
  const Dimple dimple{on_top(0.0, 0.0), Vec3(0, 0, -0.003), 0.012};
  Placement at;
  at.origin_W_m = on_top(0.010, 0.0) + Vec3(0, 0, tool_radius_m - 0.003);
  test::OwnedPoints before(ball().count());
  detection().find_inside(*body, ball(), at, 0.0, ball().count(), points);
  detection().find_inside(*body, ball(), at, 0.0, ball().count(), before);
  summary = detection().pull_back(*body, Displaced<Dimple>(dimple), points, scratch);
  ASSERT_GT(points.count, 5);
  ASSERT_LT(points.count, before.count - 5);
  std::size_t k = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(before.count) && k < static_cast<std::size_t>(points.count);
       ++i) {
    if (points.sample[k] != before.sample[i]) continue;
    EXPECT_EQ(points.p_T_m(k), before.p_T_m(i));
    EXPECT_EQ(points.area_m2[k], before.area_m2[i]);
    ++k;
  }
  EXPECT_EQ(k, static_cast<std::size_t>(points.count));  // in their order
  const InsideSummary again = detection().summarise(*body, points);
  EXPECT_LT((summary.normal_sum - again.normal_sum).norm(), 1e-9 * again.weight_sum);
  EXPECT_NEAR(summary.weight_sum, again.weight_sum, 1e-9 * again.weight_sum);
  EXPECT_NEAR(summary.deepest_m, again.deepest_m, 1e-14);
}

/// A box whose top has gone down, and nothing else.
struct SunkenTop final : DisplacedSurface {
  void displace(int patch, PointLanes& lanes) const noexcept override {
    lanes.displacement_m = {};
    if (patch == 5) lanes.displacement_m[2].fill(-0.0015);
  }
};

TEST(PullBackOfABox, APointBesideTheEdgeBelongsToItsOwnFace) {
  const scene::Box box(Vec3(0.0, 0.0, 0.03), Vec3(0.06, 0.06, 0.06));
  const Vec3 places_m[] = {{0.0240, 0.0, 0.0598}, {0.0295, 0.0, 0.0590}, {0.0240, 0.001, 0.0582}};
  test::OwnedPoints points(3);
  points.count = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    points.x_W_m[i] = places_m[i].x();
    points.y_W_m[i] = places_m[i].y();
    points.z_W_m[i] = places_m[i].z();
    points.area_m2[i] = 1e-6;
    points.sample[i] = static_cast<std::int32_t>(i);
    points.depth_m[i] = -box.signed_distance_m(places_m[i]);
  }
  PullBackScratch scratch(3);
  detection_for(box).pull_back(box, SunkenTop(), points, scratch);
  ASSERT_EQ(points.count, 2);  // the first stands over the sunken top
  EXPECT_EQ(points.sample[0], 1);
  EXPECT_NEAR(points.depth_m[0], 0.0005, 1e-12);
  EXPECT_EQ(points.sample[1], 2);
  EXPECT_NEAR(points.depth_m[1], 0.0003, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Bodies, PullBack, testing::Bool(),
                         [](const auto& parameter) { return parameter.param ? "Box" : "Ellipsoid"; });

}  // namespace
}  // namespace touchstone::fast
