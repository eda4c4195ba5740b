#include "fast/surface/region_passes.h"

#include "unit/fast/surface/region_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace touchstone::fast {
namespace {

using scene::Vec3;
using test::Form;
using test::forms;
using test::local;
using test::press_four;
using test::Rig;

TEST(RegionPasses, OneRegionIsTheSingleRegionsShape) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    for (const Form& form : forms) {
      Rig s(scene);
      press_four(s, 1);
      SurfaceField single(s.model.rest);
      const RegionShape& region = s.regions[0];
      form.interpolate(s.model.rest, s.anchor_m[0], region.contact, single);
      form.apply_local_factor(s.model.rest, local, region.size, region.p0_W_m, single);
      s.stack_up(*form.several);
      s.shape(*form.several, &local);
      double most_m = 0.0;
      for (std::size_t v = 0; v < s.model.rest.vertex_count(); ++v) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          ASSERT_NEAR(s.field.displacement_m[axis][v], single.displacement_m[axis][v], 1e-9) << form.name;
          most_m = std::max(most_m, std::abs(static_cast<double>(single.displacement_m[axis][v])));
        }
      }
      EXPECT_GT(most_m, 1e-3);
    }
  }
}

/// Increment i of section VI-B by its definition: a dense solve region by region.
TEST(RegionPasses, FusedEqualsRegionUponRegion) {
  Rig s(test::ball_on_cube());
  press_four(s, 4);
  s.stack_up(several_regions_corrected);
  s.shape(several_regions_corrected, nullptr);
  const auto hat = [&](std::size_t k, int patch, const PatchPlace& place) {
    const ContactPoint& top = s.regions[k].contact;
    const auto& patches = s.model.rest.patches;
    return hat_part(patches[static_cast<std::size_t>(top.patch)], top.place, patches[static_cast<std::size_t>(patch)])
        .at(place);
  };
  const auto weighted = [&](std::size_t i, int patch, const PatchPlace& place) {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      sum += place.weight[k] *
             s.anchor_m[i][static_cast<std::size_t>(s.model.anchors->patches()[static_cast<std::size_t>(patch)][k])];
    }
    return sum;
  };
  std::vector<Eigen::MatrixX3d> c;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto n = static_cast<Eigen::Index>(i) + 1;
    Eigen::MatrixXd A(n, n);
    Eigen::MatrixX3d b(n, 3);
    for (std::size_t j = 0; j <= i; ++j) {
      const ContactPoint& at = s.regions[j].contact;
      for (std::size_t k = 0; k <= i; ++k) A(Eigen::Index(j), Eigen::Index(k)) = hat(k, at.patch, at.place);
      const Vec3 target = j == i ? at.displacement_m : Vec3(Vec3::Zero());
      b.row(Eigen::Index(j)) = target - weighted(i, at.patch, at.place);
    }
    c.push_back(A.fullPivLu().solve(b));
  }
  for (int v = 0; v < s.model.surface.vertex_count(); ++v) {
    const scene::SurfaceQuery at = s.rest_vertex(v);
    const PatchPlace place = s.model.anchors->at(at.patch, at.point_m);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      sum += weighted(i, at.patch, place);
      for (std::size_t k = 0; k <= i; ++k) sum += hat(k, at.patch, place) * c[i].row(Eigen::Index(k)).transpose();
    }
    ASSERT_LT((s.vertex_m(v) - sum).norm(), 2e-9) << v;
  }
}

TEST(RegionPasses, HeldSurfaceStaysPutUnderSeveralRegions) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    for (const Form& form : forms) {
      Rig s(scene);
      press_four(s, 4);
      // Two more near the support and on it.
      s.press(Vec3(0.03, -0.011, 0.0062), Vec3(-1e-3, 0.0, 0.0));
      s.press(Vec3(0.004, 0.003, -0.01), Vec3(0.0, 0.0, 1e-3));
      s.stack_up(*form.several);
      s.shape(*form.several, &local);
      int held = 0;
      for (int v = 0; v < s.model.surface.vertex_count(); ++v) {
        if (s.model.surface.points_m(2, v) > scene.body.support_height_m + 1e-12) continue;
        ++held;
        ASSERT_EQ(s.vertex_m(v), Vec3::Zero()) << form.name << ' ' << v;
      }
      EXPECT_GT(held, 10);
    }
  }
}

