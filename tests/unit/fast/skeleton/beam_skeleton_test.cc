#include "fast/skeleton/beam_skeleton.h"

#include "fast/skeleton/beam.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <tuple>

namespace touchstone::fast {
namespace {

using scene::Vec3;

struct Cube {
  scene::Scene scene = test::ball_on_cube();
  scene::Box box{Vec3(0.0, 0.0, 0.03), scene.body.size_m};
  BoxAnchors anchors{box};
  BeamSkeleton skeleton = beam_skeleton(anchors, scene);
  BeamEnds ends{8};

  [[nodiscard]] double length_m(std::size_t i, const Vec3& p0) const {
    return std::max((p0 - skeleton.anchor_m[i]).norm(), skeleton.r_R_m);
  }
};

const Vec3 top(0.0, 0.0, 0.06);

Vec3 sum(const std::vector<Vec3>& forces_n) {
  Vec3 total = Vec3::Zero();
  for (const Vec3& F_i : forces_n) total += F_i;
  return total;
}

TEST(BeamSkeleton, AreasAreSharesOfTheCrossSection) {
  const Cube cube;
  for (const double s_i : cube.skeleton.area_m2) EXPECT_NEAR(s_i, 1e-3 / 8.0, 1e-18);
}

TEST(SplitForceCorrected, BalancesTheForceExactly) {
  Cube cube;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.03, 0.03), part(-1.0, 1.0);
  for (int k = 0; k < 1000; ++k) {
    const Vec3 p0(place(random), place(random), 0.06), F(part(random), part(random), -1.0 - std::abs(part(random)));
    split_force_corrected(cube.skeleton, p0, F, 0.01 * F, cube.ends);
    EXPECT_LT((sum(cube.ends.force_n) - F).norm(), 1e-13 * F.norm());
    EXPECT_LT((support_force_n(cube.ends) + F).norm(), 1e-13 * F.norm());
  }
}

TEST(SplitForceCorrected, EveryBeamFollowsEquationsTwoAndThree) {
  Cube cube;
  const Vec3 p0(0.011, -0.006, 0.06), F(0.4, 0.2, -3.0);
  split_force_corrected(cube.skeleton, p0, F, Vec3(0.0, 0.0, -0.01), cube.ends);
  ASSERT_FALSE(cube.ends.limited);
  const Vec3 u = cube.ends.displacement_m[7];  // every free anchor point moves by the common end's u
  const double E = cube.skeleton.youngs_modulus_pa;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 x = (p0 - cube.skeleton.anchor_m[i]).normalized();
    const double l = cube.length_m(i, p0), s = cube.skeleton.area_m2[i], I = second_moment_m4(s);
    const Vec3 F_x = cube.ends.force_n[i].dot(x) * x, F_y = cube.ends.force_n[i] - F_x;
    EXPECT_LT((F_x - E * s / l * u.dot(x) * x).norm(), 1e-12);
    EXPECT_LT((F_y - 3.0 * E * I / (l * l * l) * (u - u.dot(x) * x)).norm(), 1e-12);
    if (cube.skeleton.held[i]) {
      EXPECT_EQ(cube.ends.displacement_m[i], Vec3::Zero());
    } else {
      EXPECT_LT((cube.ends.displacement_m[i] - u).norm(), 1e-18);
    }
  }
}

TEST(SplitForce, SymmetricContactIsSymmetric) {
  for (const SplitForce split : {split_force_published, split_force_corrected}) {
    Cube cube;
    split(cube.skeleton, top, Vec3(0.0, 0.0, -5.0), Vec3(0.0, 0.0, -0.002), cube.ends);
    EXPECT_LT((sum(cube.ends.force_n) - Vec3(0.0, 0.0, -5.0)).norm(), 1e-12);
    for (std::size_t i = 0; i < 8; ++i) {
      const std::size_t like = i & 4;  // the anchor of the same height
      EXPECT_NEAR(cube.ends.force_n[i].z(), cube.ends.force_n[like].z(), 1e-14);
      EXPECT_NEAR(cube.ends.force_n[i].norm(), cube.ends.force_n[like].norm(), 1e-14);
      EXPECT_NEAR(cube.ends.displacement_m[i].norm(), cube.ends.displacement_m[like].norm(), 1e-18);
      EXPECT_LE(cube.ends.displacement_m[i].z(), 1e-18);  // down, with the tool
    }
    EXPECT_GT(cube.ends.displacement_m[7].norm(), 1e-6);
  }
}

