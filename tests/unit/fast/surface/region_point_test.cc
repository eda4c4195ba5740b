#include "fast/surface/region_point.h"

#include "support/deformed_surface.h"
#include "support/points.h"
#include "support/press.h"
#include "unit/fast/surface/region_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
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

TEST(RegionPoint, APointMovesAsAVertexThere) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    for (const Form& form : forms) {
      for (std::size_t count = 1; count <= 4; ++count) {
        for (const LocalConstants* factor : {static_cast<const LocalConstants*>(nullptr), &local}) {
          Rig s(scene);
          press_four(s, count);
          s.stack_up(*form.several);
          s.shape(*form.several, factor);
          PointLanes block;
          for (int v = 0; v < s.model.surface.vertex_count(); ++v) {
            const scene::SurfaceQuery at = s.rest_vertex(v);
            const Vec3 point_m = form.several->displacement_at(s.model.rest, *s.model.anchors, s.stack, factor, at);
            ASSERT_LT((s.vertex_m(v) - point_m).norm(), 1e-7) << form.name << ' ' << count << ' ' << v;
            // As one point of a block, whose other points are anywhere on the patch.
            if (v % 7 != 0) continue;
            const Patch& patch = s.model.rest.patches[static_cast<std::size_t>(at.patch)];
            const auto lane = static_cast<std::size_t>(v) % PointLanes::size;
            for (std::size_t k = 0; k < PointLanes::size; ++k) {
              const int w = k == lane ? v : patch.begin + static_cast<int>(31 * k + 17) % (patch.end - patch.begin);
              for (int axis = 0; axis < 3; ++axis) {
                block.point_m[static_cast<std::size_t>(axis)][k] = s.model.surface.points_m(axis, w);
                block.normal[static_cast<std::size_t>(axis)][k] = s.model.surface.normals(axis, w);
              }
            }
            form.several->displacements_at(*s.model.anchors, factor, at.patch, s.stack, block);
            const Vec3 in_block_m(block.displacement_m[0][lane], block.displacement_m[1][lane],
                                  block.displacement_m[2][lane]);
            ASSERT_LT((in_block_m - point_m).norm(), 1e-7) << form.name << ' ' << count << ' ' << v;
          }
        }
      }
    }
  }
}

/// Shape_i of a rig, in the form that the rest-point search needs.
class Displaced final : public DisplacedSurface {
 public:
  Displaced(const Form& form, Rig& rig) : form_(form), rig_(rig) {}
  void displace(int patch, PointLanes& lanes) const noexcept override {
    form_.several->displacements_at(*rig_.model.anchors, &local, patch, rig_.stack, lanes);
  }

 private:
  const Form& form_;
  Rig& rig_;
};

