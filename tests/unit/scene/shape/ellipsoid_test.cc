#include "scene/shape/ellipsoid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace touchstone::scene {
namespace {

/// Smallest distance to the surface by an independent search: over the unit sphere mapped to the ellipsoid, without
/// poles, in smaller and smaller squares around the best point.
double distance_by_search_m(const Vec3& semi, const Vec3& p) {
  double best = INFINITY, width = 1.0;
  Vec3 at = Vec3::UnitX();
  const auto attempt = [&](const Vec3& u) {
    const double distance = (semi.cwiseProduct(u) - p).norm();
    if (distance < best) {
      best = distance;
      at = u;
    }
  };
  for (int i = -200; i <= 200; ++i) {
    for (int j = 0; j < 400; ++j) {
      const double z = i / 200.0, a = 2.0 * std::numbers::pi * j / 400.0;
      attempt({std::sqrt(1.0 - z * z) * std::cos(a), std::sqrt(1.0 - z * z) * std::sin(a), z});
    }
  }
  for (; width > 1e-15; width *= 0.8) {
    const Vec3 from = at, e1 = from.unitOrthogonal(), e2 = from.cross(e1);
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) attempt((from + width * (i * e1 + j * e2) / 4.0).normalized());
    }
  }
  return best;
}

TEST(Ellipsoid, DistanceIsTheSearchsAtAnyRatioOfAxes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-1.5, 1.5), power(-3.0, 0.0);
  for (int k = 0; k < 60; ++k) {
    // A braced list, whose order is defined: the same numbers with every compiler.
    const Vec3 semi{std::pow(10.0, power(random)), k % 3 == 0 ? 1.0 : std::pow(10.0, power(random)), 1.0};
    const Ellipsoid shape(Vec3::Zero(), semi);
    const Vec3 p = semi.cwiseProduct(Vec3{any(random), any(random), any(random)}) +
                   0.1 * Vec3{any(random), any(random), any(random)};
    const double level = p.cwiseQuotient(semi).squaredNorm() - 1.0;
    const double d = shape.signed_distance_m(p);
    EXPECT_EQ(d > 0.0, level > 0.0);
    // The search approaches from above; the method's distance is attained, so it may only be smaller.
    const double search_m = distance_by_search_m(semi, p);
    EXPECT_LE(std::abs(d), search_m + 1e-13) << semi.transpose() << " at " << p.transpose();
    EXPECT_GE(std::abs(d), search_m - 1e-10) << semi.transpose() << " at " << p.transpose();
    EXPECT_NEAR((shape.query(p).point_m - p).norm(), std::abs(d), 1e-12);
  }
}

TEST(Ellipsoid, IsRobustOnAxesPlanesAndTheFocalEllipse) {
  for (const Vec3& semi : {Vec3(3, 2, 1), Vec3(1, 1, 1), Vec3(1, 2, 2), Vec3(1, 1e-3, 1e-3), Vec3(1e-3, 1, 1),
                           Vec3(1e-3, 0.03, 1), Vec3(1, 2, 2.0 * (1.0 + 1e-15))}) {
    const Ellipsoid shape(Vec3(0.5, 0.25, 0.125), semi);
    for (double x : {0.0, 1e-300, 1e-20, 1e-9, 0.3, 8.0 / 9.0, 0.75, 1.0, 1.5, 1e6}) {
      for (double y : {0.0, 1e-17, -1e-9, -0.4, 1.0, 3.0}) {
        for (double z : {0.0, 1e-200, -1e-16, 1e-12, 0.5, -1.0, 2.0}) {
          const Vec3 p = shape.center_m() + semi.cwiseProduct(Vec3(x, y, z));
          const SurfaceQuery q = shape.query(p);
          const double scale = std::max(semi.maxCoeff(), (p - shape.center_m()).norm());
          ASSERT_TRUE(std::isfinite(q.signed_distance_m) && q.point_m.allFinite() && q.normal.allFinite());
          EXPECT_NEAR((q.point_m - shape.center_m()).cwiseQuotient(semi).norm(), 1.0,
                      2e-13 / semi.minCoeff() * semi.maxCoeff());
          EXPECT_NEAR(q.normal.norm(), 1.0, 1e-14);
          EXPECT_LT((q.point_m + q.signed_distance_m * q.normal - p).norm(), 1e-11 * scale)
              << semi.transpose() << " at " << x << ' ' << y << ' ' << z;
          EXPECT_EQ(shape.signed_distance_m(p), q.signed_distance_m);
        }
      }
    }
  }
}

TEST(Ellipsoid, CentreAnswersWithTheShortestAxis) {
  const SurfaceQuery q = Ellipsoid(Vec3::Zero(), Vec3(3, 1, 2)).query(Vec3::Zero());
  EXPECT_EQ(q.signed_distance_m, -1.0);
  EXPECT_EQ(q.normal, Vec3::UnitY());
  EXPECT_EQ(Ellipsoid(Vec3::Zero(), Vec3(2, 2, 2)).query(Vec3::Zero()).normal, Vec3::UnitZ());
}

TEST(Ellipsoid, AreaIsTheClosedFormWhereThereIsOne) {
  constexpr double pi = std::numbers::pi;
  EXPECT_NEAR(Ellipsoid(Vec3::Zero(), Vec3(2, 2, 2)).area_m2(), 16 * pi, 1e-13);
  // Spheroids.
  const double a = 3.0, c = 1.0, e = std::sqrt(1 - c * c / (a * a));
  const double oblate = 2 * pi * a * a * (1 + (1 - e * e) / e * std::atanh(e));
  const double prolate = 2 * pi * c * c * (1 + a / (c * e) * std::asin(e));
  EXPECT_NEAR(Ellipsoid(Vec3::Zero(), Vec3(a, c, a)).area_m2(), oblate, 1e-10 * oblate);
  EXPECT_NEAR(Ellipsoid(Vec3::Zero(), Vec3(c, c, a)).area_m2(), prolate, 1e-10 * prolate);
  // Nearly a sphere: first order in the difference.
  EXPECT_NEAR(Ellipsoid(Vec3::Zero(), Vec3(1, 1, 1 + 1e-6)).area_m2(), 4 * pi * (1 + 2e-6 / 3), 1e-10);
}

TEST(Ellipsoid, AreaOfThreeAxesIsTheIntegral) {
  // Area = integral over the unit sphere of a b c |n / semi|, here by the trapezoidal and Gauss-like midpoint rules in
  // azimuth and in the sine of latitude, extrapolated once.
  const Vec3 semi(3, 2, 1);
  const auto sum = [&](int n) {
    double area = 0.0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double s = -1.0 + 2.0 * (i + 0.5) / n, a = 2.0 * std::numbers::pi * (j + 0.5) / n,
                     c = std::sqrt(1 - s * s);
        area += Vec3(c * std::cos(a), c * std::sin(a), s).cwiseQuotient(semi).norm();
      }
    }
    return semi.prod() * area * 4.0 * std::numbers::pi / (static_cast<double>(n) * n);
  };
  const double coarse = sum(400), fine = sum(800);
  EXPECT_NEAR(Ellipsoid(Vec3::Zero(), semi).area_m2(), fine + (fine - coarse) / 3.0, 1e-9);
}

}  // namespace
}  // namespace touchstone::scene
