#include "reference/contact/contact_shares.h"

#include <algorithm>
#include <functional>
#include <numeric>

namespace touchstone::reference {

template <int dim>
std::vector<char> cells_of_nodes(const Mesh<dim>& mesh, const std::vector<int>& nodes) {
  std::vector<char> is_one(mesh.node_count(), 0);
  for (const int node : nodes) is_one[node] = 1;
  for (const auto& hanging : mesh.hanging) {
    for (const auto& [master, weight] : hanging.masters) is_one[hanging.node] |= is_one[master];
  }
  std::vector<char> result;
  for (const auto& cell : mesh.cells) {
    result.push_back(std::any_of(cell.begin(), cell.end(), [&](int node) { return is_one[node] != 0; }) ? 1 : 0);
  }
  return result;
}

template <int dim>
std::vector<int> ranks_of_cells(const Mesh<dim>& mesh, int ranks) {
  std::vector<typename Mesh<dim>::Point> middle_m;
  for (const auto& cell : mesh.cells) middle_m.push_back(mesh.points_m.col(cell[Mesh<dim>::nodes_per_cell / 2]));
  std::vector<int> cells(mesh.cells.size()), result(mesh.cells.size(), 0);
  std::iota(cells.begin(), cells.end(), 0);
  using Iterator = std::vector<int>::iterator;
  const std::function<void(Iterator, Iterator, int, int)> cut = [&](Iterator begin, Iterator end, int rank, int count) {
    if (begin == end) return;
    if (count == 1) {
      for (Iterator cell = begin; cell != end; ++cell) result[*cell] = rank;
      return;
    }
    typename Mesh<dim>::Point low = middle_m[*begin], high = low;
    for (Iterator cell = begin; cell != end; ++cell) {
      low = low.cwiseMin(middle_m[*cell]);
      high = high.cwiseMax(middle_m[*cell]);
    }
    int side = 0;
    (high - low).maxCoeff(&side);
    const int below = count / 2;
    const Iterator middle = begin + (end - begin) * below / count;
    std::nth_element(begin, middle, end, [&](int a, int b) {
      return middle_m[a][side] != middle_m[b][side] ? middle_m[a][side] < middle_m[b][side] : a < b;
    });
    cut(begin, middle, rank, below);
    cut(middle, end, rank + below, count - below);
  };
  cut(cells.begin(), cells.end(), 0, ranks);
  return result;
}

template std::vector<char> cells_of_nodes<2>(const Mesh<2>&, const std::vector<int>&);
template std::vector<int> ranks_of_cells<2>(const Mesh<2>&, int);
template std::vector<char> cells_of_nodes<3>(const Mesh<3>&, const std::vector<int>&);
template std::vector<int> ranks_of_cells<3>(const Mesh<3>&, int);

}  // namespace touchstone::reference
