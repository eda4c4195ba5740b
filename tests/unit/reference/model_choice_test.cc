#include "reference/model_choice.h"

#include "reference/sampling.h"

#include <gtest/gtest.h>

namespace touchstone::reference {
namespace {

scene::Scene cube(const scene::Vec3& from_m, const scene::Vec3& to_m) {
  scene::Scene scene;
  scene.body.size_m = {0.06, 0.06, 0.06};
  scene.body.material = {3e6, 0.5};
  scene.tool.radius_m = 0.01;
  scene.track = {{0.0, {from_m, Eigen::Quaterniond::Identity()}}, {1.0, {to_m, Eigen::Quaterniond::Identity()}}};
  scene.compare.instants = 5;
  scene.reference.levels = 3;
  return scene;
}

TEST(ModelChoice, UsesEverySymmetryOfTheWholeTrack) {
  const auto quarter = choose_model(cube({0, 0, .07}, {0, 0, .068}));
  EXPECT_TRUE(quarter.mirror_x && quarter.mirror_y);
  EXPECT_EQ(quarter.name(scene::Kinematics::finite), "quarter 3D u-p finite strain");
  const auto half = choose_model(cube({0, 0, .068}, {.01, 0, .068}));
  EXPECT_FALSE(half.mirror_x);
  EXPECT_TRUE(half.mirror_y);
  EXPECT_EQ(choose_model(cube({0, 0, .068}, {.01, .01, .068})).name(scene::Kinematics::small),
            "full 3D u-p small strain");
}

TEST(ModelChoice, EveryLevelIsFinerUnderTheTool) {
  const scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  int cells = 0;
  for (int level = 0; level < 3; ++level) {
    EXPECT_DOUBLE_EQ(element_size_m(scene, level), 2.0 * element_size_m(scene, level + 1));
    const Mesh<3> mesh = level_mesh<3>(scene, choose_model(scene), level);
    EXPECT_GT(mesh.cell_count(), cells);
    cells = mesh.cell_count();
  }
}

TEST(ModelChoice, NamesWhatItCannotDo) {
  scene::Scene scene = cube({0, 0, .07}, {0, 0, .055});
  ASSERT_EQ(unsupported_parts(scene).size(), 1u);
  EXPECT_NE(unsupported_parts(scene)[0].message.find("centre is inside"), std::string::npos);
  scene = cube({.001, 0, .07}, {.001, 0, .068});
  EXPECT_TRUE(unsupported_parts(scene).empty());
  scene.body.shape = scene::BodyShape::sphere;
  scene.body.radius_m = 0.03;
  scene.body.support_height_m = 0.006;
  EXPECT_TRUE(unsupported_parts(scene).empty());
  scene.body.support_height_m = 1e-5;
  ASSERT_EQ(unsupported_parts(scene).size(), 1u);
  EXPECT_TRUE(unsupported_parts(scene)[0].message.starts_with("body.support_height_m: "));
}

TEST(SurfaceSampler, GivesBackALinearFieldEverywhereAroundTheBody) {
  const scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  const ModelChoice choice = choose_model(scene);
  const Mesh<3> mesh = level_mesh<3>(scene, choice, 0);
  Eigen::Matrix3Xd points_m(3, 3);
  points_m << .0123, -.0123, .03, .0077, -.0177, -.011, .06, .06, .02;
  const SurfaceSampler<3> sampler(mesh, points_m, choice.mirror_x, choice.mirror_y);
  const Eigen::Matrix3Xd u_m = sampler.displacement_m(0.1 * mesh.points_m);  // odd in x and y, as symmetry asks
  EXPECT_LT((u_m - 0.1 * points_m).cwiseAbs().maxCoeff(), 1e-14);
  Eigen::Matrix3Xd inside(3, 1);
  inside << 0, 0, .03;
  EXPECT_THROW(SurfaceSampler<3>(mesh, inside, true, true), scene::InputError);
}

}  // namespace
}  // namespace touchstone::reference
