// Inclusions against closed forms, and the limit without an inclusion.
#include "reference/mesh/inclusions.h"
#include "reference/contact/contact_problem.h"
#include "reference/mesh/round_mesh.h"
#include "reference/tool/tool_distance.h"
#include "reference/verification/closed_forms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::reference {
namespace {

constexpr double L_m = 0.02;

scene::Inclusion ball(double radius_m, double z_m, const scene::Material& material) {
  scene::Inclusion inclusion;
  inclusion.shape = scene::BodyShape::sphere;
  inclusion.radius_m = radius_m;
  inclusion.center_m.z() = z_m;
  inclusion.material = material;
  return inclusion;
}

/// Small-strain force over area of a bar with nu = 0 whose part above `from_m` is of another material, over the closed
/// form of springs in series. The mesh has faces at quarters of the length.
double bar_over_series(double from_m, double ratio) {
  const scene::Material soft{3e6, 0.0}, other{3e6 * ratio, 0.0};
  scene::Body body;
  scene::Inclusion top;
  top.shape = scene::BodyShape::box;
  top.size_m = {3.0 * L_m, 3.0 * L_m, 2.0 * (L_m - from_m)};
  top.center_m.z() = L_m;
  top.material = other;
  body.inclusions = {top};
  Discretisation<3> mesh =
      block_mesh({Eigen::Vector3d::Zero(), Eigen::Vector3d::Constant(L_m), true, true, {{}, 0.5, 0.25 * L_m}});
  embed_inclusions(body, mesh);
  for (auto& face : mesh.faces) {
    if (face.boundary == Boundary::held) face.boundary = Boundary::free;
  }
  ContactProblem<3> problem(mesh, soft, scene::Kinematics::small, true, true, 1);
  constexpr double strain = 0.01;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (mesh.points_m(2, node) == 0.0) problem.prescribe(node, 2, 0.0);
    if (mesh.points_m(2, node) == L_m) problem.prescribe(node, 2, strain * L_m);
  }
  State<3> state = problem.rest();
  const NewtonReport report = problem.solve(state);
  EXPECT_TRUE(report.converged) << report.trouble;
  const auto F = problem.internal_forces(state);
  double force_n = 0.0;
  for (int node = 0; node < mesh.node_count(); ++node) force_n += mesh.points_m(2, node) == L_m ? F(2, node) : 0.0;
  const double compliance_m = from_m / soft.youngs_modulus_pa + (L_m - from_m) / other.youngs_modulus_pa;
  return force_n / (L_m * L_m) / (strain * L_m / compliance_m);
}

TEST(Inclusions, LayersAreSpringsInSeries) {
  for (const double ratio : {1e-4, 1.0 / 89.0, 89.0, 1e4}) {
    EXPECT_NEAR(bar_over_series(0.25 * L_m, ratio), 1.0, 1e-9) << ratio;
  }
}

/// Outer stress of a ball with a concentric one inside, its surface moved out by `strain` of its radius, over the
/// closed form. @param cells to the inner radius
double concentric_over_exact(const scene::Material& outer, const scene::Material& inner, double cells) {
  constexpr double a_m = 0.01, b_m = 0.03, strain = 1e-3;
  scene::Body body;
  body.shape = scene::BodyShape::sphere;
  body.radius_m = b_m;
  body.support_height_m = 0.005;
  body.inclusions = {ball(a_m, b_m, inner)};
  Grading<2> grading;
  grading.growth = 0.4;
  grading.largest_m = 0.25 * b_m;
  refine_at_inclusions(body, cells, grading);
  Discretisation<2> mesh = round_mesh<2>(round_spec(body), grading);
  embed_inclusions(body, mesh);
  std::vector<char> outside(mesh.node_count(), 0);
  for (auto& face : mesh.faces) {
    if (face.boundary == Boundary::plane_x) continue;
    face.boundary = Boundary::free;
    for (const int node : face.nodes) outside[node] = mesh.hangs(node) ? 0 : 1;
  }
  ContactProblem<2> problem(mesh, outer, scene::Kinematics::small, false, false, 1);
  const Eigen::Matrix2Xd from_middle_m = mesh.points_m.colwise() - Eigen::Vector2d(0.0, b_m);
  for (int node = 0; node < mesh.node_count(); ++node) {
    for (int i = 0; i < 2 && outside[node]; ++i) problem.prescribe(node, i, strain * from_middle_m(i, node));
  }
  State<2> state = problem.rest();
  const NewtonReport report = problem.solve(state);
  EXPECT_TRUE(report.converged) << report.trouble;
  const auto F = problem.internal_forces(state);
  double work_nm = 0.0;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (outside[node]) work_nm += F.col(node).dot(from_middle_m.col(node));
  }
  return work_nm / (4.0 * M_PI * b_m * b_m * b_m) / verification::two_ball_stress_pa(outer, inner, a_m, b_m, strain);
}

