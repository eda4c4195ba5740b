#include "fast/surface/interpolation.h"

#include "fast/step/model.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

namespace touchstone::fast {
namespace {

using scene::Vec3;

struct SurfaceRig {
  explicit SurfaceRig(const scene::Scene& scene)
      : model(scene), field(model.rest), anchor_m(model.skeleton.anchor_m.size()) {
    for (std::size_t i = 0; i < anchor_m.size(); ++i) {
      anchor_m[i] = model.skeleton.held[i]
                        ? Vec3(Vec3::Zero())
                        : Vec3(1e-4 * (1.0 + static_cast<double>(i)), -2e-4, -1e-3 + 1e-4 * static_cast<double>(i));
    }
  }
  FastModel model;
  SurfaceField field;
  std::vector<Vec3> anchor_m;
  ContactPoint contact;

  void touch(const Vec3& p0, const Vec3& displacement_m) {
    const scene::SurfaceQuery at = model.body->query(p0);
    contact.patch = at.patch;
    contact.place = model.anchors->at(at.patch, p0);
    contact.normal = at.normal;
    contact.displacement_m = displacement_m;
  }
  [[nodiscard]] Vec3 displacement_m(int v) const {
    const auto k = static_cast<std::size_t>(v);
    return Vec3(field.displacement_m[0][k], field.displacement_m[1][k], field.displacement_m[2][k]);
  }
  /// Largest difference between vertices of different patches at one place.
  [[nodiscard]] double tear_m() const {
    std::map<std::array<long, 3>, int> first_at;
    double worst_m = 0.0;
    for (int v = 0; v < model.surface.vertex_count(); ++v) {
      const Vec3 place_nm = 1e9 * model.surface.points_m.col(v);
      const auto [first, is_new] =
          first_at.try_emplace({std::lround(place_nm.x()), std::lround(place_nm.y()), std::lround(place_nm.z())}, v);
      if (!is_new) worst_m = std::max(worst_m, (displacement_m(v) - displacement_m(first->second)).norm());
    }
    return worst_m;
  }
};

constexpr Interpolate both[] = {interpolate_published, interpolate_corrected};

TEST(Interpolation, ReproducesTheAnchorsDisplacements) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    for (const Interpolate interpolate : both) {
      SurfaceRig s(scene);
      interpolate(s.model.rest, s.anchor_m, s.contact, s.field);
      int found = 0;
      for (int v = 0; v < s.model.surface.vertex_count(); ++v) {
        for (std::size_t i = 0; i < s.anchor_m.size(); ++i) {
          if ((s.model.surface.points_m.col(v) - s.model.skeleton.anchor_m[i]).norm() > 1e-9) continue;
          ++found;
          // The printed angle keeps the length; only the vector form keeps the direction (errata E15).
          EXPECT_NEAR(s.displacement_m(v).norm(), s.anchor_m[i].norm(), 1e-9);
          if (interpolate == interpolate_corrected) {
            EXPECT_LT((s.displacement_m(v) - s.anchor_m[i]).norm(), 1e-9);
          }
        }
      }
      EXPECT_EQ(found, 24);
    }
  }
}

TEST(Interpolation, ReproducesAConstantOnFreePatches) {
  for (const Interpolate interpolate : both) {
    SurfaceRig s(test::ball_on_cube());
    const Vec3 constant(1e-4, -3e-4, -9e-4);
    for (std::size_t i = 4; i < 8; ++i) s.anchor_m[i] = constant;
    s.touch(Vec3(0.01, -0.004, 0.06), constant);
    interpolate(s.model.rest, s.anchor_m, s.contact, s.field);
    const Patch& top = s.model.rest.patches[5];
    for (int v = top.begin; v < top.end; ++v) EXPECT_LT((s.displacement_m(v) - constant).norm(), 1e-9);
  }
  SurfaceRig s(test::ball_on_sphere());
  const Vec3 constant(1e-4, -3e-4, -9e-4);
  for (std::size_t i = 0; i < 5; ++i) s.anchor_m[i] = constant;
  interpolate_corrected(s.model.rest, s.anchor_m, s.contact, s.field);
  for (int v = 0; v < s.model.rest.patches[4].begin; ++v) EXPECT_LT((s.displacement_m(v) - constant).norm(), 1e-9);
}

TEST(Interpolation, ContactPointTakesItsOwnDisplacement) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    for (const Interpolate interpolate : both) {
      SurfaceRig s(scene);
      for (Vec3& u : s.anchor_m) u *= 0.1;
      // A vertex well inside a free patch as the origin of deformation.
      const Patch& patch = s.model.rest.patches[scene.body.shape == scene::BodyShape::box ? 5 : 0];
      int at_p0 = patch.begin;
      for (int v = patch.begin; v < patch.end; ++v) {
        const Vec3 center = patch.center_W_m;
        if ((s.model.surface.points_m.col(v) - center).norm() < (s.model.surface.points_m.col(at_p0) - center).norm())
          at_p0 = v;
      }
      const Vec3 p0 = s.model.surface.points_m.col(at_p0), D = -0.002 * s.model.surface.normals.col(at_p0);
      s.touch(p0, D);
      interpolate(s.model.rest, s.anchor_m, s.contact, s.field);
      EXPECT_LT((s.displacement_m(at_p0) - D).norm(), interpolate == interpolate_corrected ? 1e-8 : 2e-6);
      EXPECT_LT(s.tear_m(), interpolate == interpolate_corrected ? 1e-9 : 1e-3);
    }
  }
}

