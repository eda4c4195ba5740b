#include "reference/mesh/boundary_surface.h"

#include "reference/discretisation/discretisation.h"
#include "reference/discretisation/shape.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace touchstone::reference {
namespace {

constexpr int parts = 4;  ///< of a face's side: its nodes are every second place
constexpr int turns = 48;

using Vectors = std::vector<Eigen::Vector3d>;

/// Points with what is given per point.
struct Points {
  Vectors rest_m, displacement_m, traction_pa;
  std::vector<bool> is_node;

  void append(const Points& other) {
    rest_m.insert(rest_m.end(), other.rest_m.begin(), other.rest_m.end());
    displacement_m.insert(displacement_m.end(), other.displacement_m.begin(), other.displacement_m.end());
    traction_pa.insert(traction_pa.end(), other.traction_pa.begin(), other.traction_pa.end());
    is_node.insert(is_node.end(), other.is_node.begin(), other.is_node.end());
  }
};

/// Adds a grid of points, `columns` to a row, as triangles.
void add_grid(const Points& grid, std::int32_t columns, Points& all,
              std::vector<std::array<std::int32_t, 3>>& triangles) {
  const auto first = static_cast<std::int32_t>(all.rest_m.size());
  const auto rows = static_cast<std::int32_t>(grid.rest_m.size()) / columns;
  all.append(grid);
  for (std::int32_t row = 0; row + 1 < rows; ++row) {
    for (std::int32_t column = 0; column + 1 < columns; ++column) {
      const std::int32_t a = first + row * columns + column, b = a + columns;
      triangles.push_back({a, a + 1, b + 1});
      triangles.push_back({a, b + 1, b});
    }
  }
}

Eigen::Matrix3Xd joined(const Vectors& vectors) {
  Eigen::Matrix3Xd out(3, static_cast<Eigen::Index>(vectors.size()));
  for (std::size_t i = 0; i < vectors.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = vectors[i];
  return out;
}

}  // namespace

template <int dim>
BoundarySurface boundary_surface(const Discretisation<dim>& mesh, const Eigen::Matrix<double, dim, Eigen::Dynamic>& u_m,
                                 const Eigen::Matrix<double, dim, Eigen::Dynamic>& t_pa, bool mirror_x, bool mirror_y) {
  BoundarySurface out;
  Points all;
  for (const auto& face : mesh.faces) {
    if (face.boundary != Boundary::free && face.boundary != Boundary::held) continue;
    const auto X_m = mesh.points_m(Eigen::all, face.nodes), U_m = u_m(Eigen::all, face.nodes),
               T_pa = t_pa(Eigen::all, face.nodes);
    Points grid;
    const auto add = [&](const auto& turned, const auto& shape, bool is_node) {
      grid.rest_m.push_back(turned(X_m * shape.value));
      grid.displacement_m.push_back(turned(U_m * shape.value));
      grid.traction_pa.push_back(turned(T_pa * shape.value));
      grid.is_node.push_back(is_node);
    };
    if constexpr (dim == 3) {
      for (const double side_x : {1.0, -1.0}) {
        for (const double side_y : {1.0, -1.0}) {
          if ((side_x < 0.0 && !mirror_x) || (side_y < 0.0 && !mirror_y)) continue;
          const Eigen::Vector3d side(side_x, side_y, 1.0);
          const auto mirrored = [&](const Eigen::Vector3d& v) { return Eigen::Vector3d(v.cwiseProduct(side)); };
          grid = {};
          for (int j = 0; j <= parts; ++j) {
            for (int i = 0; i <= parts; ++i) {
              add(mirrored, Shape<2>(Eigen::Vector2d(i, j) / parts), i % 2 == 0 && j % 2 == 0);
            }
          }
          add_grid(grid, parts + 1, all, out.rest.triangles);
        }
      }
    } else {
      for (int turn = 0; turn <= turns; ++turn) {
        const double angle = 2.0 * std::numbers::pi * turn / turns;
        const auto turned = [&](const Eigen::Vector2d& rz) {
          return Eigen::Vector3d(rz.x() * std::cos(angle), rz.x() * std::sin(angle), rz.y());
        };
        for (int i = 0; i <= parts; ++i) {
          add(turned, Shape<1>(Eigen::Matrix<double, 1, 1>(static_cast<double>(i) / parts)), i % 2 == 0);
        }
      }
      add_grid(grid, parts + 1, all, out.rest.triangles);
    }
  }
  out.rest.points_m = joined(all.rest_m);
  out.displacement_m = joined(all.displacement_m);
  out.traction_pa = joined(all.traction_pa);
  out.is_node = std::move(all.is_node);
  return out;
}

template BoundarySurface boundary_surface(const Discretisation<2>&, const Eigen::Matrix2Xd&, const Eigen::Matrix2Xd&,
                                          bool, bool);
template BoundarySurface boundary_surface(const Discretisation<3>&, const Eigen::Matrix3Xd&, const Eigen::Matrix3Xd&,
                                          bool, bool);

}  // namespace touchstone::reference
