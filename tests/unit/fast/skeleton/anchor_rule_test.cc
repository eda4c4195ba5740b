#include "fast/skeleton/anchor_rule.h"

#include "scene/shape/surface.h"
#include "support/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

int count(const std::vector<FoundAnchor>& found, AnchorReason reason) {
  return static_cast<int>(
      std::count_if(found.begin(), found.end(), [&](const FoundAnchor& a) { return a.reason == reason; }));
}

/// The found anchor point at a place, or null.
const FoundAnchor* at(const std::vector<FoundAnchor>& found, const Vec3& point_m, double within_m = 1e-6) {
  const auto here = std::find_if(found.begin(), found.end(),
                                 [&](const FoundAnchor& a) { return (a.point_m - point_m).norm() < within_m; });
  return here == found.end() ? nullptr : &*here;
}

std::vector<FoundAnchor> on_profile(const scene::Profile& profile) {
  return find_anchor_points(scene::Revolution(profile));
}

TEST(AnchorRule, OfABoxAreItsVertices) {
  const scene::Box box(Vec3(0.01, 0.0, 0.02), Vec3(0.06, 0.05, 0.04));
  const std::vector<FoundAnchor> found = find_anchor_points(box);
  ASSERT_EQ(found.size(), 8u);
  EXPECT_EQ(count(found, AnchorReason::natural_vertex), 8);
  for (const double x : {-0.03, 0.03}) {
    for (const double y : {-0.025, 0.025}) {
      for (const double z : {-0.02, 0.02}) EXPECT_NE(at(found, box.center_m() + Vec3(x, y, z)), nullptr);
    }
  }
}

TEST(AnchorRule, OfASphereAreSixOnThreePerpendicularAxes) {
  const Vec3 center(0.0, 0.01, 0.03);
  const std::vector<FoundAnchor> found = find_anchor_points(scene::Sphere(center, 0.03));
  ASSERT_EQ(found.size(), 6u);
  EXPECT_EQ(count(found, AnchorReason::sphere_axis), 6);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) EXPECT_NE(at(found, center + sign * 0.03 * Vec3::Unit(axis)), nullptr);
  }
}

TEST(AnchorRule, OfAnEllipsoidAreTheEndsOfItsAxesWhateverTheirOrder) {
  const Vec3 center(0.01, -0.02, 0.05);
  for (const Vec3& a :
       {Vec3(0.04, 0.03, 0.02), Vec3(0.03, 0.02, 0.04), Vec3(0.02, 0.04, 0.03), Vec3(0.02, 0.03, 0.04)}) {
    const std::vector<FoundAnchor> found = find_anchor_points(scene::Ellipsoid(center, a));
    ASSERT_EQ(found.size(), 6u) << a.transpose();
    for (int axis = 0; axis < 3; ++axis) {
      // By hand: the Gaussian curvature at the end of axis k is a_k^2 over the product of the other two squared.
      const AnchorReason expected = a[axis] == 0.04   ? AnchorReason::curvature_maximum
                                    : a[axis] == 0.03 ? AnchorReason::curvature_saddle
                                                      : AnchorReason::curvature_minimum;
      for (const double sign : {-1.0, 1.0}) {
        const FoundAnchor* here = at(found, center + sign * a[axis] * Vec3::Unit(axis));
        ASSERT_NE(here, nullptr) << a.transpose();
        EXPECT_EQ(here->reason, expected) << words(here->reason);
      }
    }
  }
}

TEST(AnchorRule, NearlyEqualAxesLoseNoPoint) {
  for (const double more : {0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 0.03}) {
    for (const Vec3& a :
         {Vec3(0.03, 0.03 * (1.0 + more), 0.02), Vec3(0.03, 0.03 * (1.0 + more), 0.04),
          Vec3(0.02, 0.03, 0.03 * (1.0 + more)), Vec3(0.03, 0.03 * (1.0 + more), 0.03 * (1.0 + 2.0 * more))}) {
      const std::vector<FoundAnchor> found = find_anchor_points(scene::Ellipsoid(Vec3::Zero(), a));
      ASSERT_EQ(found.size(), 6u) << more << ": " << a.transpose();
      for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
          EXPECT_NE(at(found, sign * a[axis] * Vec3::Unit(axis), 1e-5), nullptr) << more << ": " << a.transpose();
        }
      }
    }
  }
}

