#include "fast/surface/local_factor.h"

#include "fast/step/model.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::fast {
namespace {

using scene::Vec3;

constexpr LocalConstants constants{0.2, 0.002, 0.015};
const double e = std::numbers::e;

TEST(LocalFactor, PublishedIsAsPrinted) {
  const RegionSize point{1, 0.0};
  for (const double r : {0.001, 0.005, 0.014}) {
    EXPECT_NEAR(local_factor_published(constants, point, r), 1.0 + 0.2 * std::log((r + 0.002) / 0.017), 1e-15);
  }
  // (r + C_r) / (r_R + C_r) = 1/e and n = 100.
  const double r = 0.017 / e - 0.002;
  EXPECT_NEAR(local_factor_published(constants, {100, 0.0}, r), 0.8 / (1.0 + std::log(100.0)), 1e-15);
}

TEST(LocalFactor, PublishedSparesContactPointsAndJumpsAtTheRim) {
  const RegionSize region{100, std::numbers::pi * 0.003 * 0.003};
  EXPECT_EQ(local_factor_published(constants, region, 0.0029), 1.0);
  EXPECT_LT(local_factor_published(constants, region, 0.0031), 0.2);
  EXPECT_NEAR(local_factor_published(constants, region, 0.015), 1.0 / (1.0 + std::log(100.0)), 1e-12);  // errata E16
}

TEST(LocalFactor, PublishedTurnsNegativeForALargeStrength) {
  EXPECT_LT(local_factor_published({0.6, 0.002, 0.015}, {1, 0.0}, 1e-6), 0.0);
}

TEST(LocalFactor, CorrectedSparesContactPointsAndHasNoEdge) {
  for (const double rim : {0.0, 0.003, 0.006}) {
    const RegionSize region{37, std::numbers::pi * rim * rim};
    EXPECT_NEAR(local_factor_corrected(constants, region, rim), 1.0, 1e-12);
    EXPECT_NEAR(local_factor_corrected(constants, region, 0.5 * rim), 1.0, 1e-12);
    EXPECT_NEAR(local_factor_corrected(constants, region, 0.015), 1.0, 1e-12);
    EXPECT_LT(local_factor_corrected(constants, region, rim + 0.002), 0.9);
    double before = 1.0;
    for (int i = 0; i <= 1000; ++i) {
      const double w = local_factor_corrected(constants, region, 0.015 * i / 1000.0);
      EXPECT_NEAR(w, before, 0.01);
      EXPECT_LE(w, 1.0);
      before = w;
    }
  }
}

TEST(LocalFactor, CorrectedHangsOnTheAreaAndNotOnTheSamples) {
  const double A_0 = std::numbers::pi * 0.002 * 0.002;
  EXPECT_EQ(local_factor_corrected(constants, {10, 1e-4}, 0.009),
            local_factor_corrected(constants, {1000, 1e-4}, 0.009));
  // Both radii are more than a core radius outside the contact.
  const double small = 0.004, large = 0.006, t = large / 0.015, fade = t * t * (3.0 - 2.0 * t);
  EXPECT_NEAR(local_factor_corrected(constants, {10, 0.5 * A_0}, small), 1.0 + 0.2 * std::log((small + 0.002) / 0.017),
              1e-15);
  EXPECT_NEAR(local_factor_corrected(constants, {10, e * A_0}, large),
              (0.5 + 0.5 * fade) * (1.0 + 0.2 * std::log((large + 0.002) / 0.017)), 1e-15);
}

TEST(LocalFactor, CorrectedIsNeverNegative) {
  for (double C_n = 0.1; C_n < 2000.0; C_n *= 3.0) {
    for (const double r : {0.0, 1e-6, 0.001, 0.0149}) {
      EXPECT_GE(local_factor_corrected({C_n, 0.002, 0.015}, {5, 1e-5}, r), 0.0);
      EXPECT_GE(local_factor_corrected({C_n, 1e-12, 0.015}, {5, 1e-5}, r), 0.0);
    }
  }
}

TEST(LocalFactor, ActsInsideRAndNowhereElse) {
  const FastModel model(test::ball_on_cube());
  SurfaceField field(model.rest);
  // Near an edge, so that R extends to the side face.
  const Vec3 p0(0.022, 0.0, 0.06);
  for (auto& column : field.displacement_m) column.assign(column.size(), 1e-3f);
  const RegionSize region{100, 1e-4};
  apply_local_factor_corrected(model.rest, constants, region, p0, field);
  int touched = 0, on_side = 0;
  for (int v = 0; v < model.surface.vertex_count(); ++v) {
    const double r = (Vec3(model.surface.points_m.col(v)) - p0).norm();
    const double w = r < 0.015 ? local_factor_corrected(constants, region, r) : 1.0;
    for (const auto& column : field.displacement_m) EXPECT_NEAR(column[static_cast<std::size_t>(v)], 1e-3 * w, 1e-8);
    touched += w < 1.0;
    on_side += w < 1.0 && v < model.rest.patches[5].begin;
  }
  EXPECT_GT(touched, 50);
  EXPECT_GT(on_side, 5);
}

TEST(LocalFactor, ThePassIsTheFormulaAtEveryVertex) {
  const FastModel model(test::ball_on_sphere());
  const Vec3 p0 = model.body->query(Vec3(0.013, 0.008, 0.07)).point_m;
  for (const RegionSize& region : {RegionSize{1, 0.0}, RegionSize{100, 1.1e-4}}) {
    for (const LocalConstants& c : {constants, LocalConstants{0.8, 0.002, 0.04}, LocalConstants{0.03, 1e-9, 0.015}}) {
      using Formula = double (*)(const LocalConstants&, const RegionSize&, double) noexcept;
      const std::pair<ApplyLocalFactor, Formula> forms[] = {{apply_local_factor_published, local_factor_published},
                                                            {apply_local_factor_corrected, local_factor_corrected}};
      for (const auto& [apply, formula] : forms) {
        SurfaceField field(model.rest);
        for (auto& column : field.displacement_m) column.assign(column.size(), 1.0f);
        apply(model.rest, c, region, p0, field);
        int touched = 0;
        for (int v = 0; v < model.surface.vertex_count(); ++v) {
          const double r = (Vec3(model.surface.points_m.col(v)) - p0).norm();
          const double w = r < c.r_R_m ? formula(c, region, r) : 1.0;
          touched += w != 1.0;
          for (const auto& column : field.displacement_m) ASSERT_NEAR(column[static_cast<std::size_t>(v)], w, 3e-6);
        }
        EXPECT_GT(touched, 50);
      }
    }
  }
}

TEST(LocalFactor, ReachesRoundToASmallFace) {
  scene::Scene scene = test::ball_on_cube();
  scene.body.size_m = Vec3(0.06, 0.01, 0.01);
  const FastModel model(scene);
  SurfaceField field(model.rest);
  for (auto& column : field.displacement_m) column.assign(column.size(), 1e-3f);
  apply_local_factor_corrected(model.rest, constants, {100, 1e-4}, Vec3(0.02, 0.0, 0.01), field);
  const Patch& end = model.rest.patches[1];  // x = 30 mm, most of it 10 to 15 mm away
  int touched = 0;
  for (int v = end.begin; v < end.end; ++v) touched += field.displacement_m[0][static_cast<std::size_t>(v)] < 1e-3f;
  EXPECT_GT(touched, (end.end - end.begin) / 2);
}

}  // namespace
}  // namespace touchstone::fast
