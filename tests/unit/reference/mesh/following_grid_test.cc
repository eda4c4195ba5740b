// Cells along inclusions: of the right volume, regular on every mesh, and none where they cannot be.
#include "reference/mesh/following_grid.h"

#include "reference/mesh/inclusions.h"
#include "reference/mesh/round_mesh.h"
#include "reference/run/model_choice.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::reference {
namespace {

scene::Inclusion ball(double radius_m, const scene::Vec3& center_m) {
  scene::Inclusion inclusion;
  inclusion.shape = scene::BodyShape::sphere;
  inclusion.radius_m = radius_m;
  inclusion.center_m = center_m;
  inclusion.material = {3e4, 0.33};
  return inclusion;
}

scene::Scene pressed(scene::BodyShape shape, const scene::Vec3& tool_m) {
  scene::Scene scene;
  scene.body.shape = shape;
  scene.body.size_m = {0.06, 0.06, 0.06};
  scene.body.semi_axes_m = {0.04, 0.03, 0.025};
  scene.body.radius_m = 0.03;
  scene.body.support_height_m = shape == scene::BodyShape::box ? 0.0 : 0.005;
  scene.body.material = {3e6, 0.5};
  scene.tool.radius_m = 0.01;
  scene.track = {{0.0, {tool_m, Eigen::Quaterniond::Identity()}},
                 {1.0, {tool_m - scene::Vec3(0.0, 0.0, 0.002), Eigen::Quaterniond::Identity()}}};
  scene.compare.instants = 5;
  return scene;
}

/// Volumes of the inclusions over the exact ones, and the least ratio of a cell's Gauss weights.
template <int dim>
void expect_regular(const scene::Scene& scene, const ModelChoice& choice, double within) {
  double share = 1.0;  // of the body that is meshed
  if (dim == 3) share = (choice.mirror_x ? 0.5 : 1.0) * (choice.mirror_y ? 0.5 : 1.0);
  for (int level = 0; level < 3; ++level) {
    SCOPED_TRACE(level);
    const Discretisation<dim> mesh = level_mesh<dim>(scene, choice, level);
    const std::vector<CellGeometry<dim>> geometry = mesh.cell_geometry();
    std::vector<double> volume_m3(scene.body.inclusions.size() + 1, 0.0);
    double least = 1.0;
    for (int c = 0; c < mesh.cell_count(); ++c) {
      const auto& materials = *mesh.materials_of(c);
      EXPECT_EQ(std::count(materials.begin(), materials.end(), materials[0]), CellGeometry<dim>::points);
      double least_m = std::numeric_limits<double>::infinity(), most_m = 0.0;
      for (int q = 0; q < CellGeometry<dim>::points; ++q) {
        const double det = 1.0 / geometry[c].inverse_jacobian_per_m[q].determinant();
        least_m = std::min(least_m, det);
        most_m = std::max(most_m, det);
        const double around_m = dim == 2 ? 2.0 * std::numbers::pi * geometry[c].place_m[q].x() : 1.0;
        volume_m3[materials[0]] += around_m * geometry[c].weight[q];
      }
      least = std::min(least, least_m / most_m);
    }
    EXPECT_GT(least, 0.02);
    std::printf("level %d: %d cells, least %.3g", level, mesh.cell_count(), least);
    for (std::size_t k = 0; k < scene.body.inclusions.size(); ++k) {
      const auto shape = solid_shape(scene.body.inclusions[k], scene.body.inclusions[k].center_m);
      std::printf(", volume %.6f", volume_m3[k + 1] / (share * shape->volume_m3()));
      EXPECT_NEAR(volume_m3[k + 1] / (share * shape->volume_m3()), 1.0, within * std::pow(refinement(level), -3));
    }
    std::printf("\n");
  }
}

void expect_following(const scene::Scene& scene, double within = 0.02) {
  const ModelChoice choice = choose_model(scene);
  ASSERT_TRUE(choice.follows()) << choice.why_cut;
  choice.dim == 2 ? expect_regular<2>(scene, choice, within) : expect_regular<3>(scene, choice, within);
}

TEST(FollowingGrid, InTheMeridianPlane) {
  scene::Scene scene = pressed(scene::BodyShape::sphere, {0.0, 0.0, 0.07});
  scene.body.inclusions = {ball(0.008, {0.0, 0.0, 0.045})};
  expect_following(scene);
  scene.body.inclusions = {ball(0.008, {0.0, 0.0, 0.047}), ball(0.006, {0.0, 0.0, 0.02})};
  expect_following(scene);
  scene.body.inclusions[0].shape = scene::BodyShape::ellipsoid;
  scene.body.inclusions[0].semi_axes_m = {0.012, 0.012, 0.005};
  expect_following(scene);
  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = {0.040, 0.040, 0.030};
  scene.body.inclusions = {ball(0.008, {0.0, 0.0, 0.047})};
  expect_following(scene);
}

TEST(FollowingGrid, InACube) {
  scene::Scene scene = pressed(scene::BodyShape::box, {0.0, 0.0, 0.07});
  scene.body.inclusions = {ball(0.008, {0.0, 0.0, 0.045})};
  expect_following(scene);
  scene.body.inclusions = {ball(0.009, {0.010, 0.005, 0.030})};
  expect_following(scene);
  scene.body.inclusions = {ball(0.008, {0.012, 0.0, 0.040}), ball(0.006, {-0.014, 0.0, 0.040})};
  expect_following(scene);
}

TEST(FollowingGrid, InTheShippedEllipsoid) {
  expect_following(scene::load_scene(source_folder() + "/meshes/scenes/ellipsoid-pvc-inside.toml"));
}

TEST(FollowingGrid, NoneWhereItCannotBe) {
  scene::Scene scene = pressed(scene::BodyShape::box, {0.0, 0.0, 0.07});
  scene.body.inclusions = {ball(0.008, {0.0, 0.0, 0.045})};
  EXPECT_TRUE(choose_model(scene).follows());
  scene.body.inclusions[0].center_m.z() = 0.055;  // sticks out
  EXPECT_FALSE(choose_model(scene).follows());
  scene.body.inclusions = {ball(0.008, {0.003, 0.0, 0.04}), ball(0.008, {-0.003, 0.0, 0.04})};  // overlap
  EXPECT_FALSE(choose_model(scene).follows());
  scene.body.inclusions = {ball(0.0005, {0.0, 0.0, 0.045})};
  EXPECT_FALSE(choose_model(scene).follows());
  scene.body.inclusions = {ball(0.008, {0.0, 0.0, 0.045})};
  scene.body.inclusions[0].shape = scene::BodyShape::box;
  scene.body.inclusions[0].size_m = {0.01, 0.01, 0.01};
  const ModelChoice choice = choose_model(scene);
  EXPECT_FALSE(choice.follows());
  EXPECT_NE(choice.why_cut.find("no"), std::string::npos);
}

}  // namespace
}  // namespace touchstone::reference
