#include "scene/shape/revolution.h"
#include "scene/model/scene.h"

#include <gmock/gmock.h>

#include <numbers>

namespace touchstone::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Vec2 = Eigen::Vector2d;

constexpr double pi = std::numbers::pi;

TEST(Profile, RefusesWhatSweepsNoConvexBody) {
  const auto fault = [](std::vector<Vec2> corners, std::vector<double> arcs = {}) {
    const auto faults = profile_faults({std::move(corners), std::move(arcs)});
    return faults.empty() ? std::string() : faults.front();
  };
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), "");
  EXPECT_THAT(fault({{0, 0}, {0, 1}}), HasSubstr("at least three corners, found 2"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {0, 1}}, {0}), HasSubstr("one arc radius per piece, 2, found 1"));
  EXPECT_THAT(fault({{0.1, 0}, {1, 0}, {0, 1}}), HasSubstr("corner 0 at (r, z) = (0.1, 0) m is off the axis"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {0.5, 1}}), HasSubstr("corner 2 at (r, z) = (0.5, 1) m is off the axis"));
  EXPECT_THAT(fault({{0, 0}, {-1, 0}, {0, 1}}), HasSubstr("negative radius"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {0, 1}, {0, 2}}), HasSubstr("corner 2 at (r, z) = (0, 1) m touches the axis"));
  EXPECT_THAT(fault({{0, 0}, {1, NAN}, {0, 1}}), HasSubstr("not finite"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {1, 0}, {0, 1}}),
              HasSubstr("the piece after corner 1 at (r, z) = (1, 0) m has no length"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {0.5, 0.5}, {1, 1}, {0, 1}}),
              HasSubstr("corner 2 at (r, z) = (0.5, 0.5) m turns inwards"));
  EXPECT_THAT(fault({{0, 0}, {1, -0.1}, {0, 1}}), HasSubstr("corner 0 at (r, z) = (0, 0) m turns inwards"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {1, 1}, {0, 0.9}}), HasSubstr("corner 3 at (r, z) = (0, 0.9) m dips inwards"));
  EXPECT_THAT(fault({{0, 1}, {1, 1}, {0, 0}}), HasSubstr("inwards"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 0.4, 0}), HasSubstr("half its chord, 0.5 m"));
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, -1, 0}), HasSubstr("arc radius -1 m"));
  EXPECT_THAT(fault({{0, -1}, {0.5, 0}, {0, 1}}, {0, 0.5 * std::sqrt(1.25)}), HasSubstr("half its chord"));
  // A fillet with too large a radius joins the side at an angle, but outwards: convex. With too small a radius it is
  // not.
  EXPECT_EQ(fault({{0, 0}, {0.8, 0}, {1, 0.2}, {1, 1}, {0, 1}}, {0, 0.3, 0, 0}), "");
  EXPECT_THAT(fault({{0, 0}, {0.8, 0}, {1, 0.2}, {1, 1}, {0, 1}}, {0, 0.19, 0, 0}),
              HasSubstr("corner 1 at (r, z) = (0.8, 0) m turns inwards"));
  // An arc may bulge beyond its corners, but not overhang the top.
  EXPECT_EQ(fault({{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 2, 0}), "");
  EXPECT_THAT(fault({{0, 0}, {1, 0}, {0.5, 1}, {0, 1}}, {0, 0.6, 0}), HasSubstr("corner 2 at (r, z) = (0.5, 1) m"));
}

TEST(Profile, NamedShapesAreSoundAndLeaveOutWhatHasNoLength) {
  for (const Profile& profile :
       {capsule_profile(0.01, 0.03), capsule_profile(0.01, 0.0), cylinder_profile(0.02, 0.03, 0.0),
        cylinder_profile(0.02, 0.03, 0.004), cylinder_profile(0.02, 0.04, 0.02), cylinder_profile(0.02, 0.03, 0.015)}) {
    EXPECT_THAT(profile_faults(profile), IsEmpty());
  }
  EXPECT_EQ(capsule_profile(0.01, 0.0).rz_m.size(), 3u);
  EXPECT_EQ(cylinder_profile(0.02, 0.03, 0.0).rz_m.size(), 4u);
  EXPECT_EQ(cylinder_profile(0.02, 0.04, 0.02).rz_m.size(), 3u);
  EXPECT_EQ(cylinder_profile(0.02, 0.03, 0.015).rz_m.size(), 5u);
}