TEST(SplitForcePublished, KeepsTheProportionsOfEquationsFourAndFive) {
  Cube cube;
  const Vec3 p0(0.011, -0.006, 0.06), F(0.0, 0.0, -3.0), D(0.0, 0.0, -0.002);
  split_force_published(cube.skeleton, p0, F, D, cube.ends);
  double a = -1.0, b = -1.0;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 x = (p0 - cube.skeleton.anchor_m[i]).normalized();
    const double l = cube.length_m(i, p0), s = cube.skeleton.area_m2[i], I = second_moment_m4(s);
    const Vec3 across = D - D.dot(x) * x;
    const double delta_x = l - l * l / std::hypot(l, across.norm());
    const double a_i = cube.ends.force_n[i].dot(x) / ((D.dot(x) + delta_x) * s / l);
    const double b_i =
        (cube.ends.force_n[i] - cube.ends.force_n[i].dot(x) * x).dot(across) / (across.squaredNorm() * I / (l * l * l));
    if (i == 0) a = a_i, b = b_i;
    EXPECT_NEAR(a_i, a, 1e-8 * std::max(a, b));
    EXPECT_NEAR(b_i, b, 1e-8 * std::max(a, b));
  }
  EXPECT_GE(a, 0.0);
  EXPECT_GE(b, 0.0);
}

TEST(SplitForcePublished, NeverPullsABeamAgainstItsDisplacement) {
  Cube cube;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.028, 0.028), part(-0.5, 0.5);
  double worst = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const Vec3 p0(place(random), place(random), 0.06), F(part(random), part(random), -1.0);
    split_force_published(cube.skeleton, p0, F, 0.002 * F, cube.ends);
    for (const Vec3& F_i : cube.ends.force_n) {
      ASSERT_TRUE(F_i.allFinite());
      EXPECT_GE(F_i.dot(F), -0.02 * F.squaredNorm());  // delta x alone may reverse the force of a nearly unloaded beam
    }
    worst = std::max(worst, (sum(cube.ends.force_n) - F).norm() / F.norm());
  }
  EXPECT_GT(worst, 0.01);  // equation (6) keeps a residual, errata E8
  EXPECT_LE(worst, 1.0);
}

TEST(SplitForcePublished, RankOneTakesTheLeastNorm) {
  Cube cube;
  const double D = 1e-6, F = 5.0;  // delta x is negligible
  split_force_published(cube.skeleton, top, Vec3(0.0, 0.0, -F), Vec3(0.0, 0.0, -D), cube.ends);
  // g and h are both parallel to F: (a, b) is proportional to (|g|, |h|).
  double g = 0.0, h = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    const double l = cube.length_m(i, top), s = cube.skeleton.area_m2[i];
    const double cosine = (top - cube.skeleton.anchor_m[i]).normalized().z();
    g += D * cosine * cosine * s / l;
    h += D * (1.0 - cosine * cosine) * second_moment_m4(s) / (l * l * l);
  }
  const double a = F * g / (g * g + h * h);
  const double l = cube.length_m(0, top);
  const Vec3 x = (top - cube.skeleton.anchor_m[0]).normalized();
  EXPECT_NEAR(cube.ends.force_n[0].dot(x), a * -D * x.z() * cube.skeleton.area_m2[0] / l, 1e-4);
}

