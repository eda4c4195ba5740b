#include "reference/contact_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

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

std::vector<int> nodes_on_top(const Mesh<3>& mesh) {
  std::vector<int> nodes;
  for (int node = 0; node < mesh.node_count(); ++node) {
    if (mesh.points_m(2, node) > 0.02 - 1e-9) nodes.push_back(node);
  }
  return nodes;
}

TEST(CellShares, AreAllCellsOnceAndGiveTheFirstWhatIsIts) {
  const Mesh<3> mesh = graded_block();
  ASSERT_FALSE(mesh.hanging.empty());
  const std::vector<char> of_the_first = cells_of_nodes(mesh, nodes_on_top(mesh));
  const auto flagged = static_cast<std::size_t>(std::count(of_the_first.begin(), of_the_first.end(), 1));
  ASSERT_GT(flagged, 0u);
  ASSERT_LT(flagged, mesh.cells.size());
  for (const int ranks : {1, 2, 3, 4, 7, 50}) {
    std::vector<int> all;
    std::set<std::size_t> sizes_of_others;
    std::size_t size_of_first = 0;
    for (int rank = 0; rank < ranks; ++rank) {
      const std::vector<int> cells = cells_of_rank(mesh, of_the_first, rank, ranks);
      EXPECT_TRUE(std::is_sorted(cells.begin(), cells.end()));
      all.insert(all.end(), cells.begin(), cells.end());
      for (const int c : cells) EXPECT_TRUE(rank == 0 || !of_the_first[c]) << "cell " << c << " on rank " << rank;
      if (rank == 0) {
        size_of_first = cells.size();
      } else {
        sizes_of_others.insert(cells.size());
      }
    }
    std::sort(all.begin(), all.end());
    std::vector<int> expected(mesh.cells.size());
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(all, expected) << ranks;
    if (ranks == 1) continue;
    // Halving again and again rounds a few times.
    EXPECT_LE(*sizes_of_others.rbegin() - *sizes_of_others.begin(), 2u) << ranks;
    if (size_of_first > flagged) {
      EXPECT_NEAR(static_cast<double>(size_of_first), static_cast<double>(mesh.cells.size()) / ranks, 2.0) << ranks;
    }
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
  const auto nodes_in_common = [&](const auto& share_of) {
    std::vector<int> last(mesh.node_count(), -1), common(mesh.node_count(), 0);
    for (int rank = 0; rank < ranks; ++rank) {
      for (const int c : share_of(rank)) {
        for (const int node : mesh.cells[c]) {
          common[node] |= last[node] >= 0 && last[node] != rank;
          last[node] = rank;
        }
      }
    }
    return std::accumulate(common.begin(), common.end(), 0);
  };
  const std::vector<char> nobodys(mesh.cells.size(), 0);
  const int in_boxes = nodes_in_common([&](int rank) { return cells_of_rank(mesh, nobodys, rank, ranks); });
  const int by_number = nodes_in_common([&](int rank) {
    std::vector<int> cells;
    for (int c = mesh.cell_count() * rank / ranks; c < mesh.cell_count() * (rank + 1) / ranks; ++c) cells.push_back(c);
    return cells;
  });
  EXPECT_LT(in_boxes, by_number);
  EXPECT_LT(in_boxes, mesh.node_count() / 5);
}

}  // namespace
}  // namespace touchstone::reference
