#include "reference/contact/contact_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace touchstone::reference {
namespace {

/// A block with small cells, and so hanging nodes, about the middle of its top.
Mesh<3> graded_block() {
  BlockSpec spec;
  spec.lower_m = {-0.02, -0.02, 0.0};
  spec.upper_m = {0.02, 0.02, 0.02};
  spec.grading.discs.push_back({{0.0, 0.0, 0.02}, {0.0, 0.0, 1.0}, 0.004, 0.002});
  spec.grading.largest_m = 0.01;
  return block_mesh(spec);
}

TEST(CellShares, AreEqual) {
  const Mesh<3> mesh = graded_block();
  for (const int ranks : {1, 2, 3, 4, 7, 50}) {
    std::vector<int> size(ranks, 0);
    for (const int rank : ranks_of_cells(mesh, ranks)) ++size.at(rank);
    const auto [smallest, largest] = std::minmax_element(size.begin(), size.end());
    // Cutting again and again rounds a few times.
    EXPECT_LE(*largest - *smallest, 2) << ranks;
  }
}

TEST(CellShares, KnowWhatDependsOnANodeThroughHangingOnes) {
  const Mesh<3> mesh = graded_block();
  const int master = mesh.hanging.front().masters.front().first;
  const std::vector<char> found = cells_of_nodes(mesh, {master});
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const auto& cell = mesh.cells[c];
    bool depends = std::find(cell.begin(), cell.end(), master) != cell.end();
    for (const auto& hanging : mesh.hanging) {
      const bool is_master = std::any_of(hanging.masters.begin(), hanging.masters.end(),
                                         [&](const auto& other) { return other.first == master; });
      depends = depends || (is_master && std::find(cell.begin(), cell.end(), hanging.node) != cell.end());
    }
    EXPECT_EQ(found[c] != 0, depends) << c;
  }
}

TEST(CellShares, HaveFewNodesInCommon) {
  const Mesh<3> mesh = graded_block();
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
  std::vector<int> by_number;
  for (int c = 0; c < mesh.cell_count(); ++c) by_number.push_back(c * ranks / mesh.cell_count());
  const int in_boxes = nodes_in_common(ranks_of_cells(mesh, ranks));
  EXPECT_GT(in_boxes, 0);
  EXPECT_LT(in_boxes, nodes_in_common(by_number));
}

}  // namespace
}  // namespace touchstone::reference