TEST(RegionPasses, RegionsAtOnePlaceAndOnEdgesStayFiniteAndBounded) {
  const double D = 0.002;
  double worst = 0.0;
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    for (const Form& form : forms) {
      std::mt19937 random(5);
      std::uniform_real_distribution<double> draw(-1.0, 1.0);
      for (int trial = 0; trial < 60; ++trial) {
        Rig s(scene);
        const Vec3 middle = Vec3(0.03 * draw(random), 0.03 * draw(random), 0.06 - 0.02 * (trial % 3));
        const double apart_m = std::pow(10.0, -2.0 - trial % 6);
        for (int i = 0; i < 10; ++i) {
          Vec3 p = middle + apart_m * Vec3(draw(random), draw(random), draw(random));
          if (trial % 7 == 0) p = Vec3(0.03, 0.03, 0.06);
          if (trial % 7 == 1 && i % 2 == 0) p = Vec3(0.03, 0.02 * draw(random), 0.06);
          s.press(p, D * Vec3(draw(random), draw(random), draw(random)).normalized());
        }
        s.stack_up(*form.several);
        s.shape(*form.several, &local);
        for (int v = 0; v < s.model.surface.vertex_count(); ++v) {
          ASSERT_TRUE(s.vertex_m(v).allFinite()) << form.name << ' ' << trial;
          worst = std::max(worst, s.vertex_m(v).norm());
        }
      }
    }
  }
  // Ten regions with ten displacements D: at one place their increments do not add up.
  EXPECT_LT(worst, 8.0 * D);
  RecordProperty("worst_over_D", std::to_string(worst / D));
}

TEST(RegionPasses, AnEmptyOrForcelessStackIsTheRestShape) {
  for (const Form& form : forms) {
    Rig s(test::ball_on_cube());
    for (auto& column : s.field.displacement_m) column.assign(column.size(), 1.0f);
    s.stack_up(*form.several);
    s.shape(*form.several, &local);
    for (const auto& column : s.field.displacement_m) EXPECT_EQ(column, std::vector<float>(column.size(), 0.0f));
    EXPECT_EQ(s.at(*form.several, &local, Vec3(0.0, 0.0, 0.06)), Vec3::Zero());

    // A region without force, between two with force, changes nothing.
    press_four(s, 2);
    s.stack_up(*form.several);
    s.shape(*form.several, &local);
    const Columns3 two = s.field.displacement_m;
    s.press(Vec3(0.001, 0.001, 0.06), Vec3::Zero());
    for (Vec3& u : s.anchor_m[2]) u.setZero();
    std::swap(s.regions[1], s.regions[2]);
    s.stack_up(*form.several);
    s.shape(*form.several, &local);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t v = 0; v < two[axis].size(); ++v) {
        ASSERT_NEAR(s.field.displacement_m[axis][v], two[axis][v], 1e-9);
      }
    }
  }
}

TEST(RegionPasses, EqualStacksGiveEqualBits) {
  for (const Form& form : forms) {
    Rig s(test::ball_on_sphere());
    press_four(s, 4);
    s.stack_up(*form.several);
    s.shape(*form.several, &local);
    const Columns3 once = s.field.displacement_m;
    s.stack_up(*form.several, 2);
    s.shape(*form.several, &local);
    s.stack_up(*form.several);
    s.shape(*form.several, &local);
    EXPECT_EQ(s.field.displacement_m, once);
  }
}

}  // namespace
}  // namespace touchstone::fast