TEST(SplitForce, SurvivesItsDegenerateCases) {
  struct Contact {
    const char* name;
    Vec3 p0, F, D;
  };
  const Vec3 anchor(0.03, 0.03, 0.06), down(0.0, 0.0, -1.0);
  const std::vector<Contact> contacts{{"at an anchor", anchor, down, 0.001 * down},
                                      {"next to an anchor", anchor - Vec3(1e-10, 0.0, 0.0), down, 0.001 * down},
                                      {"along a beam", top, anchor - top, 0.01 * (anchor - top)},
                                      {"no force", top, Vec3::Zero(), 0.001 * down},
                                      {"no displacement", top, down, Vec3::Zero()},
                                      {"across the force", top, down, Vec3(0.001, 0.0, 0.0)},
                                      {"tiny", top, 1e-300 * down, 1e-300 * down},
                                      {"on the support", Vec3(0.0, 0.0, 0.0), -down, -0.001 * down}};
  for (const SplitForce split :
       {split_force_published, split_force_corrected, split_force_in_parts_published, split_force_in_parts_corrected}) {
    for (const Contact& contact : contacts) {
      for (double s_c = 1e-9; s_c <= 1e3; s_c *= 10.0) {
        Cube cube;
        for (double& s_i : cube.skeleton.area_m2) s_i = s_c / 8.0;
        split(cube.skeleton, contact.p0, contact.F, contact.D, cube.ends);
        for (std::size_t i = 0; i < 8; ++i) {
          EXPECT_TRUE(cube.ends.force_n[i].allFinite()) << contact.name << " s_c " << s_c;
          EXPECT_LE(cube.ends.displacement_m[i].norm(), contact.D.norm() * (1.0 + 1e-12))
              << contact.name << " s_c " << s_c;
        }
      }
    }
  }
}

TEST(SplitForce, CoplanarBeamsCarryAForceAcrossTheirPlane) {
  Cube cube;
  cube.skeleton.anchor_m = {Vec3(0.03, 0, 0), Vec3(-0.03, 0, 0), Vec3(0, 0.03, 0), Vec3(0, -0.03, 0)};
  cube.skeleton.held.assign(4, false);
  cube.ends = BeamEnds(4);
  const Vec3 F(0.0, 0.0, -1.0);
  split_force_corrected(cube.skeleton, Vec3::Zero(), F, 0.001 * F, cube.ends);
  EXPECT_LT((sum(cube.ends.force_n) - F).norm(), 1e-13);
  split_force_published(cube.skeleton, Vec3::Zero(), F, 0.001 * F, cube.ends);
  for (const Vec3& F_i : cube.ends.force_n) EXPECT_TRUE(F_i.allFinite());
}

TEST(SplitForce, AnchorPointsNeverOutrunTheContact) {
  for (const SplitForce split :
       {split_force_published, split_force_corrected, split_force_in_parts_published, split_force_in_parts_corrected}) {
    Cube cube;
    for (double& s_i : cube.skeleton.area_m2) s_i *= 1e-6;
    split(cube.skeleton, Vec3(0.004, 0.01, 0.06), Vec3(0.0, 0.0, -5.0), Vec3(0.0, 0.0, -0.002), cube.ends);
    EXPECT_TRUE(cube.ends.limited);
    EXPECT_NEAR(cube.ends.displacement_m[7].norm(), 0.002, 1e-15);
  }
}

/// The cube with balls of another material inside.
scene::Scene with_balls(std::initializer_list<std::tuple<Vec3, double, double>> center_radius_modulus) {
  scene::Scene scene = test::ball_on_cube();
  for (const auto& [center_m, radius_m, youngs_modulus_pa] : center_radius_modulus) {
    scene::Inclusion inclusion;
    inclusion.shape = scene::BodyShape::sphere;
    inclusion.radius_m = radius_m;
    inclusion.center_m = center_m;
    inclusion.material = {youngs_modulus_pa, 0.33};
    scene.body.inclusions.push_back(inclusion);
  }
  return scene;
}

TEST(SplitForceInParts, IsChosenOnlyWhereThereAreInclusions) {
  const Cube cube;
  EXPECT_EQ(split_force_of(scene::Formulation::corrected, cube.skeleton), split_force_corrected);
  EXPECT_EQ(split_force_of(scene::Formulation::published, cube.skeleton), split_force_published);
  const BeamSkeleton parts = beam_skeleton(cube.anchors, with_balls({{Vec3(0, 0, 0.03), 0.01, 33.77e3}}));
  EXPECT_EQ(split_force_of(scene::Formulation::corrected, parts), split_force_in_parts_corrected);
  EXPECT_EQ(split_force_of(scene::Formulation::published, parts), split_force_in_parts_published);
}