TEST(Inclusions, BallInABallConverges) {
  const scene::Material rubber{3e6, 0.3};
  for (const scene::Material& inner :
       {scene::Material{3e6 / 89.0, 0.33}, {3e6 * 89.0, 0.2}, {3e10, 0.3}, {300.0, 0.3}}) {
    SCOPED_TRACE(inner.youngs_modulus_pa);
    const double coarse = std::abs(concentric_over_exact(rubber, inner, 4.0) - 1.0);
    const double fine = std::abs(concentric_over_exact(rubber, inner, 16.0) - 1.0);
    EXPECT_LT(coarse, 0.006);
    EXPECT_LT(fine, 0.0025);
  }
}

/// Error of the work that stretches a ball with a concentric one inside, its surface moved as in an infinite body, over
/// what the inner one adds to it.
/// @param cells  to the inner radius
template <int dim>
double stretched_error(const scene::Material& outer, const scene::Material& inner, double cells) {
  using Point = Eigen::Matrix<double, dim, 1>;
  constexpr double a_m = 0.01, b_m = 0.03, strain = 1e-3;
  scene::Body body;
  body.shape = scene::BodyShape::sphere;
  body.radius_m = b_m;
  body.support_height_m = 0.005;
  body.inclusions = {ball(a_m, b_m, inner)};
  RoundSpec spec = round_spec(body);
  spec.symmetric_x = spec.symmetric_y = dim == 3;
  Grading<dim> grading;
  grading.growth = dim == 2 ? 0.4 : 1.0;
  grading.largest_m = 0.4 * b_m;
  std::string why_not;
  const auto coarse = following_grid<dim>(round_cells<dim>(spec), body, why_not);
  EXPECT_TRUE(coarse) << why_not;
  if (!coarse) return NAN;
  refine_at_inclusions<dim>(*coarse, cells, 0, grading);
  Discretisation<dim> mesh = following_mesh<dim>(coarse, grading);
  embed_inclusions(body, mesh);
  std::vector<char> outside(mesh.node_count(), 0);
  for (auto& face : mesh.faces) {
    if (face.boundary == Boundary::plane_x || face.boundary == Boundary::plane_y) continue;
    face.boundary = Boundary::free;
    for (const int node : face.nodes) outside[node] = mesh.hangs(node) ? 0 : 1;
  }
  ContactProblem<dim> problem(mesh, outer, scene::Kinematics::small, dim == 3, dim == 3, 1);
  const verification::BallInStretch exact(outer, inner, a_m);
  Point stretch = Point::Constant(-0.5 * strain);
  stretch[dim - 1] = strain;
  const auto from_middle_m = [&](int node) -> Point { return mesh.points_m.col(node) - b_m * Point::Unit(dim - 1); };
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (!outside[node]) continue;
    const Point x_m = from_middle_m(node), Ex_m = stretch.cwiseProduct(x_m);
    const Point u_m = (1.0 + exact.f(x_m.norm())) * Ex_m + exact.g_per_m2(x_m.norm()) * x_m.dot(Ex_m) * x_m;
    for (int i = 0; i < dim; ++i) problem.prescribe(node, i, u_m[i]);
  }
  State<dim> state = problem.rest();
  const NewtonReport report = problem.solve(state);
  EXPECT_TRUE(report.converged) << report.trouble;
  const auto F = problem.internal_forces(state);
  double work_nm = 0.0;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (outside[node]) work_nm += F.col(node).dot(stretch.cwiseProduct(from_middle_m(node)));
  }
  const double whole_nm = (dim == 3 ? 4.0 : 1.0) * work_nm / (1.5 * strain * strain);
  const double without_nm = verification::BallInStretch(outer, outer, a_m).work_nm(b_m);
  return (whole_nm - exact.work_nm(b_m)) / (exact.work_nm(b_m) - without_nm);
}

