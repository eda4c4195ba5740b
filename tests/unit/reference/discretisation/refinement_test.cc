// Where cells are divided: the estimate against its closed form, the choice of cells, and the divided mesh.
#include "reference/discretisation/refinement.h"

#include "reference/mesh/mesh.h"
#include "reference/mesh/round_mesh.h"
#include "scene/shape/revolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

/// Cells of 10 mm, none divided.
Discretisation<3> even_block() {
  BlockSpec spec;
  spec.lower_m = {0.0, 0.0, 0.0};
  spec.upper_m = {0.02, 0.02, 0.02};
  spec.grading.largest_m = 0.01;
  return block_mesh(spec);
}

template <int dim, class Function>
typename Discretisation<dim>::Nodal nodal(const Discretisation<dim>& mesh, const Function& at) {
  typename Discretisation<dim>::Nodal values(dim, mesh.node_count());
  for (int node = 0; node < mesh.node_count(); ++node) values.col(node) = at(mesh.points_m.col(node));
  return values;
}

/// Of a kink at x = 10 mm: the jump c over a face of area A and both cells' diagonal d give d / 24 c^2 A.
TEST(SquaredErrorEstimate, OfAKinkIsItsClosedForm) {
  const Discretisation<3> mesh = even_block();
  constexpr double slope = 0.03, face_m2 = 1e-4;
  const auto kink =
      nodal(mesh, [](const auto& x_m) { return Eigen::Vector3d(0.0, slope * std::max(0.0, x_m.x() - 0.01), 0.0); });
  const Eigen::VectorXd squared = squared_error_estimate<3>(mesh, kink);
  const double expected = 0.01 * std::sqrt(3.0) / 24.0 * slope * slope * face_m2;
  ASSERT_EQ(squared.size(), 8);
  for (const double one : squared) EXPECT_NEAR(one, expected, 1e-5 * expected);
}

TEST(SquaredErrorEstimate, OfAQuadraticFieldIsRoundOff) {
  const Discretisation<3> mesh = even_block().refined({1, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_GT(mesh.hanging_count(), 0);
  const auto smooth =
      nodal(mesh, [](const auto& x_m) { return Eigen::Vector3d(x_m.x() * x_m.y(), x_m.z() * x_m.z(), 0.0); });
  EXPECT_LT(squared_error_estimate<3>(mesh, smooth).maxCoeff(), 1e-20 * 1e-4 * 0.01 * 0.02 * 0.02);
}

/// The same kink in the meridian plane counts for more where it has more around the axis.
TEST(SquaredErrorEstimate, GrowsWithTheDistanceFromTheAxis) {
  CylinderSpec spec;
  spec.radius_m = 0.04;
  spec.height_m = 0.02;
  spec.grading.largest_m = 0.01;
  const Discretisation<2> mesh = cylinder_mesh(spec);
  const auto kink = nodal(mesh, [](const auto& x_m) { return Eigen::Vector2d(0.0, std::max(0.0, x_m.y() - 0.01)); });
  const Eigen::VectorXd squared = squared_error_estimate<2>(mesh, kink);
  for (int cell = 0; cell < mesh.cell_count(); ++cell) {
    const double r_m = mesh.pressure_frame(cell).first.x();
    EXPECT_NEAR(squared[cell] / r_m, squared[0] / mesh.pressure_frame(0).first.x(), 1e-5 * squared[0] / r_m) << r_m;
  }
}

TEST(WorstCells, AreAShareOfAllAndTheFirstOfEqualOnes) {
  const Eigen::VectorXd squared = (Eigen::VectorXd(5) << 1.0, 4.0, 0.0, 3.0, 3.0).finished();
  EXPECT_EQ(worst_cells(squared, 0.2), (std::vector<char>{0, 1, 0, 0, 0}));
  EXPECT_EQ(worst_cells(squared, 0.21), (std::vector<char>{0, 1, 0, 1, 0}));
  EXPECT_EQ(worst_cells(squared, 0.6), (std::vector<char>{0, 1, 0, 1, 1}));
  EXPECT_EQ(worst_cells(squared, 1.0), (std::vector<char>{1, 1, 1, 1, 1}));
}

/// New nodes of the surface lie on the body, not on its old cells' sides, and no cell is more than one division from
/// its neighbours.
TEST(Refined, FollowsTheBodysSurface) {
  RoundSpec spec;
  constexpr double radius_m = 0.03;
  spec.profile = scene::capsule_profile(radius_m, 0.0);
  spec.support_height_m = 0.006;
  Grading<2> grading;
  grading.largest_m = 0.01;
  const Discretisation<2> coarse = round_mesh(spec, grading);
  std::vector<char> divided(static_cast<std::size_t>(coarse.cell_count()), 0);
  for (int cell = 0; cell < coarse.cell_count(); cell += 2) divided[cell] = 1;
  const Discretisation<2> once = coarse.refined(divided);
  EXPECT_GE(once.cell_count(), coarse.cell_count() + 3 * std::count(divided.begin(), divided.end(), 1));
  std::vector<char> all(static_cast<std::size_t>(once.cell_count()), 1);
  const Discretisation<2> twice = once.refined(all);
  const auto off_m = [&](const Discretisation<2>& mesh) {
    double largest_m = 0.0;
    for (const auto& face : mesh.faces) {
      if (face.boundary == Boundary::plane_x) continue;
      for (const int node : face.nodes) {
        const Eigen::Vector2d from_m = mesh.points_m.col(node) - Eigen::Vector2d(0.0, radius_m);
        largest_m = std::max(largest_m, std::abs(from_m.norm() - radius_m));
      }
    }
    return largest_m;
  };
  EXPECT_LT(off_m(twice), 1e-12);
  EXPECT_THROW((void)once.refined(divided), std::invalid_argument);
}

}  // namespace
}  // namespace touchstone::reference
