#include "reference/contact/prolongation.h"

#include "reference/fe/element.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace touchstone::reference {
namespace {

template <int dim>
using Point = Eigen::Matrix<double, dim, 1>;
template <int dim>
using Nodal = Eigen::Matrix<double, dim, Mesh<dim>::nodes_per_cell>;

template <int dim>
Nodal<dim> nodes_of(const Mesh<dim>& mesh, int cell) {
  Nodal<dim> X_m;
  for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) X_m.col(a) = mesh.points_m.col(mesh.cells[cell][a]);
  return X_m;
}

/// Origin and unit of the pressure's slopes in a cell, see Element::evaluate.
template <int dim>
struct PressureFrame {
  Point<dim> center_m;
  double scale_m;
  explicit PressureFrame(const Nodal<dim>& X_m) {
    const Point<dim> low_m = X_m.rowwise().minCoeff(), high_m = X_m.rowwise().maxCoeff();
    center_m = 0.5 * (low_m + high_m);
    scale_m = (high_m - low_m).maxCoeff();
  }
};

/// Nearest place in a cell to a point, in unit coordinates, by Newton kept inside.
template <int dim>
Point<dim> nearest_in_cell(const Nodal<dim>& X_m, const Point<dim>& point_m) {
  Point<dim> xi = Point<dim>::Constant(0.5);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Q2<dim> shape(xi);
    const Eigen::Matrix<double, dim, dim> slope = X_m * shape.gradient;
    const Point<dim> next = (xi + slope.inverse() * (point_m - X_m * shape.value)).cwiseMax(0.0).cwiseMin(1.0);
    const double moved = (next - xi).norm();
    xi = next;
    if (moved < 1e-12) break;
  }
  return xi;
}

/// Finds the cells near a point: a lattice of boxes, each with the cells that reach into it.
template <int dim>
class CellFinder {
 public:
  explicit CellFinder(const Mesh<dim>& mesh) : mesh_(mesh) {
    low_m_ = mesh.points_m.rowwise().minCoeff();
    const Point<dim> size_m = Point<dim>(mesh.points_m.rowwise().maxCoeff()) - low_m_;
    box_m_ = std::pow(size_m.prod() / mesh.cell_count(), 1.0 / dim);
    int boxes = 1;
    for (int d = 0; d < dim; ++d) boxes *= count_[d] = static_cast<int>(std::ceil(size_m[d] / box_m_)) + 1;
    cells_.resize(static_cast<std::size_t>(boxes));
    for (int cell = 0; cell < mesh.cell_count(); ++cell) {
      const Nodal<dim> X_m = nodes_of(mesh, cell);
      Bounds bounds{X_m.rowwise().minCoeff(), X_m.rowwise().maxCoeff()};
      // Two meshes of one curved surface differ by less than that.
      const double margin_m = 0.05 * (bounds.high_m - bounds.low_m).maxCoeff();
      bounds.low_m.array() -= margin_m;
      bounds.high_m.array() += margin_m;
      const std::array<int, dim> first = box_of(bounds.low_m), last = box_of(bounds.high_m);
      for (std::array<int, dim> box = first;;) {
        cells_[index(box)].push_back(cell);
        int d = 0;
        while (d < dim && box[d] == last[d]) {
          box[d] = first[d];
          ++d;
        }
        if (d == dim) break;
        ++box[d];
      }
      bounds_.push_back(bounds);
    }
  }

  /// The cell nearest to the point, and where in it.
  [[nodiscard]] std::pair<int, Point<dim>> find(const Point<dim>& point_m) const {
    std::pair<int, Point<dim>> best{0, Point<dim>::Constant(0.5)};
    double nearest_m = std::numeric_limits<double>::infinity();
    const auto look_at = [&](int cell) {
      const Nodal<dim> X_m = nodes_of(mesh_, cell);
      const Point<dim> xi = nearest_in_cell<dim>(X_m, point_m);
      const double distance_m = (X_m * Q2<dim>(xi).value - point_m).norm();
      if (distance_m >= nearest_m) return;
      nearest_m = distance_m;
      best = {cell, xi};
    };
    const double here_m = 1e-9 * box_m_;
    for (const int cell : cells_[index(box_of(point_m))]) {
      if (nearest_m < here_m) break;
      const Bounds& bounds = bounds_[cell];
      if ((point_m.array() >= bounds.low_m.array()).all() && (point_m.array() <= bounds.high_m.array()).all()) {
        look_at(cell);
      }
    }
    for (int cell = 0; std::isinf(nearest_m) && cell < mesh_.cell_count(); ++cell) look_at(cell);
    return best;
  }