/// The rest-point search of a later region against the surface that the passes over the vertices give: the closest
/// point of that surface by its own triangles, over random scenes.
TEST(RegionPoint, ALaterRegionMeetsTheShapeOfTheEarlierOnes) {
  std::mt19937 random(5);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double tool_radius_m = 0.005;
  const ToolSamples ball = sample_tool(test::ball(tool_radius_m), 500);
  PullBackScratch scratch(ball.count());
  test::OwnedPoints points(ball.count());
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    const Form& form = forms[1];
    int samples = 0, inside = 0, disagree = 0;
    double worst_m = 0.0;
    for (int trial = 0; trial < 12; ++trial) {
      Rig s(scene);
      // Within a patch: at its border the surface has an edge, where the closest point is not unique.
      const bool box = s.model.rest.patches.size() == 6;
      const Vec3 middle_m = s.model.body->query(box ? Vec3(0.004, 0.003, 0.1) : Vec3(0.05, 0.045, 0.085)).point_m;
      const scene::SurfaceQuery middle = s.model.body->query(middle_m);
      const Vec3 t1 = middle.normal.unitOrthogonal(), t2 = middle.normal.cross(t1);
      const double turn = between(0.0, 6.3);
      const auto beside = [&](double way_m, double angle) {
        return Vec3(middle_m + way_m * (std::cos(turn + angle) * t1 + std::sin(turn + angle) * t2));
      };
      const int earlier = 1 + trial % 3;
      for (int i = 0; i < earlier; ++i) {
        const Vec3 place_m = beside(between(0.012, 0.017), 2.1 * i);
        const Vec3 slant(between(-0.2, 0.2), between(-0.2, 0.2), between(-0.2, 0.2));
        s.press(place_m, between(0.0008, 0.0025) * (slant - s.model.body->query(place_m).normal).normalized(),
                between(1e-5, 4e-5));
      }
      s.stack_up(*form.several);
      const test::DeformedSurface deformed(
          *s.model.body, [&](const Vec3& rest_m) { return s.at(*form.several, &local, rest_m); }, 4000);
      Placement at;
      const scene::SurfaceQuery under = s.model.body->query(beside(between(0.0, 0.004), between(0.0, 6.3)));
      at.origin_W_m = under.point_m + s.at(*form.several, &local, under.point_m) +
                      (tool_radius_m - between(0.0005, 0.002)) * under.normal;
      s.model.detection.find_inside(*s.model.body, ball, at, 0.0005, ball.count(), points);
      const test::OwnedPoints found = [&] {
        test::OwnedPoints copy(ball.count());
        s.model.detection.find_inside(*s.model.body, ball, at, 0.0005, ball.count(), copy);
        return copy;
      }();
      s.model.detection.pull_back(*s.model.body, Displaced(form, s), points, scratch);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(found.count); ++i) {
        const bool in = kept < static_cast<std::size_t>(points.count) && points.sample[kept] == found.sample[i];
        const double truth_m = deformed.query(found.p_W_m(i)).signed_distance_m;
        ++samples;
        disagree += in != (truth_m < 0.0);
        if (in && truth_m < 0.0) {
          ++inside;
          const double error_m = std::abs(points.depth_m[kept] + truth_m);
          EXPECT_LT(error_m, std::max(15e-6, -0.01 * truth_m)) << trial << ' ' << i << ' ' << truth_m;
          worst_m = std::max(worst_m, error_m);
        }
        kept += in;
      }
    }
    EXPECT_GT(inside, 100);
    EXPECT_LE(disagree, 0.002 * samples);
    RecordProperty("worst_um", std::to_string(1e6 * worst_m));
  }
}

TEST(RegionPoint, EveryRegionTakesItsDisplacementOnTopOfTheEarlierShape) {
  for (const auto& scene : {test::ball_on_cube(), test::ball_on_sphere()}) {
    for (const Form& form : forms) {
      Rig s(scene);
      press_four(s, 4);
      for (std::size_t i = 0; i < 4; ++i) {
        const bool with_local = i % 2 == 0;
        const LocalConstants* factor = with_local ? &local : nullptr;
        s.stack_up(*form.several, i);
        std::vector<Vec3> before;
        for (const RegionShape& region : s.regions) before.push_back(s.at(*form.several, factor, region.p0_W_m));
        s.stack_up(*form.several, i + 1);
        const RegionShape& own = s.regions[i];
        const Vec3 rise_m = s.at(*form.several, factor, own.p0_W_m) - before[i];
        // The printed form has the length and the angle of D, but not its azimuth (E15).
        EXPECT_NEAR(rise_m.norm(), own.contact.displacement_m.norm(), 1e-15) << form.name << ' ' << i;
        EXPECT_NEAR(rise_m.dot(own.contact.normal), own.contact.displacement_m.dot(own.contact.normal), 1e-15);
        if (form.several == &several_regions_corrected) {
          EXPECT_LT((rise_m - own.contact.displacement_m).norm(), 1e-15);
        }
        for (std::size_t k = 0; k < i; ++k) {
          const Vec3 now_m = s.at(*form.several, factor, s.regions[k].p0_W_m);
          EXPECT_LT((now_m - before[k]).norm(), 1e-15) << form.name << ' ' << i << ' ' << k;
        }
      }
    }
  }
}

