#include "reference/discretisation/discretisation.h"

#include "reference/discretisation/coarse_cell.h"
#include "reference/linear/record.h"

#include <deal.II/base/multithread_info.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_tools.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q_cache.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/vector.h>

#include <boost/archive/binary_iarchive.hpp>
#include <boost/archive/binary_oarchive.hpp>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <tuple>

namespace touchstone::reference {
namespace {

template <int dim>
Eigen::Matrix<double, dim, 1> to_eigen(const dealii::Tensor<1, dim>& p) {
  Eigen::Matrix<double, dim, 1> x;
  for (int d = 0; d < dim; ++d) x[d] = p[d];
  return x;
}

template <class Nodal>
dealii::Vector<double> to_vector(const Nodal& values) {
  return dealii::Vector<double>(values.data(), values.data() + values.size());
}

/// deal.II's own loops here are too short for more threads, and its thread pool does not look at OMP_NUM_THREADS.
void use_one_thread() {
  static const bool once = (dealii::MultithreadInfo::set_thread_limit(1), true);
  (void)once;
}

}  // namespace

template <int dim>
struct Discretisation<dim>::Parts {
  explicit Parts(std::shared_ptr<dealii::Triangulation<dim>> grid_in)
      : grid(std::move(grid_in)), element(scalar, dim), dofs(*grid), mapping(2) {
    dofs.distribute_dofs(element);
    dealii::DoFTools::make_hanging_node_constraints(dofs, hanging);
    hanging.close();
  }
  /// Per shape function of a cell's scalar element its node's place in lexicographic order.
  const std::vector<unsigned int> to_lexicographic = dealii::FETools::hierarchic_to_lexicographic_numbering<dim>(2);
  std::shared_ptr<dealii::Triangulation<dim>> grid;
  dealii::FE_Q<dim> scalar{2};
  dealii::FESystem<dim> element;
  dealii::DoFHandler<dim> dofs;
  dealii::AffineConstraints<double> hanging;
  dealii::MappingQCache<dim> mapping;
};

template <int dim>
Discretisation<dim>::Discretisation(std::shared_ptr<dealii::Triangulation<dim>> grid, const Map& place_m)
    : place_m_(place_m) {
  use_one_thread();
  parts_ = std::make_shared<Parts>(std::move(grid));
  const dealii::MappingQ<dim> flat(1);
  number([&](const auto& cell, const dealii::Point<dim>& unit) {
    return place_m(to_eigen<dim>(flat.transform_unit_to_real_cell(cell, unit)));
  });
}

template <int dim>
Discretisation<dim>::Discretisation(std::shared_ptr<dealii::Triangulation<dim>> grid, const CellMap& place_m)
    : place_in_cell_m_(place_m) {
  use_one_thread();
  parts_ = std::make_shared<Parts>(std::move(grid));
  number([&](const auto& cell, const dealii::Point<dim>& unit) {
    const auto [corners, xi] = in_coarse_cell<dim>(cell, unit);
    return place_m(corners, xi);
  });
  for (const auto& cell : parts_->grid->active_cell_iterators()) {
    materials.emplace_back().fill(static_cast<std::uint8_t>(cell->material_id()));
  }
}

/// @param place_m  of a point of a cell, in its unit coordinates
template <int dim>
template <class Place>
void Discretisation<dim>::number(const Place& place_m) {
  const auto& places = parts_->scalar.get_unit_support_points();
  Nodal points(dim, parts_->dofs.n_dofs() / dim);
  std::vector<dealii::types::global_dof_index> dofs(parts_->element.n_dofs_per_cell());
  for (const auto& cell : parts_->dofs.active_cell_iterators()) {
    cell->get_dof_indices(dofs);
    std::array<int, nodes_per_cell> nodes;
    for (int a = 0; a < nodes_per_cell; ++a) {
      const int node = static_cast<int>(dofs[parts_->element.component_to_system_index(0, a)]) / dim;
      for (int i = 0; i < dim; ++i) {
        if (static_cast<int>(dofs[parts_->element.component_to_system_index(i, a)]) != dim * node + i) {
          throw std::logic_error("deal.II numbers the components of a node otherwise");
        }
      }
      nodes[parts_->to_lexicographic[a]] = node;
      points.col(node) = place_m(cell, places[a]);
    }
    cells.push_back(nodes);
    for (const unsigned int f : cell->face_indices()) {
      if (!cell->face(f)->at_boundary()) continue;
      Face face{{}, static_cast<Boundary>(cell->face(f)->boundary_id())};
      const int axis = static_cast<int>(f) / 2, layer = f % 2 == 0 ? 0 : 2;
      int next = 0;
      for (int a = 0; a < nodes_per_cell; ++a) {
        const int place[3] = {a % 3, a / 3 % 3, a / 9};
        if (place[axis] == layer) face.nodes[next++] = nodes[a];
      }
      faces.push_back(face);
    }
  }
  place(std::move(points));
}

template <int dim>
void Discretisation<dim>::place(Nodal places_m) {
  points_m = std::move(places_m);
  distribute(points_m);
  const dealii::MappingQ<dim> flat(1);
  parts_->mapping.initialize(*parts_->grid, [&](const auto& cell) {
    std::vector<dealii::Point<dim>> places;
    for (int a = 0; a < nodes_per_cell; ++a) {
      if (cell->is_active()) {
        const auto at_m = points_m.col(cells[cell->active_cell_index()][parts_->to_lexicographic[a]]);
        dealii::Point<dim>& place = places.emplace_back();
        for (int d = 0; d < dim; ++d) place[d] = at_m[d];
      } else {
        places.push_back(flat.transform_unit_to_real_cell(cell, parts_->scalar.unit_support_point(a)));
      }
    }
    return places;
  });
}

template <int dim>
Discretisation<dim> Discretisation<dim>::moved(const Map& place_m) const {
  Discretisation result = *this;
  result.parts_ = std::make_shared<Parts>(parts_->grid);
  Nodal places_m = points_m;
  for (auto at_m : places_m.colwise()) at_m = place_m(at_m);
  result.place(std::move(places_m));
  return result;
}

template <int dim>
std::string Discretisation<dim>::bytes() const {
  std::ostringstream grid;
  boost::archive::binary_oarchive archive(grid);
  parts_->grid->save(archive, 0);
  RecordWriter record;
  record.sized(grid.str(), faces, materials, inclusion_materials);
  record(points_m);
  return record.bytes();
}

template <int dim>
Discretisation<dim> Discretisation<dim>::from_bytes(std::string_view bytes) {
  RecordReader record(bytes);
  std::string text;
  record.sized(text);
  std::istringstream stream(text);
  boost::archive::binary_iarchive archive(stream);
  const auto grid = std::make_shared<dealii::Triangulation<dim>>();
  grid->load(archive, 0);
  Discretisation result(grid);
  record.sized(result.faces, result.materials, result.inclusion_materials);
  Nodal places_m = result.points_m;
  record(places_m);
  result.place(std::move(places_m));
  return result;
}

template <int dim>
bool Discretisation<dim>::hangs(int node) const {
  return parts_->hanging.is_constrained(dim * node);
}

template <int dim>
int Discretisation<dim>::hanging_count() const {
  return static_cast<int>(parts_->hanging.n_constraints()) / dim;
}

template <int dim>
std::vector<std::pair<int, double>> Discretisation<dim>::masters(int node) const {
  std::vector<std::pair<int, double>> result;
  for (const auto& [dof, weight] : *parts_->hanging.get_constraint_entries(dim * node)) {
    result.emplace_back(static_cast<int>(dof) / dim, weight);
  }
  return result;
}

template <int dim>
void Discretisation<dim>::distribute(Nodal& values) const {
  dealii::Vector<double> vector = to_vector(values);
  parts_->hanging.distribute(vector);
  std::copy(vector.begin(), vector.end(), values.data());
}

template <int dim>
void Discretisation<dim>::condense(Nodal& forces) const {
  dealii::Vector<double> vector = to_vector(forces);
  parts_->hanging.condense(vector);
  std::copy(vector.begin(), vector.end(), forces.data());
}

template <int dim>
std::vector<CellGeometry<dim>> Discretisation<dim>::cell_geometry() const {
  using namespace dealii;
  FEValues<dim> values(parts_->mapping, parts_->scalar, QGauss<dim>(3),
                       update_inverse_jacobians | update_JxW_values | update_quadrature_points);
  std::vector<CellGeometry<dim>> result;
  result.reserve(cells.size());
  for (const auto& cell : parts_->grid->active_cell_iterators()) {
    values.reinit(cell);
    CellGeometry<dim>& at = result.emplace_back();
    std::tie(at.center_m, at.scale_m) = pressure_frame(static_cast<int>(cell->active_cell_index()));
    for (const unsigned int q : values.quadrature_point_indices()) {
      const DerivativeForm<1, dim, dim>& inverse_jacobian = values.inverse_jacobian(q);
      for (int i = 0; i < dim; ++i) {
        for (int j = 0; j < dim; ++j) at.inverse_jacobian_per_m[q](i, j) = inverse_jacobian[i][j];
      }
      at.place_m[q] = to_eigen<dim>(values.quadrature_point(q));
      at.weight[q] = values.JxW(q);
    }
  }
  return result;
}

template <int dim>
std::pair<typename Discretisation<dim>::Point, double> Discretisation<dim>::pressure_frame(int cell) const {
  const auto nodes_m = points_m(Eigen::all, cells[static_cast<std::size_t>(cell)]);
  const Point low_m = nodes_m.rowwise().minCoeff(), high_m = nodes_m.rowwise().maxCoeff();
  return {0.5 * (low_m + high_m), (high_m - low_m).maxCoeff()};
}

template <int dim>
std::vector<typename Discretisation<dim>::FaceGeometry> Discretisation<dim>::face_geometry() const {
  using namespace dealii;
  // Its points are the nodes of a quadratic face.
  FEFaceValues<dim> values(parts_->mapping, parts_->scalar, QGaussLobatto<dim - 1>(3),
                           update_values | update_JxW_values | update_normal_vectors);
  std::vector<FaceGeometry> result;
  for (const auto& cell : parts_->grid->active_cell_iterators()) {
    for (const unsigned int f : cell->face_indices()) {
      if (!cell->face(f)->at_boundary()) continue;
      values.reinit(cell, f);
      const auto& nodes = faces[result.size()].nodes;
      FaceGeometry& at = result.emplace_back();
      for (const unsigned int q : values.quadrature_point_indices()) {
        for (const unsigned int a : values.dof_indices()) {
          if (values.shape_value(a, q) < 0.5) continue;
          const int node = cells[cell->active_cell_index()][parts_->to_lexicographic[a]];
          const auto place = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
          at.weight[place] = values.JxW(q);
          at.normal.col(place) = to_eigen<dim>(values.normal_vector(q));
        }
      }
    }
  }
  return result;
}

template <int dim>
std::vector<char> Discretisation<dim>::cells_of(const std::vector<int>& nodes) const {
  std::vector<char> is_one(static_cast<std::size_t>(node_count()), 0);
  for (const int node : nodes) is_one[node] = 1;
  for (int node = 0; node < node_count(); ++node) {
    if (!hangs(node)) continue;
    for (const auto& [master, weight] : masters(node)) is_one[node] |= is_one[master];
  }
  std::vector<char> result;
  for (const auto& cell : cells) {
    result.push_back(std::any_of(cell.begin(), cell.end(), [&](int node) { return is_one[node] != 0; }) ? 1 : 0);
  }
  return result;
}

template <int dim>
std::vector<int> Discretisation<dim>::partition(int parts) const {
  dealii::GridTools::partition_triangulation_zorder(static_cast<unsigned int>(parts), *parts_->grid, false);
  std::vector<int> result;
  for (const auto& cell : parts_->grid->active_cell_iterators())
    result.push_back(static_cast<int>(cell->subdomain_id()));
  return result;
}

template <int dim>
const dealii::DoFHandler<dim>& Discretisation<dim>::dof_handler() const {
  return parts_->dofs;
}

template <int dim>
const dealii::AffineConstraints<double>& Discretisation<dim>::hanging_nodes() const {
  return parts_->hanging;
}

template <int dim>
const dealii::Mapping<dim, dim>& Discretisation<dim>::mapping() const {
  return parts_->mapping;
}

template class Discretisation<2>;
template class Discretisation<3>;

}  // namespace touchstone::reference
