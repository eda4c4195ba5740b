// Cells along inclusions: of the right volume, regular and alike on every mesh, and none where they cannot be.
#include "reference/mesh/following_grid.h"

#include "reference/mesh/inclusions.h"
#include "reference/mesh/round_mesh.h"
#include "reference/run/model_choice.h"
#include "scene/base/in_space.h"
#include "scene/input/scene_io.h"
#include "support/source_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
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

/// Sides of cells on an inclusion's surface, seen from within.
template <int dim>
int sides_on_surface(const scene::Scene& scene, const Discretisation<dim>& mesh) {
  int sides = 0;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const int material = (*mesh.materials_of(c))[0];
    if (material == 0) continue;
    const scene::Inclusion& inclusion = scene.body.inclusions[material - 1];
    const auto shape = solid_shape(inclusion, inclusion.center_m);
    const auto on_it = [&](int node) {
      const scene::Vec3 place_m = scene::in_space<dim>(mesh.points_m.col(node));
      return std::abs(shape->signed_distance_m(place_m)) < 1e-12;
    };
    // Nodes in the middle of a hanging side lie off it.
    int corners = 0;
    for (int v = 0; v < 1 << dim; ++v) {
      const int place = 2 * (v & 1) + 6 * (v >> 1 & 1) + 18 * (v >> 2 & 1);
      corners += on_it(mesh.cells[c][place]) ? 1 : 0;
    }
    sides += corners == 1 << (dim - 1) ? 1 : 0;
  }
  return sides;
}

/// The inclusions have their volumes, and cells of one material, of no flat shape, and all divided alike at the
/// surface.
template <int dim>
void expect_regular(const scene::Scene& scene, const ModelChoice& choice) {
  constexpr double within = 0.01, flattest = 0.05;  // of the volume on the first mesh; of det J in a cell
  const double share = dim == 2 ? 1.0 : (choice.mirror_x ? 0.5 : 1.0) * (choice.mirror_y ? 0.5 : 1.0);
  int sides = 0;
  for (int level = 0; level < 3; ++level) {
    SCOPED_TRACE(level);
    const Discretisation<dim> mesh = level_mesh<dim>(scene, choice, level);
    const std::vector<CellGeometry<dim>> geometry = mesh.cell_geometry();
    std::vector<double> volume_m3(scene.body.inclusions.size() + 1, 0.0);
    for (int c = 0; c < mesh.cell_count(); ++c) {
      const auto& materials = *mesh.materials_of(c);
      EXPECT_EQ(std::count(materials.begin(), materials.end(), materials[0]), CellGeometry<dim>::points);
      double least = std::numeric_limits<double>::infinity(), most = 0.0;
      for (int q = 0; q < CellGeometry<dim>::points; ++q) {
        const double det_per_m = geometry[c].inverse_jacobian_per_m[q].determinant();
        least = std::min(least, 1.0 / det_per_m);
        most = std::max(most, 1.0 / det_per_m);
        const double around_m = dim == 2 ? 2.0 * std::numbers::pi * geometry[c].place_m[q].x() : 1.0;
        volume_m3[materials[0]] += around_m * geometry[c].weight[q];
      }
      EXPECT_GT(least, flattest * most);
    }
    for (std::size_t k = 0; k < scene.body.inclusions.size(); ++k) {
      const auto shape = solid_shape(scene.body.inclusions[k], scene.body.inclusions[k].center_m);
      EXPECT_NEAR(volume_m3[k + 1] / (share * shape->volume_m3()), 1.0, within * std::pow(refinement(level), -3));
    }
    const int now = sides_on_surface(scene, mesh);
    EXPECT_TRUE(level == 0 || now == (1 << (dim - 1)) * sides) << now << " after " << sides;
    sides = now;
    if (level > 0) continue;
    const Discretisation<dim> smaller = level_mesh<dim>(scene, choice, 0, {.far_field = 1.0, .inclusions = 0.5});
    EXPECT_EQ(sides_on_surface(scene, smaller), (1 << (dim - 1)) * sides);
  }
}

void expect_following(const scene::Scene& scene) {
  const ModelChoice choice = choose_model(scene);
  ASSERT_TRUE(choice.follows()) << choice.why_cut;
  choice.dim == 2 ? expect_regular<2>(scene, choice) : expect_regular<3>(scene, choice);
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
  EXPECT_EQ(choice.why_cut, "not every inclusion is a ball or an ellipsoid");
}

}  // namespace
}  // namespace touchstone::reference
