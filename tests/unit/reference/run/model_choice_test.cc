#include "reference/run/model_choice.h"

#include "reference/fe/element.h"
#include "reference/mesh/sampling.h"
#include "reference/tool/tool_distance.h"
#include "scene/shape/surface.h"
#include "support/mesh_tools.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

using test::mesh_tool;
using test::turned;

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

TEST(ModelChoice, WithFrictionTheMotionCountsForSymmetry) {
  scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  scene.contact.friction = scene::Friction{0.3, 1.0, 0.3};
  EXPECT_EQ(choose_model(scene).name(scene::Kinematics::finite), "quarter 3D u-p finite strain");
  scene.track[1].pose.orientation = turned(0.3, scene::Vec3::UnitY());  // rolls along x
  EXPECT_EQ(choose_model(scene).name(scene::Kinematics::finite), "half 3D u-p finite strain");
  EXPECT_TRUE(choose_model(scene).mirror_y);
  scene.track[1].pose.orientation = turned(0.3, scene::Vec3::UnitZ());  // twists
  EXPECT_EQ(choose_model(scene).name(scene::Kinematics::finite), "full 3D u-p finite strain");

  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = {0.03, 0.03, 0.03};
  EXPECT_EQ(choose_model(scene).dim, 3);
  scene.track[1].pose.orientation.setIdentity();
  EXPECT_EQ(choose_model(scene).dim, 2);
  scene.track[1].pose.orientation = turned(0.3, scene::Vec3::UnitZ());
  scene.contact.friction.reset();
  EXPECT_EQ(choose_model(scene).dim, 2);
}

TEST(ModelChoice, InclusionsCountForSymmetry) {
  scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  scene::Inclusion ball;
  ball.shape = scene::BodyShape::sphere;
  ball.radius_m = 0.005;
  ball.center_m = {0.01, 0.0, 0.03};
  ball.material = {3e4, 0.33};
  scene.body.inclusions = {ball};
  EXPECT_FALSE(choose_model(scene).mirror_x);
  EXPECT_TRUE(choose_model(scene).mirror_y);
  scene.body.inclusions.push_back(ball);
  scene.body.inclusions.back().center_m.x() = -0.01;
  EXPECT_TRUE(choose_model(scene).mirror_x);
  scene.body.inclusions.back().material.poissons_ratio = 0.3;
  EXPECT_FALSE(choose_model(scene).mirror_x);

  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = {0.03, 0.03, 0.02};
  scene.body.inclusions = {};
  EXPECT_EQ(choose_model(scene).dim, 2);
  scene.body.inclusions = {ball};
  EXPECT_EQ(choose_model(scene).dim, 3);
  scene.body.inclusions[0].center_m.x() = 0.0;
  EXPECT_EQ(choose_model(scene).dim, 2);
  scene.body.inclusions[0].shape = scene::BodyShape::box;
  EXPECT_EQ(choose_model(scene).dim, 3);
  EXPECT_TRUE(choose_model(scene).mirror_x && choose_model(scene).mirror_y);
}

/// With edges, so that the cells do not follow it.
scene::Inclusion roll() {
  scene::Inclusion roll;
  roll.shape = scene::BodyShape::revolution;
  roll.profile = {{{0.0, 0.0}, {0.008, 0.0}, {0.008, 0.016}, {0.0, 0.016}}, {}};
  roll.center_m = {0.0, 0.0, 0.03};
  roll.material = {3e4, 0.33};
  return roll;
}

/// Small cells at the surface of an inclusion that they cut, its volume right, and both refined from level to level.
TEST(ModelChoice, EveryLevelResolvesAnInclusionThatCellsCut) {
  scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  scene.body.inclusions = {roll()};
  EXPECT_FALSE(choose_model(scene).follows());
  constexpr double radius_m = 0.008, quarter_m3 = 0.25 * M_PI * radius_m * radius_m * 0.016;
  for (int level = 0; level < 2; ++level) {
    const Discretisation<3> mesh = level_mesh<3>(scene, choose_model(scene), level);
    ASSERT_EQ(mesh.materials.size(), mesh.cells.size());
    double volume_m3 = 0.0;
    for (int c = 0; c < mesh.cell_count(); ++c) {
      Eigen::Matrix<double, 3, 27> X;
      for (int a = 0; a < 27; ++a) X.col(a) = mesh.points_m.col(mesh.cells[c][a]);
      const Eigen::Vector3d size_m = X.rowwise().maxCoeff() - X.rowwise().minCoeff();
      const auto& materials = *mesh.materials_of(c);
      const auto within = std::count(materials.begin(), materials.end(), 1);
      volume_m3 += size_m.prod() * within / 27.0;
      if (within > 0 && within < 27) {
        EXPECT_LE(size_m.mean(), radius_m / refinement(level) * (1 + 1e-6));
      }
    }
    EXPECT_NEAR(volume_m3 / quarter_m3, 1.0, 0.25 / refinement(level));
  }
}

