#include "fast/surface/region_shapes.h"

#include "fast/contact/pull_back.h"
#include "fast/step/model.h"
#include "support/deformed_surface.h"
#include "support/points.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace touchstone::fast {
namespace {

using scene::Vec3;

struct Form {
  const char* name;
  const SeveralRegions* several;
  Interpolate interpolate;
  ApplyLocalFactor apply_local_factor;
};
const Form forms[] = {{"published", &several_regions_published, interpolate_published, apply_local_factor_published},
                      {"corrected", &several_regions_corrected, interpolate_corrected, apply_local_factor_corrected}};

constexpr LocalConstants local{0.2, 0.002, 0.015};

struct Rig {
  explicit Rig(const scene::Scene& scene)
      : model(scene), field(model.rest), stack(model.rest, *model.anchors, 10), anchor_m(10) {}
  FastModel model;
  SurfaceField field;
  ShapeStack stack;
  std::vector<std::vector<Vec3>> anchor_m;  ///< U_i
  std::vector<RegionShape> regions;

  /// A region at the surface point nearest to p, its anchor displacements drawn at random.
  void press(const Vec3& p_m, const Vec3& displacement_m, double area_m2 = 3e-5) {
    const std::size_t i = regions.size();
    std::mt19937 random(static_cast<unsigned>(17 + i));
    std::uniform_real_distribution<double> draw(-4e-4, 4e-4);
    anchor_m[i].clear();
    for (const bool held : model.skeleton.held) {
      anchor_m[i].push_back(held ? Vec3(Vec3::Zero()) : Vec3(draw(random), draw(random), draw(random)));
    }
    const scene::SurfaceQuery at = model.body->query(p_m);
    RegionShape region;
    region.anchor_displacement_m = anchor_m[i];
    region.p0_W_m = at.point_m;
    region.size = {40, area_m2};
    region.contact.patch = at.patch;
    region.contact.place = model.anchors->at(at.patch, at.point_m);
    region.contact.normal = at.normal;
    region.contact.displacement_m = displacement_m;
    regions.push_back(region);
  }
  void stack_up(const SeveralRegions& several, std::size_t count = 99) {
    stack.clear();
    for (std::size_t i = 0; i < std::min(count, regions.size()); ++i)
      several.add(model.rest, &local, regions[i], stack);
  }
  void shape(const SeveralRegions& several, const LocalConstants* factor) {
    several.interpolate(model.rest, stack, field);
    if (factor != nullptr) several.apply_local_factors(model.rest, *factor, stack, field);
  }
  [[nodiscard]] Vec3 at(const SeveralRegions& several, const LocalConstants* factor, const Vec3& p_m) const {
    return several.displacement_at(model.rest, *model.anchors, stack, factor, model.body->query(p_m));
  }
  [[nodiscard]] Vec3 vertex_m(int v) const {
    const auto k = static_cast<std::size_t>(v);
    return Vec3(field.displacement_m[0][k], field.displacement_m[1][k], field.displacement_m[2][k]);
  }
  /// The vertex as a point of its own patch: on an edge a query may answer with the neighbour.
  [[nodiscard]] scene::SurfaceQuery rest_vertex(int v) const {
    int patch = 0;
    while (v >= model.rest.patches[static_cast<std::size_t>(patch)].end) ++patch;
    return {0.0, model.surface.points_m.col(v), model.surface.normals.col(v), patch};
  }
};

/// Up to four regions on the upper half, two of them on one patch and near each other.
void press_four(Rig& s, std::size_t count) {
  const bool box = s.model.rest.patches.size() == 6;
  const Vec3 places[] = {Vec3(0.0061, 0.0043, 0.06), box ? Vec3(-0.0077, 0.0029, 0.06) : Vec3(0.0177, 0.0069, 0.055),
                         Vec3(0.029, 0.0131, 0.051), Vec3(0.0132, -0.0111, 0.06)};
  const Vec3 displacements[] = {Vec3(1e-4, 2e-4, -2e-3), Vec3(-3e-4, 1e-4, -1.5e-3), Vec3(-1.2e-3, 2e-4, -3e-4),
                                Vec3(2e-4, -1e-4, -2.2e-3)};
  for (std::size_t i = 0; i < count; ++i) s.press(places[i], displacements[i]);
}

TEST(RegionShapes, OneRegionIsTheSingleRegionsShape) {
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

TEST(RegionShapes, APointMovesAsAVertexThere) {
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
            // As one of a block, whose other points lie anywhere on the patch.
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

/// Shape_i of a rig as the pull-back asks for it.
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

/// Where the tool of a later region stands against the surface that the passes over the vertices would show: the
/// closest point of that surface by its own triangles, over randomised scenes.
TEST(RegionShapes, ALaterRegionMeetsTheShapeOfTheEarlierOnes) {
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
      // Within a patch: on its border the surface has an edge, and no single closest point near it.
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

TEST(RegionShapes, EveryRegionTakesItsDisplacementOnTopOfTheEarlierShape) {
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
        // The printed form has the length and the angle of D, not its azimuth (E15).
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

/// Increment i of section VI-B by its definition: a dense solve of its own, region by region.
TEST(RegionShapes, FusedEqualsRegionUponRegion) {
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

TEST(RegionShapes, TheLocalFactorActsOnItsOwnIncrement) {
  // Far apart on opposite sides: each region's R sees its own factor on its own increment and nothing else.
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

TEST(RegionShapes, ContactPointsOfAnEarlierRegionAreNoNoncontactPoints) {
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

TEST(RegionShapes, HeldSurfaceStaysPutUnderSeveralRegions) {
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

TEST(RegionShapes, RegionsAtOnePlaceAndOnEdgesStayFiniteAndBounded) {
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
  // Ten regions with as many D; what they were to take at one place is not added up.
  EXPECT_LT(worst, 8.0 * D);
  RecordProperty("worst_over_D", std::to_string(worst / D));
}

TEST(RegionShapes, ALaterRegionAtTheSamePlaceGivesWay) {
  for (const Form& form : forms) {
    Rig s(test::ball_on_cube());
    s.press(Vec3(0.004, 0.002, 0.06), Vec3(0.0, 0.0, -0.002));
    s.press(Vec3(0.004, 0.002, 0.06), Vec3(0.0, 0.0, -0.003));
    s.stack_up(*form.several);
    EXPECT_NEAR(s.at(*form.several, &local, s.regions[0].p0_W_m).z(), -0.002, 1e-12) << form.name;
  }
}

TEST(RegionShapes, AnEmptyOrForcelessStackIsTheRestShape) {
  for (const Form& form : forms) {
    Rig s(test::ball_on_cube());
    for (auto& column : s.field.displacement_m) column.assign(column.size(), 1.0f);
    s.stack_up(*form.several);
    s.shape(*form.several, &local);
    for (const auto& column : s.field.displacement_m) EXPECT_EQ(column, std::vector<float>(column.size(), 0.0f));
    EXPECT_EQ(s.at(*form.several, &local, Vec3(0.0, 0.0, 0.06)), Vec3::Zero());

    // A region without force, between two that press, changes nothing.
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

TEST(RegionShapes, EqualStacksGiveEqualBits) {
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
