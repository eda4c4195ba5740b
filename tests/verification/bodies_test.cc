// One body meshed in two ways gives one force.
#include "reference/contact/contact_problem.h"
#include "reference/mesh/round_mesh.h"
#include "reference/run/model_choice.h"
#include "reference/tool/tool_distance.h"
#include "reference/verification/closed_forms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::reference {
namespace {

constexpr double ball_m = 0.01;

/// Force of a ball pressed 2 mm into the body's top, on the axis.
template <int dim>
double pressed_n(const Mesh<dim>& mesh, double top_m, double nu, bool mirror_x = true, bool mirror_y = true) {
  constexpr double depth_m = 0.002;
  constexpr int steps = 2;
  ContactProblem<dim> body(mesh, {3e6, nu}, scene::Kinematics::finite, mirror_x, mirror_y, 1);
  State<dim> state = body.rest();
  for (int step = 1; step <= steps; ++step) {
    Eigen::Matrix<double, dim, 1> center_m = Eigen::Matrix<double, dim, 1>::Zero();
    center_m[dim - 1] = top_m + ball_m - depth_m * step / steps;
    body.set_tool(ball_tool<dim>(ball_m, center_m));
    const NewtonReport report = body.solve(state);
    EXPECT_TRUE(report.converged) << report.trouble;
  }
  const Observation seen = body.observe(state);
  EXPECT_LT(seen.equilibrium_rel, 1e-6);
  return seen.force_n.z();
}

template <int dim>
Grading<dim> fine_at(double top_m, double size_m) {
  Grading<dim> grading;
  grading.growth = dim == 2 ? 0.5 : 0.9;
  grading.largest_m = 0.012;
  Eigen::Matrix<double, dim, 1> center_m = Eigen::Matrix<double, dim, 1>::Zero();
  center_m[dim - 1] = top_m;
  grading.discs.push_back({center_m, Eigen::Matrix<double, dim, 1>::Unit(dim - 1), 0.004, size_m});
  return grading;
}

/// In space with cells of `size_m` at the contact, over the meridian plane with fine cells.
double space_over_plane(const scene::Body& body, double size_m) {
  const double top_m = scene::body_shape(body)->bounds().upper_m.z();
  RoundSpec spec = round_spec(body);
  const double plane_n =
      pressed_n<2>(round_mesh<2>(spec, fine_at<2>(top_m, 0.0003)), top_m, body.material.poissons_ratio);
  spec.symmetric_x = spec.symmetric_y = true;
  return pressed_n<3>(round_mesh<3>(spec, fine_at<3>(top_m, size_m)), top_m, body.material.poissons_ratio) / plane_n;
}

scene::Body sphere() {
  scene::Body body;
  body.shape = scene::BodyShape::sphere;
  body.radius_m = 0.03;
  body.support_height_m = 0.005;
  body.material = {3e6, 0.5};
  return body;
}

scene::Body turned(const scene::Profile& profile) {
  scene::Body body;
  body.shape = scene::BodyShape::revolution;
  body.profile = profile;
  body.support_height_m = 0.005;
  body.material = {3e6, 0.4};
  return body;
}

TEST(Bodies, SphereInSpaceAgreesWithItsMeridianPlane) {
  EXPECT_NEAR(space_over_plane(sphere(), 0.002), 1.0, 0.02);
  EXPECT_NEAR(space_over_plane(sphere(), 0.001), 1.0, 0.005);
}

TEST(Bodies, TurnedBodiesInSpaceAgreeWithTheirMeridianPlane) {
  EXPECT_NEAR(space_over_plane(turned({{{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}, {0.0, 0.04}}, {}}), 0.0015), 1.0, 0.01);
  EXPECT_NEAR(space_over_plane(turned(scene::capsule_profile(0.02, 0.01)), 0.0015), 1.0, 0.01);
}

TEST(Bodies, EllipsoidWithEqualAxesIsTheSphere) {
  scene::Body ellipsoid = sphere();
  ellipsoid.shape = scene::BodyShape::ellipsoid;
  ellipsoid.semi_axes_m = scene::Vec3::Constant(0.03);
  const Mesh<3> a = round_mesh<3>(round_spec(sphere()), fine_at<3>(0.06, 0.004));
  const Mesh<3> b = round_mesh<3>(round_spec(ellipsoid), fine_at<3>(0.06, 0.004));
  ASSERT_EQ(a.node_count(), b.node_count());
  EXPECT_LT((a.points_m - b.points_m).cwiseAbs().maxCoeff(), 1e-15);
}

/// Force of a scene's tool at its last pose, on a mesh of the refinement sequence.
template <int dim>
double last_force_n(const scene::Scene& scene, ModelChoice choice, int level) {
  choice.dim = dim;
  ContactProblem<dim> body(level_mesh<dim>(scene, choice, level), scene.body.material, scene::Kinematics::finite,
                           choice.mirror_x, choice.mirror_y, 1);
  State<dim> state = body.rest();
  for (const double time_s : scene::instants_s(scene)) {
    body.set_tool({choice.tool, scene::pose_at(scene.track, time_s)});
    const NewtonReport report = body.solve(state);
    EXPECT_TRUE(report.converged) << report.trouble;
  }
  return body.observe(state).force_n.z();
}

/// An axisymmetric punch on an axisymmetric body with a ball inside, on the meshes that the solver uses.
TEST(Bodies, PunchedCylinderInSpaceAgreesWithItsMeridianPlane) {
  scene::Scene scene;
  scene.body = turned({{{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}, {0.0, 0.04}}, {}});
  scene::Inclusion& ball = scene.body.inclusions.emplace_back();
  ball.shape = scene::BodyShape::sphere;
  ball.radius_m = 0.01;
  ball.center_m = {0.0, 0.0, 0.02};
  ball.material = {3e5, 0.33};
  scene.tool.shape = scene::ToolShape::cylinder;
  scene.tool.radius_m = 0.01;
  scene.tool.length_m = 0.03;
  scene.tool.edge_radius_m = 0.005;
  scene.track = {{0.0, {{0.0, 0.0, 0.05475}, Eigen::Quaterniond::Identity()}},
                 {1.0, {{0.0, 0.0, 0.05400}, Eigen::Quaterniond::Identity()}}};
  scene.compare.instants = 4;
  const ModelChoice choice = choose_model(scene);
  ASSERT_EQ(choice.dim, 2);
  const double plane_n = last_force_n<2>(scene, choice, 2);
  EXPECT_GT(plane_n, 10.0);
  EXPECT_NEAR(last_force_n<3>(scene, choice, 0) / plane_n, 1.0, 0.02);
}

/// In small strain the gap is taken along the body's own normal, which must be outward on every face.
TEST(Bodies, SmallStrainOnASphereIsTheLimitOfFiniteStrain) {
  constexpr double depth_m = 2e-5, top_m = 0.06;
  const RoundSpec whole = round_spec(sphere());
  RoundSpec quarter = whole;
  quarter.symmetric_x = quarter.symmetric_y = true;
  const auto force_n = [&]<int dim>(const Mesh<dim>& mesh, scene::Kinematics kinematics) {
    ContactProblem<dim> body(mesh, {3e6, 0.5}, kinematics, true, true, 1);
    State<dim> state = body.rest();
    body.set_tool(ball_tool<dim>(ball_m, (top_m + ball_m - depth_m) * Eigen::Matrix<double, dim, 1>::Unit(dim - 1)));
    const NewtonReport report = body.solve(state);
    EXPECT_TRUE(report.converged) << report.trouble;
    return body.observe(state).force_n.z();
  };
  const Mesh<2> plane = round_mesh<2>(whole, fine_at<2>(top_m, 0.00005));
  const double small_n = force_n(plane, scene::Kinematics::small);
  EXPECT_NEAR(small_n / force_n(plane, scene::Kinematics::finite), 1.0, 0.01);
  const Mesh<3> space = round_mesh<3>(quarter, fine_at<3>(top_m, 0.0015));
  EXPECT_NEAR(force_n(space, scene::Kinematics::small) / force_n(space, scene::Kinematics::finite), 1.0, 0.02);
  // Hertz with the sum of the curvatures; the ball's other side deforms by a/R of that.
  const double R_m = 1.0 / (1.0 / ball_m + 1.0 / 0.03);
  EXPECT_NEAR(small_n / verification::hertz(verification::contact_modulus_pa(3e6, 0.5), R_m, depth_m).force_n, 1.0,
              0.02);
}

/// The same ellipsoid with its longer axis along x and along y: the mesh has no preferred direction.
TEST(Bodies, EllipsoidTurnedByARightAngle) {
  double force_n[2];
  for (const int axis : {0, 1}) {
    scene::Body body = sphere();
    body.shape = scene::BodyShape::ellipsoid;
    body.semi_axes_m = {0.030, 0.030, 0.025};
    body.semi_axes_m[axis] = 0.040;
    RoundSpec spec = round_spec(body);
    spec.symmetric_x = spec.symmetric_y = true;
    force_n[axis] = pressed_n<3>(round_mesh<3>(spec, fine_at<3>(0.05, 0.003)), 0.05, 0.5);
  }
  EXPECT_NEAR(force_n[0] / force_n[1], 1.0, 1e-6);
}

TEST(Bodies, QuarterAndWholeEllipsoidAgree) {
  scene::Body body = sphere();
  body.shape = scene::BodyShape::ellipsoid;
  body.semi_axes_m = {0.040, 0.030, 0.025};
  RoundSpec spec = round_spec(body);
  const double whole_n = pressed_n<3>(round_mesh<3>(spec, fine_at<3>(0.05, 0.006)), 0.05, 0.5, false, false);
  spec.symmetric_x = spec.symmetric_y = true;
  EXPECT_NEAR(pressed_n<3>(round_mesh<3>(spec, fine_at<3>(0.05, 0.006)), 0.05, 0.5) / whole_n, 1.0, 1e-7);
}

}  // namespace
}  // namespace touchstone::reference
