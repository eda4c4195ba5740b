#include "fast/bench/bullet_peer.h"

#include <gtest/gtest.h>

namespace touchstone::bench {
namespace {

BulletScene small_block() {
  BulletScene scene;
  scene.cells = 4;
  scene.youngs_modulus_pa = 33.77e3;
  scene.poissons_ratio = 0.33;
  scene.implicit = false;
  return scene;
}

TEST(BulletPeer, HasTheTrianglesOfTheGridsFaces) {
  for (const int cells : {3, 4}) {
    BulletScene scene = small_block();
    scene.cells = cells;
    const BulletPeer peer(scene);
    EXPECT_EQ(peer.surface_triangles(), 12 * cells * cells);
    EXPECT_EQ(peer.tetrahedra(), 5 * cells * cells * cells);
  }
}

TEST(BulletPeer, StaysAtRestUntouched) {
  BulletPeer peer(small_block());
  for (int k = 0; k < 20; ++k) peer.step(peer.top_node_m() + scene::Vec3(0, 0, 0.02));
  EXPECT_TRUE(peer.sound());
  EXPECT_EQ(peer.contacts(), 0);
  EXPECT_EQ(peer.pierced_m(), 0.0);
  EXPECT_LT(std::abs(peer.dent_m()), 1e-6);
}

TEST(BulletPeer, GivesWayUnderTheBallAndIsNotPierced) {
  BulletPeer peer(small_block());
  constexpr double depth_m = 0.0025;
  const auto press = [&](double d_m) { peer.step(peer.top_node_m() + scene::Vec3(0, 0, 0.010 - d_m)); };
  for (int k = 1; k <= 40; ++k) press(depth_m * k / 40);
  for (int k = 0; k < 20; ++k) press(depth_m);
  EXPECT_TRUE(peer.sound());
  EXPECT_GT(peer.contacts(), 0);
  EXPECT_NEAR(peer.dent_m(), depth_m, 0.3 * depth_m);
  EXPECT_LT(peer.pierced_m(), 0.2 * depth_m);
}

TEST(BulletPeer, TellsHowFarEveryPlaceOfItsSurfaceMoved) {
  BulletPeer peer(small_block());
  for (int k = 1; k <= 40; ++k) peer.step(peer.top_node_m() + scene::Vec3(0, 0, 0.010 - 0.0025 * k / 40));
  const scene::Vec3 node_m = peer.top_node_m();
  const double spacing_m = small_block().edge_m / small_block().cells;
  const scene::Vec3 next_m = node_m + scene::Vec3(spacing_m, 0, 0);
  Eigen::Matrix3Xd places_m(3, 4);
  places_m << node_m, next_m, 0.5 * (node_m + next_m), scene::Vec3(0.2 * spacing_m, 0.1 * spacing_m, 0.0);
  const Eigen::Matrix3Xd u_m = peer.displacement_m(places_m);
  EXPECT_DOUBLE_EQ(-u_m(2, 0), peer.dent_m());
  EXPECT_LT(-u_m(2, 1), peer.dent_m());
  EXPECT_LT((u_m.col(2) - 0.5 * (u_m.col(0) + u_m.col(1))).norm(), 1e-12);
  EXPECT_LT(u_m.col(3).norm(), 1e-8) << "the base is held";
}

TEST(BulletPeer, ABallInsideItIsSeenToPierceIt) {
  BulletPeer peer(small_block());
  // One step is too short for the body to move away.
  peer.step(peer.top_node_m() - scene::Vec3(0, 0, 0.01));
  EXPECT_GT(peer.pierced_m(), 0.001);
}

}  // namespace
}  // namespace touchstone::bench