TEST(Interpolation, PatchesStayJoinedWhereverTheContactIs) {
  SurfaceRig s(test::ball_on_cube());
  for (const Vec3& p0 : {Vec3(0.0, 0.0, 0.06), Vec3(0.0299, 0.01, 0.06), Vec3(0.03, 0.01, 0.06), Vec3(0.03, 0.03, 0.06),
                         Vec3(0.03, 0.0, 0.001)}) {
    s.touch(p0, Vec3(0.0, 0.0, -0.002));
    interpolate_corrected(s.model.rest, s.anchor_m, s.contact, s.field);
    EXPECT_LT(s.tear_m(), 1e-9);
    for (int v = 0; v < s.model.surface.vertex_count(); ++v) {
      ASSERT_TRUE(s.displacement_m(v).allFinite());
      ASSERT_LT(s.displacement_m(v).norm(), 0.01);
    }
  }
}

TEST(Interpolation, HeldSurfaceStaysPut) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    const double support_m = scene.body.support_height_m;
    for (const Interpolate interpolate : both) {
      SurfaceRig s(scene);
      for (const Vec3& out : {Vec3(0.3, 0.2, 1.0), Vec3(1.0, 0.1, -0.2), Vec3(0.5, 0.4, -0.3)}) {
        const Vec3 p0 = s.model.body->query(Vec3(0.0, 0.0, 0.03) + 0.1 * out.normalized()).point_m;
        s.touch(p0, -0.002 * out.normalized());
        interpolate(s.model.rest, s.anchor_m, s.contact, s.field);
        int held = 0;
        double most_m = 0.0;
        for (int v = 0; v < s.model.surface.vertex_count(); ++v) {
          most_m = std::max(most_m, s.displacement_m(v).norm());
          if (s.model.surface.points_m(2, v) > support_m + 1e-12) continue;
          ++held;
          EXPECT_EQ(s.displacement_m(v), Vec3::Zero());
        }
        EXPECT_GT(held, 10);
        EXPECT_GT(most_m, 5e-4);
      }
    }
  }
}

TEST(Interpolation, PublishedKeepsLengthsAndAnglesOfItsVectors) {
  // One displacement, straight into the top: the printed form and the vector form agree.
  SurfaceRig s(test::ball_on_cube());
  for (std::size_t i = 4; i < 8; ++i) s.anchor_m[i] = Vec3(0.0, 0.0, -4e-4);
  s.touch(Vec3(0.006, 0.0, 0.06), Vec3(0.0, 0.0, -0.002));
  interpolate_published(s.model.rest, s.anchor_m, s.contact, s.field);
  const Columns3 published = s.field.displacement_m;
  interpolate_corrected(s.model.rest, s.anchor_m, s.contact, s.field);
  for (std::size_t v = 0; v < s.model.rest.vertex_count(); ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(published[axis][v], s.field.displacement_m[axis][v], 1e-9);
    }
  }
}

TEST(Interpolation, PublishedPointsAsTheVectorsDoBesideTheSupport) {
  // All free anchors move down equally: the lengths decrease towards the support, the direction stays.
  SurfaceRig s(test::ball_on_sphere());
  for (std::size_t i = 0; i < 5; ++i) s.anchor_m[i] = Vec3(0.0, 0.0, -1e-3);
  interpolate_corrected(s.model.rest, s.anchor_m, s.contact, s.field);
  const Columns3 corrected = s.field.displacement_m;
  interpolate_published(s.model.rest, s.anchor_m, s.contact, s.field);
  int beside = 0;
  for (int v = s.model.rest.patches[4].begin; v < s.model.surface.vertex_count(); ++v) {
    const auto k = static_cast<std::size_t>(v);
    const Vec3 vector_m(corrected[0][k], corrected[1][k], corrected[2][k]);
    EXPECT_NEAR(s.displacement_m(v).norm(), vector_m.norm(), 1e-8);
    if (vector_m.norm() < 1e-5) continue;
    ++beside;
    // The angle is interpolated between points whose normals differ, so the direction is near, not equal.
    EXPECT_GT(s.displacement_m(v).normalized().dot(vector_m.normalized()), 0.7) << v;
  }
  EXPECT_GT(beside, 300);
}

TEST(Interpolation, PublishedLosesTheAzimuth) {
  // Two corners move apart laterally: the vectors cancel half way, the lengths do not (errata E15).
  SurfaceRig s(test::ball_on_cube());
  for (std::size_t i = 4; i < 8; ++i) s.anchor_m[i] = Vec3(i & 1 ? 1e-3 : -1e-3, 0.0, -1e-4);
  interpolate_corrected(s.model.rest, s.anchor_m, s.contact, s.field);
  const Patch& top = s.model.rest.patches[5];
  int middle = top.begin;
  for (int v = top.begin; v < top.end; ++v) {
    if (s.model.surface.points_m.col(v).head<2>().norm() < s.model.surface.points_m.col(middle).head<2>().norm())
      middle = v;
  }
  EXPECT_NEAR(s.displacement_m(middle).norm(), 1e-4, 1e-6);
  interpolate_published(s.model.rest, s.anchor_m, s.contact, s.field);
  EXPECT_LT(s.displacement_m(middle).z(), 0.0);
  EXPECT_GT(s.displacement_m(top.begin).norm(), 9e-5);
}

}  // namespace
}  // namespace touchstone::fast