TEST(SplitForceInParts, AnInclusionOfTheBodysOwnMaterialChangesNothing) {
  Cube cube;
  const BeamSkeleton parts = beam_skeleton(
      cube.anchors, with_balls({{Vec3(-0.01, 0.004, 0.04), 0.012, 3.0e6}, {Vec3(0.015, 0.0, 0.02), 0.006, 3.0e6}}));
  const Vec3 p0(0.011, -0.006, 0.06), F(0.4, 0.2, -3.0), D(0.0005, 0.0, -0.004);
  BeamEnds ends(8);
  const std::pair<SplitForce, SplitForce> both[] = {{split_force_corrected, split_force_in_parts_corrected},
                                                    {split_force_published, split_force_in_parts_published}};
  for (const auto& [plain, in_parts] : both) {
    plain(cube.skeleton, p0, F, D, cube.ends);
    in_parts(parts, p0, F, D, ends);
    for (std::size_t i = 0; i < 8; ++i) {
      EXPECT_LT((ends.force_n[i] - cube.ends.force_n[i]).norm(), 1e-12);
      EXPECT_LT((ends.displacement_m[i] - cube.ends.displacement_m[i]).norm(), 1e-15);
    }
  }
}

TEST(SplitForceInParts, BalancesAndFollowsEachBeamsOwnStiffness) {
  Cube cube;
  // On beams to the bottom and, under the indented top, to a free corner.
  const Vec3 p0(0.004, -0.003, 0.05), F(0.2, 0.1, -3.0);
  const BeamSkeleton parts = beam_skeleton(cube.anchors, with_balls({{Vec3(-0.013, -0.0165, 0.025), 0.008, 33.77e3},
                                                                     {Vec3(0.017, 0.0135, 0.054), 0.004, 5.0e7}}));
  BeamEnds ends(8);
  split_force_in_parts_corrected(parts, p0, F, Vec3(0.0, 0.0, -0.02), ends);
  ASSERT_FALSE(ends.limited);
  EXPECT_LT((sum(ends.force_n) - F).norm(), 1e-12);
  int cut = 0, free_cut = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const BeamSegments segments =
        cut_beam(parts.inclusions, parts.anchor_m[i], p0, {cube.length_m(i, p0), 3.0e6, parts.area_m2[i]});
    cut += segments.count > 1 ? 1 : 0;
    free_cut += segments.count > 1 && !parts.held[i] ? 1 : 0;
    const Vec3 x = (p0 - parts.anchor_m[i]).normalized();
    const Vec3 F_x = ends.force_n[i].dot(x) * x, F_y = ends.force_n[i] - F_x;
    if (!parts.held[i]) {
      // The beam free at the anchor and fixed at the contact: x from the anchor.
      const Vec3 expected =
          F_x * axial_compliance_m_per_n(segments.all()) + F_y * released_bending_compliance_m_per_n(segments.all());
      EXPECT_LT((ends.displacement_m[i] - expected).norm(), 1e-12 * expected.norm());
    }
  }
  EXPECT_GE(cut, 2);
  EXPECT_GE(free_cut, 1);
}

TEST(SplitForceInParts, EveryRatioOfModuliStaysFiniteAndBalanced) {
  Cube cube;
  for (double ratio = 1e-6; ratio <= 1e6; ratio *= 10.0) {
    const BeamSkeleton parts = beam_skeleton(cube.anchors, with_balls({{Vec3(-0.01, 0.0, 0.04), 0.015, ratio * 3e6},
                                                                       {Vec3(0.02, 0.0, 0.02), 0.009, 3e6 / ratio}}));
    for (const Vec3& p0 : {Vec3(0.0, 0.0, 0.06), Vec3(-0.02, 0.025, 0.06), Vec3(0.03, 0.03, 0.06)}) {
      const Vec3 F(0.3, -0.2, -4.0), D(0.0, 0.0, -0.003);
      for (const SplitForce split : {split_force_in_parts_published, split_force_in_parts_corrected}) {
        split(parts, p0, F, D, cube.ends);
        for (std::size_t i = 0; i < 8; ++i) {
          EXPECT_TRUE(cube.ends.force_n[i].allFinite()) << ratio;
          EXPECT_TRUE(cube.ends.displacement_m[i].allFinite()) << ratio;
          EXPECT_LE(cube.ends.displacement_m[i].norm(), D.norm() * (1.0 + 1e-12)) << ratio;
        }
        if (split == static_cast<SplitForce>(split_force_in_parts_corrected)) {
          EXPECT_LT((sum(cube.ends.force_n) - F).norm(), 1e-7 * F.norm()) << ratio;
        }
      }
    }
  }
}

