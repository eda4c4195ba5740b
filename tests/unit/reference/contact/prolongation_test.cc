#include "reference/contact/prolongation.h"

#include "reference/mesh/round_mesh.h"
#include "reference/run/model_choice.h"

#include <gtest/gtest.h>

#include <vector>

namespace touchstone::reference {
namespace {

Discretisation<3> block(double size_m) {
  return block_mesh({{0.0, 0.0, 0.0},
                     {0.03, 0.03, 0.03},
                     true,
                     true,
                     {{{{0.0, 0.0, 0.03}, {0.0, 0.0, 1.0}, 0.005, size_m}}, 0.5, 0.015}});
}

Discretisation<2> ball(double size_m) {
  return round_mesh<2>({scene::capsule_profile(0.03, 0.0), Eigen::Vector2d::Ones(), 0.006, false, false},
                       {{{{0.0, 0.06}, {0.0, 1.0}, 0.005, size_m}}, 0.5, 0.015});
}

/// Displacement quadratic in the place, pressure linear in it.
template <int dim>
State<dim> smooth(const Discretisation<dim>& mesh, double bend_per_m) {
  using Point = Eigen::Matrix<double, dim, 1>;
  State<dim> state;
  state.u_m.resize(dim, mesh.node_count());
  for (int n = 0; n < mesh.node_count(); ++n) {
    const Point X = mesh.points_m.col(n);
    state.u_m.col(n) = 0.1 * X + Point::Constant(bend_per_m * X[0] * X[dim - 1]);
  }
  state.p_pa.resize(dim + 1, mesh.cell_count());
  for (int c = 0; c < mesh.cell_count(); ++c) {
    Point low = mesh.points_m.col(mesh.cells[c][0]), high = low;
    for (const int node : mesh.cells[c]) {
      low = low.cwiseMin(Point(mesh.points_m.col(node)));
      high = high.cwiseMax(Point(mesh.points_m.col(node)));
    }
    const Point slope = Point::Constant(2e6) + 1e6 * Point::Unit(0);  // Pa/m
    state.p_pa(0, c) = 5e3 + slope.dot(0.5 * (low + high));
    state.p_pa.col(c).template tail<dim>() = slope * (high - low).maxCoeff();
  }
  state.touching.assign(mesh.node_count(), 0);
  return state;
}

TEST(Prolongation, KeepsWhatBothMeshesCanHold) {
  const Discretisation<3> coarse = block(0.006), fine = block(0.0025);
  ASSERT_GT(fine.cell_count(), coarse.cell_count());
  ASSERT_GT(fine.hanging_count(), 0);
  const State<3> carried = Prolongation<3>(coarse, fine)(smooth(coarse, 3.0)), wanted = smooth(fine, 3.0);
  EXPECT_LT((carried.u_m - wanted.u_m).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((carried.p_pa - wanted.p_pa).cwiseAbs().maxCoeff(), 1e-8);
}

/// Curved cells hold linear displacements exactly, and two meshes of one ball differ by little.
TEST(Prolongation, FollowsCurvedCells) {
  const Discretisation<2> coarse = ball(0.004), fine = ball(0.0015);
  const State<2> carried = Prolongation<2>(coarse, fine)(smooth(coarse, 0.0)), wanted = smooth(fine, 0.0);
  // The quadratic arc of a coarse cell leaves the circle by some micrometres.
  EXPECT_LT((carried.u_m - wanted.u_m).cwiseAbs().maxCoeff(), 0.1 * 2e-5);
  EXPECT_LT((carried.p_pa - wanted.p_pa).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Prolongation, MarksTheSurfaceThatTouched) {
  const Discretisation<2> coarse = ball(0.004), fine = ball(0.0015);
  const double edge_m = 0.006;
  State<2> state = smooth(coarse, 0.0);
  for (int n = 0; n < coarse.node_count(); ++n) {
    const bool top = coarse.points_m(1, n) > 0.03 && std::abs(coarse.points_m.col(n).norm()) > 0.0;
    const double from_center_m = std::hypot(coarse.points_m(0, n), coarse.points_m(1, n) - 0.03);
    state.touching[n] = top && from_center_m > 0.03 - 1e-5 && coarse.points_m(0, n) < edge_m ? 1 : 0;
  }
  const State<2> carried = Prolongation<2>(coarse, fine)(state);
  int touching = 0;
  for (int n = 0; n < fine.node_count(); ++n) {
    if (!carried.touching[n]) continue;
    ++touching;
    EXPECT_GT(std::hypot(fine.points_m(0, n), fine.points_m(1, n) - 0.03), 0.03 - 1e-4);
    EXPECT_LT(fine.points_m(0, n), edge_m + 0.004);
  }
  EXPECT_GE(touching, 7);
}

/// No node that hangs is active by itself, and none of the finer mesh may start apart for that.
TEST(Prolongation, HangingNodesOfTheCoarserMeshLeaveNoHoles) {
  const Discretisation<3> coarse = block(0.0025);
  const Discretisation<3> fine = coarse.refined(std::vector<char>(static_cast<std::size_t>(coarse.cell_count()), 1));
  const auto on_top = [](const Discretisation<3>& mesh, int n) { return mesh.points_m(2, n) > 0.03 - 1e-9; };
  State<3> state = smooth(coarse, 0.0);
  int hanging = 0;
  for (int n = 0; n < coarse.node_count(); ++n) {
    if (!on_top(coarse, n)) continue;
    state.touching[n] = coarse.hangs(n) ? 0 : 1;
    hanging += coarse.hangs(n) ? 1 : 0;
  }
  ASSERT_GT(hanging, 0);
  const State<3> carried = Prolongation<3>(coarse, fine)(state);
  for (int n = 0; n < fine.node_count(); ++n) {
    if (!on_top(fine, n)) continue;
    EXPECT_EQ(carried.touching[n] != 0, !fine.hangs(n)) << fine.points_m.col(n).transpose();
  }
}

}  // namespace
}  // namespace touchstone::reference