TEST(Revolution, ClosedFormsOfAreaVolumeAndBounds) {
  const Revolution capsule(capsule_profile(0.01, 0.03), Vec3(1, 2, 3));
  EXPECT_NEAR(capsule.area_m2(), 2 * pi * 0.01 * 0.03 + 4 * pi * 1e-4, 1e-17);
  EXPECT_NEAR(capsule.volume_m3(), pi * 1e-4 * 0.03 + 4.0 / 3.0 * pi * 1e-6, 1e-19);
  EXPECT_LT((capsule.bounds().upper_m - Vec3(1.01, 2.01, 3.025)).norm(), 1e-15);
  const Revolution cone({{Vec2(0, 0), Vec2(0.03, 0), Vec2(0, 0.04)}, {}});
  EXPECT_NEAR(cone.area_m2(), pi * 0.03 * 0.03 + pi * 0.03 * 0.05, 1e-17);
  EXPECT_NEAR(cone.volume_m3(), pi * 0.03 * 0.03 * 0.04 / 3, 1e-19);
  // An arc that bulges beyond its corners: a barrel as a zone of a ball.
  const Revolution barrel({{Vec2(0, -0.03), Vec2(0.04, -0.03), Vec2(0.04, 0.03), Vec2(0, 0.03)}, {0, 0.05, 0}});
  EXPECT_NEAR(barrel.bounds().upper_m.x(), 0.05, 1e-16);
  EXPECT_NEAR(barrel.area_m2(), 2 * pi * 0.05 * 0.06 + 2 * pi * 0.0016, 1e-16);
  EXPECT_NEAR(barrel.volume_m3(), 2 * pi * (0.0025 * 0.03 - 0.03 * 0.03 * 0.03 / 3), 1e-18);
}

TEST(Revolution, AgreesWithTheSphereItSweeps) {
  const Revolution turned(capsule_profile(0.03, 0.0), Vec3(0.1, 0.2, 0.3));
  const Sphere sphere(Vec3(0.1, 0.2, 0.3), 0.03);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = sphere.center_m() + 0.05 * Vec3(std::sin(3.0 * i), std::sin(5.0 * i + 1), std::sin(7.0 * i + 2));
    EXPECT_NEAR(turned.signed_distance_m(p), sphere.signed_distance_m(p), 1e-16);
    EXPECT_LT((turned.query(p).normal - sphere.query(p).normal).norm(), 1e-12);
  }
}

TEST(Revolution, PatchesAsTheHeaderNumbersThem) {
  const auto wholes = [](const Revolution& shape) {
    std::vector<int> counts;
    for (int k = 0; k < shape.piece_count(); ++k) {
      counts.push_back(shape.piece(k).patch_count());
      for (int q = 0; q < shape.piece(k).patch_count(); ++q) {
        const int patch = shape.piece(k).first_patch + q;
        EXPECT_EQ(shape.piece_of(patch), k);
        EXPECT_EQ(shape.quadrant_of(patch), shape.piece(k).whole ? -1 : q);
      }
    }
    return counts;
  };
  EXPECT_THAT(wholes(Revolution(capsule_profile(0.01, 0.03))), ElementsAre(4, 4, 1));
  EXPECT_THAT(wholes(Revolution(cylinder_profile(0.01, 0.03, 0))), ElementsAre(1, 4, 1));
  EXPECT_THAT(wholes(Revolution(cylinder_profile(0.01, 0.03, 0.002))), ElementsAre(1, 4, 4, 4, 1));
  EXPECT_THAT(wholes(Revolution({{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}, {}})), ElementsAre(1, 4));
  EXPECT_THAT(wholes(Revolution({{Vec2(0, -1), Vec2(1, 0), Vec2(0, 1)}, {}})), ElementsAre(4, 4));
  // Collinear straight pieces are joined.
  EXPECT_THAT(wholes(Revolution({{Vec2(0, 0), Vec2(0.5, 0), Vec2(1, 0), Vec2(1, 0.5), Vec2(1, 1), Vec2(0, 1)}, {}})),
              ElementsAre(1, 4, 1));
}

TEST(Revolution, BodyStandsOnTheGroundAndKnowsAFlatBottom) {
  Body body;
  body.shape = BodyShape::revolution;
  body.profile = capsule_profile(0.01, 0.03);
  EXPECT_EQ(body_shape(body)->bounds().lower_m.z(), 0.0);
  EXPECT_FALSE(body.flat_bottom());
  body.profile = cylinder_profile(0.01, 0.03, 0.001);
  EXPECT_TRUE(body.flat_bottom());
  EXPECT_NEAR(body_shape(body)->query(Vec3(0, 0, -1)).signed_distance_m, 1.0, 1e-15);
  const auto solid = solid_shape(body, Vec3(1, 2, 3));
  EXPECT_LT((0.5 * (solid->bounds().lower_m + solid->bounds().upper_m) - Vec3(1, 2, 3)).norm(), 1e-15);
  body.shape = BodyShape::ellipsoid;
  body.semi_axes_m = Vec3(0.3, 0.2, 0.1);
  EXPECT_FALSE(body.flat_bottom());
  EXPECT_EQ(body_shape(body)->bounds().lower_m.z(), 0.0);
  body.shape = BodyShape::box;
  EXPECT_TRUE(body.flat_bottom());
}

}  // namespace
}  // namespace touchstone::scene
