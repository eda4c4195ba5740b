// The extremes: first touch, grazing, loss of contact, reversal, edges, thin bodies and deep presses.

#include "ball_on_ball.h"

namespace touchstone::reference::extremes {
namespace {

// A track that stays away from the body: no force and no displacement, exactly.
TEST(ReferenceContact, NoContactIsNoForce) {
  scene::Scene scene = ball_on_ball();
  scene.track[1] = at(1.0, {0.0, 0.0, 0.0701});
  for (const scene::InstantRecord& instant : solved(scene).instants) {
    EXPECT_EQ(instant.force_n(), Vec3::Zero());
    EXPECT_EQ(instant.displacement_m.norm(), 0.0);
  }
}

// A tool that starts a kilometre away: the result of one that starts near, to the 1 % by which other instants, and so
// other meshes, change it.
TEST(ReferenceContact, FarAwayAtFirst) {
  scene::Scene scene = ball_on_ball();
  const double near_n = last_n(solved(scene));
  scene.track[0] = at(-1.0, {0.0, 0.0, 0.0705});
  scene.track.insert(scene.track.begin(), at(-2.0, {0.0, 0.0, 900.0}));
  scene.compare.instants = 7;
  EXPECT_NEAR(last_n(solved(scene)) / near_n, 1.0, 0.01);
}

// Depths from a nanometre upwards, with cells of the size that the contact needs: the force is proportional to the
// depth to the power of 3/2 and Hertz's, within 3 %.
TEST(ReferenceContact, FirstTouch) {
  const auto force_n = [](double depth_m) {
    scene::Scene scene = ball_on_ball();
    scene.reference.element_size_m.reset();
    scene.track = {at(0.0, {0.0, 0.0, 0.07 + depth_m}), at(1.0, {0.0, 0.0, 0.07 - depth_m})};
    return last_n(solved(scene));
  };
  const double whole_n = force_n(1e-5);
  for (const double depth_m : {1e-9, 1e-7, 1e-6}) {
    EXPECT_NEAR(force_n(depth_m) / whole_n / std::pow(depth_m / 1e-5, 1.5), 1.0, 0.03) << depth_m;
  }
}

// A tool that moves past and only just touches: at most the force of that depth, and none before and after.
TEST(ReferenceContact, Grazing) {
  scene::Scene scene = ball_on_ball();
  scene.reference.element_size_m = 0.006;
  scene.track = {at(0.0, {-0.02, 0.0, 0.0699}), at(1.0, {0.02, 0.0, 0.0699})};
  scene.compare.instants = 5;
  const Result result = solved(scene);
  EXPECT_EQ(result.instants.front().force_n().norm(), 0.0);
  EXPECT_EQ(result.instants.back().force_n().norm(), 0.0);
  EXPECT_GT(result.instants[2].force_n().z(), 0.0);
  EXPECT_LT(result.instants[2].force_n().norm(), 1.0);
}

// Pressed and released: no force, and the body at rest to 1e-9 of its largest displacement.
TEST(ReferenceContact, LossOfContactLeavesNothing) {
  scene::Scene scene = ball_on_ball();
  scene.track.push_back(at(2.0, {0.0, 0.0, 0.0705}));
  scene.compare.instants = 7;
  const Result result = solved(scene);
  EXPECT_EQ(last_n(result), 0.0);
  EXPECT_LT(moved_m(result.instants.back()), 1e-9 * moved_m(result.instants[3]));
}

// Unloading: without friction the force depends on the depth alone, in both directions, to 1e-6.
TEST(ReferenceContact, UnloadingEqualsLoading) {
  scene::Scene scene = ball_on_ball();
  scene.track.push_back(at(2.0, {0.0, 0.0, 0.0705}));
  scene.compare.instants = 9;
  const Result result = solved(scene);
  const std::size_t last = result.instants.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const double down_n = result.instants[i].force_n().norm(), up_n = result.instants[last - i].force_n().norm();
    EXPECT_NEAR(down_n, up_n, 1e-6 * last_n(solved(ball_on_ball()))) << i;
  }
}

// Pressed and released ten times: the tenth press equals the first.
TEST(ReferenceContact, TenPressesAreEqual) {
  scene::Scene scene = ball_on_ball();
  scene.track.clear();
  for (int press = 0; press < 10; ++press) {
    scene.track.push_back(at(2.0 * press, {0.0, 0.0, 0.0705}));
    scene.track.push_back(at(2.0 * press + 1.0, {0.0, 0.0, 0.066}));
  }
  scene.compare.instants = 20;
  const Result result = solved(scene);
  EXPECT_NEAR(last_n(result) / result.instants[1].force_n().norm(), 1.0, 1e-6);
}

// Friction that never slips: the force of a press along the axis keeps its direction, and is larger than without
// friction, by at most 20 %.
TEST(ReferenceContact, FrictionThatNeverSlips) {
  scene::Scene scene = ball_on_ball();
  scene.compare.instants = 6;
  const double smooth_n = last_n(solved(scene));
  scene.contact.friction = scene::Friction{.K = 1e3, .beta = 1.0, .mu_D = 1e3};
  const Result rough = solved(scene);
  EXPECT_GT(last_n(rough), smooth_n);
  EXPECT_LT(last_n(rough), 1.2 * smooth_n);
  EXPECT_LT(rough.instants.back().force_n().head<2>().norm(), 1e-9 * smooth_n);
}

// A very small coefficient of friction: the force without friction; the difference is at most the friction's limit.
TEST(ReferenceContact, VerySmallFriction) {
  scene::Scene scene = ball_on_ball();
  const double smooth_n = last_n(solved(scene));
  scene.contact.friction = scene::Friction{.K = 1e-6, .beta = 1.0, .mu_D = 1e-6};
  EXPECT_NEAR(last_n(solved(scene)) / smooth_n, 1.0, 1e-5);
}

// A flat punch with the smallest fillet that is allowed, and one with a sharp edge: the force rises with the depth, and
// the sharp one is refused, since its pressure is unbounded.
TEST(ReferenceContact, SharpEdgedPunch) {
  scene::Scene scene = ball_on_ball();
  scene.tool.shape = scene::ToolShape::cylinder;
  scene.tool.radius_m = 0.006;
  scene.tool.length_m = 0.02;
  scene.tool.edge_radius_m = 0.0015;
  scene.track = {at(0.0, {0.0, 0.0, 0.0705}), at(1.0, {0.0, 0.0, 0.068})};
  const Result result = solved(scene);
  for (std::size_t i = 1; i < result.instants.size(); ++i) {
    EXPECT_GE(result.instants[i].force_n().norm(), result.instants[i - 1].force_n().norm()) << i;
  }
  EXPECT_GT(last_n(result), 0.0);
  scene.tool.edge_radius_m = 0.0;
  EXPECT_THROW(solved(scene), scene::InputError);
}

// A disc six to fifteen times as wide as it is thick: a force that is larger the thinner the disc is.
TEST(ReferenceContact, ThinDisc) {
  double before_n = 0.0;
  for (const double height_m : {0.01, 0.006, 0.004}) {
    scene::Scene scene = ball_on_ball();
    scene.body = {};
    scene.body.shape = scene::BodyShape::revolution;
    scene.body.profile.rz_m = {{0.0, 0.0}, {0.03, 0.0}, {0.03, height_m}, {0.0, height_m}};
    scene.body.material = {3e6, 0.45};
    scene.reference.element_size_m = 0.0007;
    scene.track = {at(0.0, {0.0, 0.0, height_m + 0.0101}), at(1.0, {0.0, 0.0, height_m + 0.0097})};
    const double force_n = last_n(solved(scene));
    EXPECT_GT(force_n, before_n) << height_m;
    before_n = force_n;
  }
}

// Cells a hundred times as large at the far end as at the contact: the force of graded cells within 5 % of that of
// uniform ones.
TEST(ReferenceContact, GradedCells) {
  scene::Scene scene = ball_on_ball();
  const double even_n = last_n(solved(scene));
  scene.reference.element_size_m = 0.0001;
  scene.track[1] = at(1.0, {0.0, 0.0, 0.066});
  EXPECT_NEAR(last_n(solved(scene)) / even_n, 1.0, 0.05);
}

// A press of nine tenths of the tool's radius: converged, and the force grows faster than the depth. With the tool's
// centre in the body it is refused.
TEST(ReferenceContact, DeepPress) {
  scene::Scene scene = ball_on_ball();
  scene.track[1] = at(1.0, {0.0, 0.0, 0.061});
  scene.compare.instants = 16;
  const Result result = solved(scene);
  const auto half = std::find_if(result.instants.begin(), result.instants.end(),
                                 [](const scene::InstantRecord& one) { return one.depth_m > 0.0045; });
  ASSERT_NE(half, result.instants.end());
  EXPECT_GT(last_n(result) / result.instants.back().depth_m, half->force_n().norm() / half->depth_m);
  scene.track[1] = at(1.0, {0.0, 0.0, 0.0599});
  EXPECT_THROW(solved(scene), scene::InputError);
}

// The whole depth in one step: the force of many small steps, to the 3 % by which other meshes change it.
TEST(ReferenceContact, OneLargeStep) {
  scene::Scene scene = ball_on_ball();
  scene.compare.instants = 2;
  const double one_n = last_n(solved(scene));
  scene.compare.instants = 40;
  EXPECT_NEAR(one_n / last_n(solved(scene)), 1.0, 0.03);
}

// Incompressible and fixed on a very small area only: a body on the smallest support is in equilibrium.
TEST(ReferenceContact, SmallestSupport) {
  scene::Scene scene = ball_on_ball();
  scene.body.material.poissons_ratio = 0.5;
  const double held_n = last_n(solved(scene));
  scene.body.support_height_m = 0.0005;
  const double hardly_n = last_n(solved(scene));
  EXPECT_GT(hardly_n, 0.0);
  EXPECT_LT(hardly_n, held_n);
}

// A ball in different orientations: the same force to 1e-9.
TEST(ReferenceContact, OrientationOfABallHasNoEffect) {
  scene::Scene scene = ball_on_ball();
  const double upright_n = last_n(solved(scene));
  for (scene::Waypoint& w : scene.track) {
    w.pose.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(2.0, Vec3(1.0, 2.0, 3.0).normalized()));
  }
  EXPECT_NEAR(last_n(solved(scene)) / upright_n, 1.0, 1e-9);
}

}  // namespace
}  // namespace touchstone::reference::extremes