/// Another shape, rotated about the origin: the rule must not depend on the axes.
class Turned final : public scene::Shape {
 public:
  Turned(const scene::Shape& inner, const Eigen::Quaterniond& turn) : inner_(inner), turn_(turn) {}
  [[nodiscard]] int patch_count() const noexcept override { return inner_.patch_count(); }
  [[nodiscard]] scene::SurfacePoint at(int patch, double u, double v) const noexcept override {
    scene::SurfacePoint p = inner_.at(patch, u, v);
    p.point_m = turn_ * p.point_m;
    p.normal = turn_ * p.normal;
    return p;
  }
  [[nodiscard]] scene::SurfaceQuery query(const Vec3& p_m) const noexcept override {
    scene::SurfaceQuery q = inner_.query(turn_.inverse() * p_m);
    q.point_m = turn_ * q.point_m;
    q.normal = turn_ * q.normal;
    return q;
  }
  [[nodiscard]] double signed_distance_m(const Vec3& p_m) const noexcept override {
    return inner_.signed_distance_m(turn_.inverse() * p_m);
  }
  [[nodiscard]] double area_m2() const noexcept override { return inner_.area_m2(); }
  [[nodiscard]] double volume_m3() const noexcept override { return inner_.volume_m3(); }
  [[nodiscard]] scene::Bounds bounds() const noexcept override { return inner_.bounds(); }
  [[nodiscard]] scene::Surface tessellated(int triangles) const override { return inner_.tessellated(triangles); }

 private:
  const scene::Shape& inner_;
  Eigen::Quaterniond turn_;
};

TEST(AnchorRule, FollowsATurnedEllipsoidAndATurnedSpheroid) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.9, Vec3(0.3, -0.7, 0.5).normalized()));
  const Vec3 a(0.04, 0.03, 0.02);
  const scene::Ellipsoid ellipsoid(Vec3::Zero(), a);
  const std::vector<FoundAnchor> found = find_anchor_points(Turned(ellipsoid, turn));
  ASSERT_EQ(found.size(), 6u);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      EXPECT_NE(at(found, turn * Vec3(sign * a[axis] * Vec3::Unit(axis)), 1e-4), nullptr) << axis;
    }
  }
  // A spheroid keeps its two poles; the four points of its equator are on two perpendicular axes.
  const scene::Ellipsoid spheroid(Vec3::Zero(), Vec3(0.03, 0.03, 0.02));
  const std::vector<FoundAnchor> around = find_anchor_points(Turned(spheroid, turn));
  ASSERT_EQ(around.size(), 6u);
  EXPECT_NE(at(around, turn * Vec3(0, 0, 0.02), 1e-4), nullptr);
  EXPECT_NE(at(around, turn * Vec3(0, 0, -0.02), 1e-4), nullptr);
  int perpendicular = 0, opposite = 0;
  for (const FoundAnchor& p : around) {
    for (const FoundAnchor& q : around) {
      const double cosine = p.point_m.normalized().dot(q.point_m.normalized());
      if (std::abs(cosine) < 1e-3) ++perpendicular;
      if (cosine < -1.0 + 1e-6) ++opposite;
    }
  }
  EXPECT_EQ(perpendicular, 24);
  EXPECT_EQ(opposite, 6);
}

TEST(AnchorRule, OfSurfacesOfRevolutionAreFourPerCircleAndTheTips) {
  struct Expected {
    const char* name;
    scene::Profile profile;
    std::vector<std::pair<Eigen::Vector2d, AnchorReason>> circles;
    std::vector<double> tips;
  };
  const double r = 0.02, l = 0.03, f = 0.004;
  using enum AnchorReason;
  const std::vector<Expected> all{
      {"cylinder",
       scene::cylinder_profile(r, l, 0.0),
       {{{r, -l / 2}, profile_corner}, {{r, l / 2}, profile_corner}},
       {}},
      {"rounded cylinder",
       scene::cylinder_profile(r, l, f),
       {{{r - f, -l / 2}, curvature_jump},
        {{r, -l / 2 + f}, curvature_jump},
        {{r, l / 2 - f}, curvature_jump},
        {{r - f, l / 2}, curvature_jump}},
       {}},
      {"frustum", test::frustum_profile(), {{{0.025, 0.0}, profile_corner}, {{0.012, 0.04}, profile_corner}}, {}},
      {"barrel", test::barrel_profile(), {{{0.018, 0.0}, profile_corner}, {{0.018, 0.05}, profile_corner}}, {}},
      {"capsule", scene::capsule_profile(r, l), {{{r, -l / 2}, curvature_jump}, {{r, l / 2}, curvature_jump}}, {}},
      {"cone", test::cone_profile(), {{{0.025, 0.0}, profile_corner}}, {0.04}},
      {"double cone", test::double_cone_profile(), {{{0.03, 0.03}, profile_corner}}, {0.0, 0.07}},
      {"pill", test::pill_profile(), {{{0.02, 0.0}, curvature_jump}, {{0.02, 0.02}, curvature_jump}}, {}}};
  for (const Expected& expected : all) {
    const std::vector<FoundAnchor> found = on_profile(expected.profile);
    EXPECT_EQ(found.size(), 4 * expected.circles.size() + expected.tips.size()) << expected.name;
    for (const auto& [rz, reason] : expected.circles) {
      for (int quarter = 0; quarter < 4; ++quarter) {
        const double angle = 0.5 * std::numbers::pi * quarter;
        const FoundAnchor* here = at(found, Vec3(rz.x() * std::cos(angle), rz.x() * std::sin(angle), rz.y()), 1e-9);
        ASSERT_NE(here, nullptr) << expected.name;
        EXPECT_EQ(here->reason, reason) << expected.name << ": " << words(here->reason);
      }
    }
    for (const double z : expected.tips) {
      const FoundAnchor* here = at(found, Vec3(0.0, 0.0, z), 1e-9);
      ASSERT_NE(here, nullptr) << expected.name;
      EXPECT_EQ(here->reason, natural_vertex) << expected.name;
    }
  }
  // Constant curvature: a sphere, however it is written.
  const std::vector<FoundAnchor> sphere = on_profile(test::sphere_profile());
  EXPECT_EQ(sphere.size(), 6u);
  EXPECT_EQ(count(sphere, sphere_axis), 6);
}