TEST(Inclusions, CellsThatFollowABallStretchAsTheClosedForm) {
  const scene::Material rubber{3e6, 0.3};
  for (const scene::Material& inner :
       {scene::Material{3e10, 0.3}, {3e6 * 89.0, 0.2}, {3e6 / 89.0, 0.33}, {300.0, 0.3}}) {
    SCOPED_TRACE(inner.youngs_modulus_pa);
    EXPECT_LT(std::abs(stretched_error<2>(rubber, inner, 1.0)), 0.005);
    EXPECT_LT(std::abs(stretched_error<2>(rubber, inner, 4.0)), 0.0001);
    EXPECT_LT(std::abs(stretched_error<3>(rubber, inner, 1.0)), 0.005);
  }
}

TEST(Inclusions, OfTheBodysOwnMaterialChangesNothing) {
  for (const double nu : {0.3, 0.5}) {
    scene::Body body;
    body.shape = scene::BodyShape::sphere;
    body.radius_m = 0.03;
    body.support_height_m = 0.005;
    body.material = {3e6, nu};
    body.inclusions = {ball(0.008, 0.045, body.material)};
    Grading<2> grading;
    grading.largest_m = 0.004;
    Discretisation<2> mesh = round_mesh<2>(round_spec(body), grading);
    double force_n[2];
    for (const int k : {0, 1}) {
      if (k == 1) embed_inclusions(body, mesh);
      ContactProblem<2> problem(mesh, body.material, scene::Kinematics::finite, false, false, 1);
      problem.set_tool(ball_tool<2>(0.01, {0.0, 0.068}));
      State<2> state = problem.rest();
      EXPECT_TRUE(problem.solve(state).converged);
      force_n[k] = problem.observe(state).force_n.z();
    }
    EXPECT_GT(force_n[0], 1.0);
    EXPECT_NEAR(force_n[1] / force_n[0], 1.0, 1e-10);
  }
}

/// Force on a ball of 10 mm pressed into a rubber ball with another ball inside, in steps of half a millimetre.
double pressed_n(const scene::Material& inner, int steps) {
  scene::Body body;
  body.shape = scene::BodyShape::sphere;
  body.radius_m = 0.03;
  body.support_height_m = 0.005;
  body.material = {3e6, 0.5};
  body.inclusions = {ball(0.008, 0.040, inner)};
  Grading<2> grading;
  grading.largest_m = 0.004;
  grading.discs.push_back({{0.0, 0.06}, {0.0, 1.0}, 0.006, 0.0015});
  refine_at_inclusions(body, 4.0, grading);
  Discretisation<2> mesh = round_mesh<2>(round_spec(body), grading);
  embed_inclusions(body, mesh);
  ContactProblem<2> problem(mesh, body.material, scene::Kinematics::finite, false, false, 1);
  State<2> state = problem.rest();
  for (int step = 1; step <= steps; ++step) {
    problem.set_tool(ball_tool<2>(0.01, {0.0, 0.07 - 0.0005 * step}));
    const NewtonReport report = problem.solve(state);
    EXPECT_TRUE(report.converged) << inner.youngs_modulus_pa << " Pa, step " << step << ": " << report.trouble;
    if (!report.converged) return 0.0;
  }
  return problem.observe(state).force_n.z();
}

TEST(Inclusions, EveryRatioOfStiffnessRunsAndOrdersTheForce) {
  double before_n = 1.0;
  for (const scene::Material& inner :
       {scene::Material{300.0, 0.33}, {33.77e3, 0.33}, {3e6, 0.5}, {3e6 * 89.0, 0.33}, {3e10, 0.3}}) {
    const double force_n = pressed_n(inner, 8);
    EXPECT_GT(force_n, before_n) << inner.youngs_modulus_pa;
    before_n = force_n;
  }
  // A soft material that keeps its volume deforms less than a compressible one.
  EXPECT_GT(pressed_n({300.0, 0.5}, 4), pressed_n({300.0, 0.33}, 4));
}

}  // namespace
}  // namespace touchstone::reference
