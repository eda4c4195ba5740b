// The extremes: sizes, moduli and times over many decades.

#include "ball_on_ball.h"

namespace touchstone::reference::extremes {
namespace {

// Young's modulus from 1 Pa to 1e12 Pa: the force is proportional to it, to 1e-9, and the shape does not depend on it.
TEST(ReferenceScale, YoungsModulusOverTwelveDecades) {
  const Result usual = solved(ball_on_ball());
  for (const double modulus_pa : {1.0, 1e3, 1e9, 1e12}) {
    scene::Scene scene = ball_on_ball();
    scene.body.material.youngs_modulus_pa = modulus_pa;
    const Result other = solved(scene);
    EXPECT_NEAR(last_n(other) / last_n(usual), modulus_pa / 3e6, 1e-9 * modulus_pa / 3e6) << modulus_pa;
    EXPECT_LT((other.instants.back().displacement_m - usual.instants.back().displacement_m).norm(),
              1e-8 * usual.instants.back().displacement_m.norm())
        << modulus_pa;
  }
}

// All lengths from 1/100 to 100 times as large: the force is proportional to their square, to 1e-9.
TEST(ReferenceScale, LengthsOverFourDecades) {
  const double usual_n = last_n(solved(ball_on_ball()));
  for (const double factor : {0.01, 0.1, 10.0, 100.0}) {
    const double other_n = last_n(solved(scaled(ball_on_ball(), factor)));
    EXPECT_NEAR(other_n / usual_n, factor * factor, 1e-9 * factor * factor) << factor;
  }
}

// A track that takes a microsecond or a day: the same force to 1e-9.
TEST(ReferenceScale, TimeHasNoEffect) {
  const Result usual = solved(ball_on_ball());
  for (const double seconds : {1e-6, 86400.0}) {
    scene::Scene scene = ball_on_ball();
    for (scene::Waypoint& w : scene.track) w.time_s *= seconds;
    const Result other = solved(scene);
    ASSERT_EQ(other.instants.size(), usual.instants.size());
    EXPECT_NEAR(last_n(other), last_n(usual), 1e-9 * last_n(usual)) << seconds;
  }
}

// Poisson's ratio from 0 to 0.5: the force rises without a jump, and at 0.5 the volume is constant to 1e-6.
TEST(ReferenceScale, PoissonsRatioFromZeroToAHalf) {
  double before_n = 0.0;
  for (const double nu : {0.0, 0.25, 0.45, 0.49, 0.499, 0.49999, 0.5}) {
    scene::Scene scene = ball_on_ball();
    scene.body.material.poissons_ratio = nu;
    const Result result = solved(scene);
    EXPECT_GT(last_n(result), before_n) << nu;
    if (nu > 0.49) {
      EXPECT_LT(last_n(result), 1.05 * before_n) << nu;
    }
    if (nu == 0.5) {
      EXPECT_LT(std::abs(result.instants.back().volume_change_rel), 1e-6);
    }
    before_n = last_n(result);
  }
}

// An inclusion from a millionth to a million times as stiff as the body around it: the force rises with its modulus and
// levels off at both ends, void and rigid.
TEST(ReferenceScale, InclusionOverTwelveDecades) {
  const auto with_inclusion_n = [](double ratio) {
    scene::Scene scene = ball_on_ball();
    scene::Inclusion core;
    core.shape = scene::BodyShape::sphere;
    core.radius_m = 0.01;
    core.center_m = Vec3(0.0, 0.0, 0.03);
    core.material = {ratio * scene.body.material.youngs_modulus_pa, 0.3};
    scene.body.inclusions.push_back(core);
    scene.track[1] = at(1.0, {0.0, 0.0, 0.0685});
    return last_n(solved(scene));
  };
  const std::vector<double> ratios = {1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6};
  std::vector<double> forces_n;
  for (const double ratio : ratios) forces_n.push_back(with_inclusion_n(ratio));
  for (std::size_t i = 1; i < forces_n.size(); ++i) EXPECT_GT(forces_n[i], forces_n[i - 1]) << ratios[i];
  EXPECT_NEAR(forces_n[1] / forces_n[0], 1.0, 0.02) << "void";
  EXPECT_NEAR(forces_n[6] / forces_n[5], 1.0, 0.02) << "rigid";
}

// An inclusion of the body's own material: the force without an inclusion, up to the effect of other integration
// points.
TEST(ReferenceScale, InclusionOfTheBodysOwnMaterialIsNone) {
  scene::Scene scene = ball_on_ball();
  scene.body.material.poissons_ratio = 0.3;
  const double none_n = last_n(solved(scene));
  scene::Inclusion core;
  core.shape = scene::BodyShape::sphere;
  core.radius_m = 0.01;
  core.center_m = Vec3(0.0, 0.0, 0.03);
  core.material = scene.body.material;
  scene.body.inclusions.push_back(core);
  EXPECT_NEAR(last_n(solved(scene)) / none_n, 1.0, 0.02);
}

// A tool from a tenth to a thousand times the body's size: the force rises with its radius, towards that of a plane.
TEST(ReferenceScale, ToolFarLargerThanTheBody) {
  double before_n = 0.0;
  for (const double radius_m : {0.003, 0.01, 0.03, 0.3, 3.0, 10.0}) {
    scene::Scene scene = ball_on_ball();
    scene.tool.radius_m = radius_m;
    scene.track = {at(0.0, {0.0, 0.0, 0.0605 + radius_m}), at(1.0, {0.0, 0.0, 0.059 + radius_m})};
    const double force_n = last_n(solved(scene));
    EXPECT_GT(force_n, before_n) << radius_m;
    if (radius_m == 10.0) {
      EXPECT_LT(force_n, 1.01 * before_n) << "a plane's";
    }
    before_n = force_n;
  }
}

// The number of instants, on which the mesh depends: without friction 13, 25 and 49 instants give the same force, to
// 1e-3.
TEST(ReferenceScale, InstantsConverge) {
  scene::Scene scene = ball_on_ball();
  scene.compare.instants = 97;
  const double many_n = last_n(solved(scene));
  for (const int instants : {13, 25, 49}) {
    scene.compare.instants = instants;
    EXPECT_NEAR(last_n(solved(scene)) / many_n, 1.0, 1e-3) << instants;
  }
}

// Meshes refined three times: the force converges, each change at most half of the one before.
TEST(ReferenceScale, MeshesConverge) {
  scene::Scene scene = ball_on_ball();
  scene.reference.levels = 4;
  const Result result = solved(scene);
  ASSERT_EQ(result.levels.size(), 4u);
  std::vector<double> change_n;
  for (std::size_t level = 1; level < 4; ++level) {
    change_n.push_back(std::abs(result.levels[level].force_n.back() - result.levels[level - 1].force_n.back()));
  }
  EXPECT_LT(change_n[1], 0.5 * change_n[0]);
  EXPECT_LT(change_n[2], 0.5 * change_n[1]);
}

}  // namespace
}  // namespace touchstone::reference::extremes