/// Longest edge of the cells at a place on the surface.
template <int dim>
double cell_size_at_m(const Discretisation<dim>& mesh, const Eigen::Matrix<double, dim, 1>& place_m) {
  double largest_m = 0.0;
  for (const auto& cell : mesh.cells) {
    Eigen::Matrix<double, dim, Discretisation<dim>::nodes_per_cell> X_m;
    for (int a = 0; a < Discretisation<dim>::nodes_per_cell; ++a) X_m.col(a) = mesh.points_m.col(cell[a]);
    const Eigen::Matrix<double, dim, 1> low_m = X_m.rowwise().minCoeff(), high_m = X_m.rowwise().maxCoeff();
    const double edge_m = (high_m - low_m).maxCoeff();
    const double near_m = 1e-3 * edge_m;
    if (((place_m - low_m).array() > -near_m).all() && ((high_m - place_m).array() > -near_m).all()) {
      largest_m = std::max(largest_m, edge_m);
    }
  }
  return largest_m;
}

TEST(ModelChoice, EveryLevelIsFinerUnderTheToolByWhatItSays) {
  const scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  const ModelChoice choice = choose_model(scene);
  const double coarsest_m = cell_size_at_m<3>(level_mesh<3>(scene, choice, 0), {0.0, 0.0, 0.06});
  EXPECT_LE(coarsest_m, element_size_m(scene, choice, 0) * (1.0 + 1e-6));
  const double finer[] = {1.0, 2.0, 4.0};
  int cells = 0;
  for (int level = 0; level < 3; ++level) {
    EXPECT_DOUBLE_EQ(refinement(level), finer[level]);
    EXPECT_DOUBLE_EQ(element_size_m(scene, choice, 0), finer[level] * element_size_m(scene, choice, level));
    const Discretisation<3> mesh = level_mesh<3>(scene, choice, level);
    EXPECT_NEAR(cell_size_at_m<3>(mesh, {0.0, 0.0, 0.06}) * finer[level] / coarsest_m, 1.0, 1e-9) << level;
    EXPECT_GT(mesh.cell_count(), cells);
    cells = mesh.cell_count();
  }
  // Cells of a round body are bent and never of equal size; near the pole they come close.
  scene::Scene round = scene;
  round.body.shape = scene::BodyShape::sphere;
  round.body.radius_m = 0.03;
  round.body.support_height_m = 0.006;
  const double pole_m = cell_size_at_m<2>(level_mesh<2>(round, choose_model(round), 0), {0.0, 0.06});
  for (int level = 1; level < 3; ++level) {
    const Discretisation<2> mesh = level_mesh<2>(round, choose_model(round), level);
    EXPECT_NEAR(cell_size_at_m<2>(mesh, {0.0, 0.06}) * finer[level] / pole_m, 1.0, 0.1) << level;
  }
}

TEST(ModelChoice, MeshChangesDoWhatTheySay) {
  scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  scene.body.inclusions = {roll()};
  const ModelChoice choice = choose_model(scene);
  const Discretisation<3> usual = level_mesh<3>(scene, choice, 0);
  const Eigen::Vector3d contact_m(0.0, 0.0, 0.06), corner_m(0.03, 0.03, 0.0), end_m(0.0, 0.0, 0.022);
  const Discretisation<3> far = level_mesh<3>(scene, choice, 0, {.far_field = 0.5, .inclusions = 1.0});
  EXPECT_NEAR(cell_size_at_m<3>(far, contact_m), cell_size_at_m<3>(usual, contact_m), 1e-12);
  EXPECT_NEAR(cell_size_at_m<3>(far, corner_m), 0.5 * cell_size_at_m<3>(usual, corner_m), 1e-12);
  const Discretisation<3> inside = level_mesh<3>(scene, choice, 0, {.far_field = 1.0, .inclusions = 0.5});
  EXPECT_NEAR(cell_size_at_m<3>(inside, contact_m), cell_size_at_m<3>(usual, contact_m), 1e-12);
  EXPECT_NEAR(cell_size_at_m<3>(inside, end_m), 0.5 * cell_size_at_m<3>(usual, end_m), 1e-12);
}