TEST(SplitForceInParts, ASoftBallLeansTheShapeOnlyInTheCorrectedForm) {
  // An ellipsoid pressed on its top, as in the paper's Fig. 18, with a soft ball on the beam to -x.
  scene::Scene scene = with_balls({{Vec3(-0.015, 0.0, 0.038), 0.008, 33.77e3}});
  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = Vec3(0.04, 0.025, 0.025);
  scene.body.support_height_m = 0.005;
  const auto shape = scene::body_shape(scene.body);
  const auto anchors = anchor_points(scene.body, *shape);
  const Vec3 p0(0.0, 0.0, 0.05), F(0.0, 0.0, -3.0), D(0.0, 0.0, -0.01);
  BeamEnds ends(6);
  const auto soft_over_other = [&](SplitForce split) {
    split(beam_skeleton(*anchors, scene), p0, F, D, ends);
    EXPECT_FALSE(ends.limited);
    EXPECT_LT(ends.displacement_m[1].z(), 0.0);
    return ends.displacement_m[1].z() / ends.displacement_m[0].z();  // at -x over at +x
  };
  // On the contact's half of its beam the distance from the anchor gives the ball a large effect: larger displacements
  // on the soft side.
  EXPECT_GT(soft_over_other(split_force_in_parts_corrected), 1.2);
  // As printed both ends of a beam have one compliance, which cancels in the split.
  EXPECT_NEAR(soft_over_other(split_force_in_parts_published), 1.0, 1e-9);
  // On the anchor's half the opposite holds.
  scene.body.inclusions[0].radius_m = 0.006;
  scene.body.inclusions[0].center_m = Vec3(-0.028, 0.0, 0.029);
  EXPECT_LT(soft_over_other(split_force_in_parts_corrected), 0.8);
}

TEST(SkeletonView, AtRestIsTheSkeletonItself) {
  Cube cube;
  const SkeletonView view = cube.skeleton;
  EXPECT_EQ(view.anchor_m.data(), cube.skeleton.anchor_m.data());
  EXPECT_EQ(view.area_m2.data(), cube.skeleton.area_m2.data());
}

TEST(CurrentEnds, BeamsOfLaterRegionsEndOnTheDeformedSurface) {
  Cube cube;
  CurrentEnds current(cube.skeleton);
  std::vector<Vec3> u(8, Vec3::Zero());
  current.update(cube.skeleton, u);
  EXPECT_EQ(current.anchor_m, cube.skeleton.anchor_m);
  EXPECT_EQ(current.area_m2, cube.skeleton.area_m2);
  u[7] = Vec3(0.004, 0.003, -0.01);
  current.update(cube.skeleton, u);
  double total = 0.0;
  for (const double s_i : current.area_m2) total += s_i;
  EXPECT_NEAR(total, cube.skeleton.s_c_m2, 1e-18);
  EXPECT_NE(current.area_m2[7], cube.skeleton.area_m2[7]);
  const Vec3 p0(0.01, 0.0, 0.058), F(0.0, 0.0, -3.0), D(0.0, 0.0, -0.01);
  split_force_corrected(current.view(cube.skeleton), p0, F, D, cube.ends);
  EXPECT_LT((sum(cube.ends.force_n) - F).norm(), 1e-12);
  const Vec3 x = p0 - (cube.skeleton.anchor_m[7] + u[7]);
  EXPECT_LT((cube.ends.beam[7].x - x.normalized()).norm(), 1e-15);
  EXPECT_NEAR(cube.ends.beam[7].axial_n_per_m, 3.0e6 * current.area_m2[7] / x.norm(), 1e-6);
}

}  // namespace
}  // namespace touchstone::fast
