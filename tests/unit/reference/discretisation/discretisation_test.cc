#include "reference/mesh/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchstone::reference {
namespace {

/// A block with small cells, and so hanging nodes, about the middle of its top.
Discretisation<3> graded_block() {
  BlockSpec spec;
  spec.lower_m = {-0.02, -0.02, 0.0};
  spec.upper_m = {0.02, 0.02, 0.02};
  spec.grading.discs.push_back({{0.0, 0.0, 0.02}, {0.0, 0.0, 1.0}, 0.004, 0.002});
  spec.grading.largest_m = 0.01;
  return block_mesh(spec);
}

TEST(Discretisation, PartsAreEqual) {
  const Discretisation<3> mesh = graded_block();
  for (const int ranks : {1, 2, 3, 4, 7, 50}) {
    std::vector<int> size(ranks, 0);
    for (const int rank : mesh.partition(ranks)) ++size.at(rank);
    const auto [smallest, largest] = std::minmax_element(size.begin(), size.end());
    EXPECT_LE(*largest - *smallest, 1) << ranks;
  }
}

TEST(Discretisation, KnowsTheCellsThatDependOnANodeThroughHangingOnes) {
  const Discretisation<3> mesh = graded_block();
  int hanging = 0;
  while (!mesh.hangs(hanging)) ++hanging;
  const int master = mesh.masters(hanging).front().first;
  const std::vector<char> found = mesh.cells_of({master});
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const auto& cell = mesh.cells[c];
    bool depends = std::find(cell.begin(), cell.end(), master) != cell.end();
    for (const int node : cell) {
      if (!mesh.hangs(node)) continue;
      const auto masters = mesh.masters(node);
      depends = depends ||
                std::any_of(masters.begin(), masters.end(), [&](const auto& other) { return other.first == master; });
    }
    EXPECT_EQ(found[c] != 0, depends) << c;
  }
}

TEST(Discretisation, PartsHaveFewNodesInCommon) {
  const Discretisation<3> mesh = graded_block();
  const int ranks = 4;
  const auto nodes_in_common = [&](const std::vector<int>& rank_of_cell) {
    std::vector<int> last(mesh.node_count(), -1), common(mesh.node_count(), 0);
    for (int c = 0; c < mesh.cell_count(); ++c) {
      for (const int node : mesh.cells[c]) {
        common[node] |= last[node] >= 0 && last[node] != rank_of_cell[c];
        last[node] = rank_of_cell[c];
      }
    }
    return std::accumulate(common.begin(), common.end(), 0);
  };
  std::vector<int> in_turn;
  for (int c = 0; c < mesh.cell_count(); ++c) in_turn.push_back(c % ranks);
  const int of_parts = nodes_in_common(mesh.partition(ranks));
  EXPECT_GT(of_parts, 0);
  EXPECT_LT(of_parts, 0.5 * nodes_in_common(in_turn));
}

TEST(Discretisation, ShapeFunctionsAreOneAtTheirNodeAndSumToOne) {
  for (int a = 0; a < 27; ++a) {
    const Shape<3> shape(0.5 * Eigen::Vector3d(a % 3, a / 3 % 3, a / 9));
    EXPECT_EQ(shape.value, (Eigen::Matrix<double, 27, 1>::Unit(a)));
  }
  const Shape<3> inside(Eigen::Vector3d(0.2, 0.7, 0.4));
  EXPECT_NEAR(inside.value.sum(), 1.0, 1e-14);
  EXPECT_LT(inside.gradient.colwise().sum().norm(), 1e-14);
}

TEST(Discretisation, GeometryIsThatOfTheBlock) {
  const Discretisation<3> mesh = graded_block();
  double volume_m3 = 0.0, top_m2 = 0.0;
  for (const auto& cell : mesh.cell_geometry()) {
    for (const double weight_m3 : cell.weight) volume_m3 += weight_m3;
  }
  EXPECT_NEAR(volume_m3, 0.04 * 0.04 * 0.02, 1e-16);
  const auto geometry = mesh.face_geometry();
  ASSERT_EQ(geometry.size(), mesh.faces.size());
  for (std::size_t f = 0; f < geometry.size(); ++f) {
    const Eigen::Vector3d middle_m = mesh.points_m.col(mesh.faces[f].nodes[4]);
    for (int a = 0; a < 9; ++a) {
      // Outward, away from a point inside the convex block.
      EXPECT_GT(geometry[f].normal.col(a).dot(middle_m - Eigen::Vector3d(0.0, 0.0, 0.01)), 0.0);
      EXPECT_NEAR(geometry[f].normal.col(a).norm(), 1.0, 1e-14);
      if (middle_m.z() == 0.02) top_m2 += geometry[f].weight[a];
    }
  }
  EXPECT_NEAR(top_m2, 0.04 * 0.04, 1e-16);
}

/// The weights that make a field conforming pass forces on so that their work stays the same.
TEST(Discretisation, CondensedForcesDoTheSameWork) {
  const Discretisation<3> mesh = graded_block();
  EXPECT_GT(mesh.hanging_count(), 0);
  Eigen::Matrix3Xd u_m(3, mesh.node_count()), force_n(3, mesh.node_count());
  for (int k = 0; k < u_m.size(); ++k) {
    u_m.data()[k] = std::sin(3.0 * k);
    force_n.data()[k] = std::cos(5.0 * k);
  }
  mesh.distribute(u_m);
  const double work_nm = u_m.cwiseProduct(force_n).sum();
  mesh.condense(force_n);
  EXPECT_NEAR(u_m.cwiseProduct(force_n).sum(), work_nm, 1e-10);
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (!mesh.hangs(node)) continue;
    EXPECT_TRUE(force_n.col(node).isZero(0.0));
    Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
    for (const auto& [master, weight] : mesh.masters(node)) sum_m += weight * u_m.col(master);
    EXPECT_LT((u_m.col(node) - sum_m).norm(), 1e-14);
  }
}

TEST(Discretisation, ComesBackFromBytes) {
  Discretisation<3> mesh =
      graded_block().moved([](const Eigen::Vector3d& x) -> Eigen::Vector3d { return x + 0.1 * x.z() * x; });
  mesh.faces[3].boundary = Boundary::plane_y;
  mesh.materials.resize(mesh.cells.size());
  mesh.materials[5][7] = 1;
  mesh.inclusion_materials = {{2e6, 0.3}};
  const Discretisation<3> back = Discretisation<3>::from_bytes(mesh.bytes());
  EXPECT_EQ(back.points_m, mesh.points_m);
  EXPECT_EQ(back.cells, mesh.cells);
  EXPECT_EQ(back.materials, mesh.materials);
  ASSERT_EQ(back.faces.size(), mesh.faces.size());
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    EXPECT_EQ(back.faces[f].nodes, mesh.faces[f].nodes);
    EXPECT_EQ(back.faces[f].boundary, mesh.faces[f].boundary);
  }
  EXPECT_EQ(back.inclusion_materials.at(0).youngs_modulus_pa, 2e6);
  const auto geometry = mesh.cell_geometry(), geometry_back = back.cell_geometry();
  for (std::size_t c = 0; c < geometry.size(); ++c) EXPECT_EQ(geometry_back[c].weight, geometry[c].weight);
}

}  // namespace
}  // namespace touchstone::reference