 private:
  struct Bounds {
    Point<dim> low_m, high_m;
  };
  [[nodiscard]] std::array<int, dim> box_of(const Point<dim>& point_m) const {
    std::array<int, dim> box;
    for (int d = 0; d < dim; ++d) {
      box[d] = std::clamp(static_cast<int>((point_m[d] - low_m_[d]) / box_m_), 0, count_[d] - 1);
    }
    return box;
  }
  [[nodiscard]] std::size_t index(const std::array<int, dim>& box) const {
    int index = 0;
    for (int d = dim - 1; d >= 0; --d) index = index * count_[d] + box[d];
    return static_cast<std::size_t>(index);
  }

  const Mesh<dim>& mesh_;
  Point<dim> low_m_;
  double box_m_ = 0.0;
  std::array<int, dim> count_{};
  std::vector<std::vector<int>> cells_;
  std::vector<Bounds> bounds_;
};

}  // namespace

template <int dim>
Prolongation<dim>::Prolongation(const Mesh<dim>& from, const Mesh<dim>& to) : from_(from), to_(to) {
  const CellFinder<dim> finder(from);
  const auto place = [&](const Point<dim>& point_m) {
    const auto [cell, xi] = finder.find(point_m);
    return Place{cell, xi};
  };
  for (const auto& point_m : to.points_m.colwise()) nodes_.push_back(place(point_m));
  for (int cell = 0; cell < to.cell_count(); ++cell) {
    middles_.push_back(place(PressureFrame<dim>(nodes_of(to, cell)).center_m));
  }
}

template <int dim>
State<dim> Prolongation<dim>::operator()(const State<dim>& state) const {
  constexpr double most = 0.5;
  State<dim> out;
  out.u_m.setZero(dim, to_.node_count());
  out.p_pa.resize(dim + 1, to_.cell_count());
  out.touching.assign(static_cast<std::size_t>(to_.node_count()), 0);
  std::vector<char> may_touch(out.touching.size(), 0);
  for (const auto& face : to_.faces) {
    if (face.boundary != Boundary::free) continue;
    for (const int node : face.nodes) may_touch[node] = 1;
  }
  for (const auto& hanging : to_.hanging) may_touch[hanging.node] = 0;
  for (int node = 0; node < to_.node_count(); ++node) {
    const Q2<dim> shape(nodes_[node].xi);
    double touching = 0.0;
    for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
      const int master = from_.cells[nodes_[node].cell][a];
      out.u_m.col(node) += shape.value[a] * state.u_m.col(master);
      if (state.touching[master]) touching += shape.value[a];
    }
    out.touching[node] = may_touch[node] && touching > most ? 1 : 0;
  }
  for (int cell = 0; cell < to_.cell_count(); ++cell) {
    const int parent = middles_[cell].cell;
    const PressureFrame<dim> frame(nodes_of(to_, cell)), parent_frame(nodes_of(from_, parent));
    const auto p_pa = state.p_pa.col(parent);
    const Point<dim> slope_pa = p_pa.template tail<dim>();
    out.p_pa(0, cell) = p_pa[0] + slope_pa.dot(frame.center_m - parent_frame.center_m) / parent_frame.scale_m;
    out.p_pa.col(cell).template tail<dim>() = slope_pa * (frame.scale_m / parent_frame.scale_m);
  }
  // Hanging nodes follow their masters on the new mesh.
  for (const auto& hanging : to_.hanging) {
    out.u_m.col(hanging.node).setZero();
    for (const auto& [master, weight] : hanging.masters) out.u_m.col(hanging.node) += weight * out.u_m.col(master);
  }
  return out;
}

template class Prolongation<2>;
template class Prolongation<3>;

}  // namespace touchstone::reference