/// A curve by its normal's angle above the horizontal; the curvature is the derivative. Positions do not matter.
CurvePiece piece(double length_m, const std::function<double(double)>& angle,
                 const std::function<double(double)>& rate) {
  return {length_m, [=](double s) {
            return CurvePiece::Point{Eigen::Vector2d::Zero(), {std::cos(angle(s)), std::sin(angle(s))}, rate(s)};
          }};
}

TEST(AnchorRule, LooksInsideThePiecesOfAProfile) {
  const double quarter = 0.5 * std::numbers::pi;
  const auto turning = [&](double s) { return -quarter + 2.0 * quarter * s; };
  // Curvature 2 + cos(4 pi s): maxima on both poles and in the middle, minima at a quarter and three quarters.
  const CurvePiece wavy = piece(1.0, turning, [](double s) { return 2.0 + std::cos(4.0 * std::numbers::pi * s); });
  const std::vector<CurveAnchor> waves = curve_anchors({&wavy, 1});
  ASSERT_EQ(waves.size(), 5u);
  const double expected[] = {0.0, 0.25, 0.5, 0.75, 1.0};
  for (std::size_t i = 0; i < 5; ++i) {
    const bool found = std::any_of(waves.begin(), waves.end(), [&](const CurveAnchor& a) {
      return std::abs(a.s - expected[i]) < 1e-6 &&
             a.reason == (i % 2 == 0 ? AnchorReason::curvature_maximum : AnchorReason::curvature_minimum);
    });
    EXPECT_TRUE(found) << expected[i];
  }
  // A change of sign.
  const CurvePiece bent = piece(1.0, turning, [](double s) { return s - 0.3; });
  const std::vector<CurveAnchor> inflected = curve_anchors({&bent, 1});
  EXPECT_EQ(std::count_if(inflected.begin(), inflected.end(),
                          [](const CurveAnchor& a) {
                            return a.reason == AnchorReason::inflection && std::abs(a.s - 0.3) < 1e-9;
                          }),
            1);
  // Curvature continuous, its derivative not: s below the joint, constant above.
  const std::vector<CurvePiece> ramp{piece(
                                         1.0, [](double s) { return 0.5 * s * s; }, [](double s) { return s; }),
                                     piece(
                                         1.0, [](double s) { return 0.5 + s; }, [](double) { return 1.0; })};
  const std::vector<CurveAnchor> rate = curve_anchors(ramp);
  EXPECT_EQ(std::count_if(rate.begin(), rate.end(),
                          [](const CurveAnchor& a) {
                            return a.reason == AnchorReason::curvature_rate_jump && a.piece == 0 && a.s == 1.0;
                          }),
            1);
  // The middle of a symmetric curve, written as two pieces, is still its minimum; a stretch of constant curvature is
  // none.
  const auto bowl = [](double x) { return 1.0 + x * x; };
  const std::vector<CurvePiece> halves{piece(1.0, turning, [&](double s) { return bowl(s - 1.0); }),
                                       piece(
                                           1.0, [&](double) { return quarter; }, [&](double s) { return bowl(s); })};
  const std::vector<CurveAnchor> middle = curve_anchors(halves);
  EXPECT_EQ(std::count_if(middle.begin(), middle.end(),
                          [](const CurveAnchor& a) {
                            return a.reason == AnchorReason::curvature_minimum && a.piece == 0 && a.s == 1.0;
                          }),
            1);
  const CurvePiece plateau = piece(1.0, turning, [](double s) { return 1.0 - std::max(0.0, std::abs(s - 0.5) - 0.1); });
  for (const CurveAnchor& a : curve_anchors({&plateau, 1})) EXPECT_TRUE(a.s == 0.0 || a.s == 1.0) << a.s;
}

}  // namespace
}  // namespace touchstone::fast