TEST(ModelChoice, NamesWhatItCannotDo) {
  scene::Scene scene = cube({0, 0, .07}, {0, 0, .055});
  ASSERT_EQ(unsupported_parts(scene).size(), 1u);
  EXPECT_EQ(unsupported_parts(scene)[0].message,
            "track, t = 0.75 s: the tool's centre is inside the body's rest shape; expected a depth below the radius, "
            "0.01 m, found 0.01125 m");
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

TEST(ModelChoice, NeedsTheToolsSymmetryToo) {
  scene::Scene scene = cube({0, 0, .07}, {0, 0, .064});
  scene.tool.shape = scene::ToolShape::box;
  scene.tool.size_m = {.01, .012, .01};
  EXPECT_TRUE(choose_model(scene).mirror_x && choose_model(scene).mirror_y);
  scene.tool.mass_center_m = scene::Vec3(.001, 0, 0);
  EXPECT_FALSE(choose_model(scene).mirror_x);
  EXPECT_TRUE(choose_model(scene).mirror_y);
  scene.tool.mass_center_m.reset();
  // Turning about z by half a turn, it is symmetric only at both ends, which are all the instants.
  scene.compare.instants = 2;
  scene.track[1].pose.orientation = turned(3.14159265358979, {0, 0, 1});
  EXPECT_FALSE(choose_model(scene).mirror_x || choose_model(scene).mirror_y);
  scene.tool = mesh_tool(scene::Box(scene::Vec3::Zero(), {.01, .012, .01}), 100);
  scene.track[1].pose.orientation.setIdentity();
  EXPECT_TRUE(choose_model(scene).mirror_x && choose_model(scene).mirror_y);

  scene.body.shape = scene::BodyShape::sphere;
  scene.body.radius_m = 0.03;
  scene.tool = {};
  scene.tool.shape = scene::ToolShape::capsule;
  scene.tool.radius_m = 0.005;
  scene.tool.length_m = 0.01;
  EXPECT_EQ(choose_model(scene).dim, 2);
  scene.track[1].pose.orientation = turned(0.01, {1, 0, 0});
  EXPECT_EQ(choose_model(scene).dim, 3);
}

TEST(ModelChoice, AxialSymmetryNeedsBodyToolAndInclusions) {
  scene::Scene scene = cube({0, 0, .0555}, {0, 0, .052});
  scene.body.shape = scene::BodyShape::revolution;
  scene.body.profile = scene::cylinder_profile(0.03, 0.04, 0.005);
  scene.tool.shape = scene::ToolShape::cylinder;
  scene.tool.radius_m = 0.006;
  scene.tool.length_m = 0.03;
  scene.tool.edge_radius_m = 0.0015;
  EXPECT_EQ(choose_model(scene).dim, 2);
  EXPECT_TRUE(unsupported_parts(scene).empty());
  scene::Inclusion& ball = scene.body.inclusions.emplace_back();
  ball.shape = scene::BodyShape::sphere;
  ball.radius_m = 0.005;
  ball.center_m = {0, 0, .02};
  EXPECT_EQ(choose_model(scene).dim, 2);
  ball.center_m.x() = 0.01;
  EXPECT_EQ(choose_model(scene).name(scene::Kinematics::finite), "half 3D u-p finite strain, cells along inclusions");
  EXPECT_TRUE(choose_model(scene).mirror_y);
  scene.body.inclusions.clear();
  scene.tool.shape = scene::ToolShape::box;
  scene.tool.size_m = {.01, .012, .03};
  EXPECT_EQ(choose_model(scene).name(scene::Kinematics::finite), "quarter 3D u-p finite strain");
}

TEST(ModelChoice, RefusesAPinTooSharp) {
  scene::Scene scene = cube({0, 0, .08}, {0, 0, .074});
  scene.tool.shape = scene::ToolShape::cylinder;
  scene.tool.length_m = 0.03;
  scene.tool.edge_radius_m = 0.0025;
  EXPECT_TRUE(unsupported_parts(scene).empty());
  scene.tool.edge_radius_m = 0.0024;
  ASSERT_EQ(unsupported_parts(scene).size(), 1u);
  const std::string text = unsupported_parts(scene)[0].message;
  EXPECT_TRUE(text.starts_with("tool.edge_radius_m: a sharp rim")) << text;
  EXPECT_NE(text.find("expected at least a quarter of the radius, 0.0025 m, found 0.0024 m"), std::string::npos)
      << text;
}

TEST(ContactPatch, IsHertzsForSmoothToolsAndTheFaceOfAFlatOne) {
  const scene::Box body({0, 0, .03}, {.06, .06, .06});
  const auto patches = [&](const scene::Tool& tool, const scene::Pose& pose) {
    return contact_patches(body, tool_points(tool, *tool_distance(tool)), pose, 0.004);
  };
  const double R_m = 0.01, depth_m = 0.001;
  const scene::Pose above{{0.004, -0.002, .06 + R_m - depth_m}, Eigen::Quaterniond::Identity()};
  const auto ball = patches(mesh_tool(scene::Sphere(scene::Vec3::Zero(), R_m), 5120), above);
  ASSERT_EQ(ball.size(), 1u);
  EXPECT_NEAR(ball[0].half_width_m, std::sqrt(R_m * depth_m), 0.1 * std::sqrt(R_m * depth_m));
  EXPECT_LT((ball[0].center_m - scene::Vec3(0.004, -0.002, .06)).norm(), 2e-4);
  EXPECT_NEAR(ball[0].depth_m, depth_m, 2e-5);
  EXPECT_EQ(ball[0].discs.size(), 1u);
  EXPECT_TRUE(ball[0].rims.empty());

  scene::Tool tool;
  tool.shape = scene::ToolShape::cylinder;
  tool.radius_m = R_m;
  tool.length_m = 2.0 * R_m;
  tool.edge_radius_m = 0.0025;
  const auto pin = patches(tool, above);
  ASSERT_EQ(pin.size(), 1u);
  EXPECT_GT(pin[0].half_width_m, R_m - tool.edge_radius_m);
  EXPECT_LT(pin[0].half_width_m, R_m);
  ASSERT_FALSE(pin[0].rims.empty());
  for (const ContactPatch::Rim& rim : pin[0].rims) EXPECT_NEAR(rim.bend_radius_m, tool.edge_radius_m, 1e-9);

  // Lying along x: as wide as a ball's contact, and covered by several discs.
  tool.shape = scene::ToolShape::capsule;
  tool.length_m = 0.02;
  const auto line = patches(tool, {above.position_m, turned(1.5707963267949, {0, 1, 0})});
  ASSERT_EQ(line.size(), 1u);
  EXPECT_NEAR(line[0].half_width_m, std::sqrt(R_m * depth_m), 0.1 * std::sqrt(R_m * depth_m));
  EXPECT_GT(line[0].discs.size(), 3u);
  for (const double x_m : {-0.01, 0.0, 0.01}) {
    const scene::Vec3 p_m(0.004 + x_m, -0.002, .06);
    EXPECT_TRUE(std::any_of(line[0].discs.begin(), line[0].discs.end(),
                            [&](const auto& disc) { return (disc.center_m - p_m).norm() < disc.radius_m; }));
  }
}

TEST(SurfaceSampler, FindsTheSurfaceOfRoundBodies) {
  scene::Scene scene = cube({0, 0, .0605}, {0, 0, .058});
  scene.body.shape = scene::BodyShape::ellipsoid;
  scene.body.semi_axes_m = {0.04, 0.02, 0.03};
  scene.body.support_height_m = 0.005;
  const ModelChoice choice = choose_model(scene);
  const Discretisation<3> mesh = level_mesh<3>(scene, choice, 0);
  const Eigen::Matrix3Xd points_m = scene::tessellate(*scene::body_shape(scene.body), 1000).points_m;
  const SurfaceSampler<3> sampler(mesh, points_m, choice.mirror_x, choice.mirror_y);
  EXPECT_LT((sampler.at_points(mesh.points_m) - points_m).cwiseAbs().maxCoeff(), 2e-4);
}

TEST(SurfaceSampler, GivesBackALinearFieldEverywhereAroundTheBody) {
  const scene::Scene scene = cube({0, 0, .07}, {0, 0, .068});
  const ModelChoice choice = choose_model(scene);
  const Discretisation<3> mesh = level_mesh<3>(scene, choice, 0);
  Eigen::Matrix3Xd points_m(3, 3);
  points_m << .0123, -.0123, .03, .0077, -.0177, -.011, .06, .06, .02;
  const SurfaceSampler<3> sampler(mesh, points_m, choice.mirror_x, choice.mirror_y);
  const Eigen::Matrix3Xd u_m = sampler.at_points(0.1 * mesh.points_m);  // odd in x and y, as symmetry asks
  EXPECT_LT((u_m - 0.1 * points_m).cwiseAbs().maxCoeff(), 1e-14);
  Eigen::Matrix3Xd inside(3, 1);
  inside << 0, 0, .03;
  EXPECT_THROW(SurfaceSampler<3>(mesh, inside, true, true), scene::InputError);
}

}  // namespace
}  // namespace touchstone::reference
