#include "reference/mesh/boundary_surface.h"

#include "reference/discretisation/discretisation.h"
#include "reference/discretisation/shape.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace touchstone::reference {
namespace {

constexpr int parts = 4;  ///< of a face's side: its nodes are every second place
constexpr int turns = 48;

using Vectors = std::vector<Eigen::Vector3d>;

/// Adds a grid of places, `columns` to a row, as triangles.
void add_grid(const Vectors& rest_m, const Vectors& displacement_m, const std::vector<bool>& is_node,
              std::int32_t columns, Vectors& all_rest_m, Vectors& all_displacement_m, BoundarySurface& out) {
  const auto first = static_cast<std::int32_t>(all_rest_m.size());
  const auto rows = static_cast<std::int32_t>(rest_m.size()) / columns;
  all_rest_m.insert(all_rest_m.end(), rest_m.begin(), rest_m.end());
  all_displacement_m.insert(all_displacement_m.end(), displacement_m.begin(), displacement_m.end());
  out.is_node.insert(out.is_node.end(), is_node.begin(), is_node.end());
  for (std::int32_t row = 0; row + 1 < rows; ++row) {
    for (std::int32_t column = 0; column + 1 < columns; ++column) {
      const std::int32_t a = first + row * columns + column, b = a + columns;
      out.rest.triangles.push_back({a, a + 1, b + 1});
      out.rest.triangles.push_back({a, b + 1, b});
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
                                 bool mirror_x, bool mirror_y) {
  BoundarySurface out;
  Vectors all_rest_m, all_displacement_m;
  for (const auto& face : mesh.faces) {
    if (face.boundary != Boundary::free && face.boundary != Boundary::held) continue;
    Eigen::Matrix<double, dim, Discretisation<dim>::nodes_per_face> X_m, U_m;
    for (int a = 0; a < Discretisation<dim>::nodes_per_face; ++a) {
      X_m.col(a) = mesh.points_m.col(face.nodes[a]);
      U_m.col(a) = u_m.col(face.nodes[a]);
    }
    Vectors rest_m, displacement_m;
    std::vector<bool> is_node;
    if constexpr (dim == 3) {
      for (int j = 0; j <= parts; ++j) {
        for (int i = 0; i <= parts; ++i) {
          const Shape<2> shape(Eigen::Vector2d(i, j) / parts);
          rest_m.emplace_back(X_m * shape.value);
          displacement_m.emplace_back(U_m * shape.value);
          is_node.push_back(i % 2 == 0 && j % 2 == 0);
        }
      }
      for (const double side_x : {1.0, -1.0}) {
        for (const double side_y : {1.0, -1.0}) {
          if ((side_x < 0.0 && !mirror_x) || (side_y < 0.0 && !mirror_y)) continue;
          const Eigen::Vector3d side(side_x, side_y, 1.0);
          Vectors mirrored_rest_m, mirrored_displacement_m;
          for (const auto& p : rest_m) mirrored_rest_m.emplace_back(p.cwiseProduct(side));
          for (const auto& u : displacement_m) mirrored_displacement_m.emplace_back(u.cwiseProduct(side));
          add_grid(mirrored_rest_m, mirrored_displacement_m, is_node, parts + 1, all_rest_m, all_displacement_m, out);
        }
      }
    } else {
      for (int turn = 0; turn <= turns; ++turn) {
        const double angle = 2.0 * std::numbers::pi * turn / turns;
        for (int i = 0; i <= parts; ++i) {
          const Shape<1> shape(Eigen::Matrix<double, 1, 1>(static_cast<double>(i) / parts));
          const auto turned = [&](const Eigen::Vector2d& rz) {
            return Eigen::Vector3d(rz.x() * std::cos(angle), rz.x() * std::sin(angle), rz.y());
          };
          rest_m.push_back(turned(X_m * shape.value));
          displacement_m.push_back(turned(U_m * shape.value));
          is_node.push_back(i % 2 == 0);
        }
      }
      add_grid(rest_m, displacement_m, is_node, parts + 1, all_rest_m, all_displacement_m, out);
    }
  }
  out.rest.points_m = joined(all_rest_m);
  out.displacement_m = joined(all_displacement_m);
  return out;
}

template BoundarySurface boundary_surface(const Discretisation<2>&, const Eigen::Matrix2Xd&, bool, bool);
template BoundarySurface boundary_surface(const Discretisation<3>&, const Eigen::Matrix3Xd&, bool, bool);

}  // namespace touchstone::reference