TEST(RegionPoint, TheLocalFactorActsOnItsOwnIncrement) {
  // Far apart on opposite sides: each region's R applies its own factor to its own increment only.
  Rig s(test::ball_on_cube());
  s.press(Vec3(0.03, 0.0041, 0.0333), Vec3(-0.002, 0.0, 0.0));
  s.press(Vec3(-0.03, 0.0027, 0.0311), Vec3(0.0013, 0.0, 0.0), 8e-5);
  for (const Form& form : forms) {
    const SeveralRegions& several = *form.several;
    s.stack_up(several, 1);
    const auto first = [&](const Vec3& p) { return s.at(several, nullptr, p); };
    const Vec3 near_first(0.03, 0.0101, 0.0353), near_second(-0.03, -0.0033, 0.0353), between(0.0013, 0.002, 0.06);
    const Vec3 u1_near_first = first(near_first), u1_near_second = first(near_second);
    s.stack_up(several);
    const auto factor = form.several == &several_regions_published ? local_factor_published : local_factor_corrected;
    const double w1 = factor(local, s.regions[0].size, (near_first - s.regions[0].p0_W_m).norm());
    const double w2 = factor(local, s.regions[1].size, (near_second - s.regions[1].p0_W_m).norm());
    const Vec3 both_near_first = s.at(several, nullptr, near_first);
    const Vec3 both_near_second = s.at(several, nullptr, near_second);
    EXPECT_LT(w1, 0.95);
    EXPECT_LT(w2, 0.95);
    EXPECT_LT((s.at(several, &local, near_first) - (both_near_first + (w1 - 1.0) * u1_near_first)).norm(), 1e-15);
    EXPECT_LT(
        (s.at(several, &local, near_second) - (both_near_second + (w2 - 1.0) * (both_near_second - u1_near_second)))
            .norm(),
        1e-15);
    EXPECT_EQ(s.at(several, &local, between), s.at(several, nullptr, between));
  }
}

TEST(RegionPoint, ContactPointsOfAnEarlierRegionAreNoNoncontactPoints) {
  Rig s(test::ball_on_cube());
  const double rim = 0.004;
  s.press(Vec3(0.0031, 0.0022, 0.06), Vec3(0.0, 0.0, -0.002), std::numbers::pi * rim * rim);
  s.press(Vec3(-0.0069, 0.0022, 0.06), Vec3(0.0, 0.0, -0.001), 1e-6);
  const Vec3 in_contact = s.regions[0].p0_W_m + Vec3(0.0, 0.0035, 0.0);
  const Vec3 beside = s.regions[0].p0_W_m + Vec3(0.0, 0.0075, 0.0);
  for (const Form& form : forms) {
    s.stack_up(*form.several, 1);
    const Vec3 first_in_contact = s.at(*form.several, &local, in_contact) - s.at(*form.several, nullptr, in_contact);
    const Vec3 first_beside = s.at(*form.several, &local, beside) - s.at(*form.several, nullptr, beside);
    s.stack_up(*form.several);
    const auto change = [&](const Vec3& p) {
      return Vec3(s.at(*form.several, &local, p) - s.at(*form.several, nullptr, p));
    };
    EXPECT_LT((change(in_contact) - first_in_contact).norm(), 1e-15) << form.name;
    EXPECT_GT((change(beside) - first_beside).norm(), 1e-6) << form.name;
  }
}

TEST(RegionPoint, ALaterRegionAtTheSamePlaceGivesWay) {
  for (const Form& form : forms) {
    Rig s(test::ball_on_cube());
    s.press(Vec3(0.004, 0.002, 0.06), Vec3(0.0, 0.0, -0.002));
    s.press(Vec3(0.004, 0.002, 0.06), Vec3(0.0, 0.0, -0.003));
    s.stack_up(*form.several);
    EXPECT_NEAR(s.at(*form.several, &local, s.regions[0].p0_W_m).z(), -0.002, 1e-12) << form.name;
  }
}

}  // namespace
}  // namespace touchstone::fast
