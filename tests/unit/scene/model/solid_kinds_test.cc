#include "scene/model/solid_kinds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::scene {
namespace {

/// With every length that a shape can ask for.
Solid of_kind(const SolidKind& kind) {
  Solid solid;
  solid.shape = kind.shape;
  if (kind.named()) solid.named = kind.word;
  solid.size_m = Vec3(0.06, 0.05, 0.04);
  solid.radius_m = 0.03;
  solid.length_m = 0.05;
  solid.semi_axes_m = Vec3(0.04, 0.03, 0.02);
  solid.profile = capsule_profile(0.02, 0.01);
  complete(solid);
  return solid;
}

TEST(SolidKinds, ATurnedFormHasTheShapesSurface) {
  for (const SolidKind& kind : solid_kinds()) {
    if (kind.turned == nullptr) continue;
    const Solid solid = of_kind(kind);
    const std::unique_ptr<const Shape> shape = kind.surface(solid, Vec3::Zero());
    const TurnedForm form = kind.turned(solid);
    const Revolution turned(form.profile);
    const double up_m = shape->bounds().lower_m.z() - turned.bounds().lower_m.z();
    for (int patch = 0; patch < turned.patch_count(); ++patch) {
      for (const double u : {0.1, 0.5, 0.8}) {
        for (const double v : {0.0, 0.3, 0.9}) {
          Vec3 point_m = turned.at(patch, u, v).point_m;
          point_m.head<2>().array() *= form.stretch.array();
          point_m.z() += up_m;
          EXPECT_LT(std::abs(shape->signed_distance_m(point_m)), 1e-12) << kind.word << ", patch " << patch;
        }
      }
    }
  }
}

TEST(SolidKinds, TheTopsCurvatureIsTheSurfaces) {
  for (const SolidKind& kind : solid_kinds()) {
    const Solid solid = of_kind(kind);
    const std::unique_ptr<const Shape> shape = kind.surface(solid, Vec3::Zero());
    // Patches end at the top, where each has the surface's curvatures.
    SurfacePoint top = shape->at(0, 0.0, 0.0);
    for (int patch = 0; patch < shape->patch_count(); ++patch) {
      for (const double u : {0.0, 1.0}) {
        for (const double v : {0.0, 1.0}) {
          const SurfacePoint corner = shape->at(patch, u, v);
          if (corner.point_m.z() > top.point_m.z() + 1e-12 || corner.normal.z() > top.normal.z() + 1e-12) top = corner;
        }
      }
    }
    EXPECT_NEAR(top_curvature_per_m(solid), std::sqrt(top.curvature_max_per_m * top.curvature_min_per_m), 1e-9)
        << kind.word;
  }
}

}  // namespace
}  // namespace touchstone::scene
