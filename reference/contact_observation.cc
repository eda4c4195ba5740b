// What a solved state says.
#include "reference/contact_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::reference {

template <int dim>
Observation ContactProblem<dim>::observe(const State<dim>& state) const {
  Observation seen;
  const Nodal F = forces(state).nodal_n;
  const double images = (mirror_x_ ? 2.0 : 1.0) * (mirror_y_ ? 2.0 : 1.0);
  // A mirror image doubles what lies in the mirror's plane and cancels what does not.
  const auto with_images = [&](Point part) {
    scene::Vec3 whole = scene::Vec3::Zero();
    if constexpr (dim == 2) {
      whole.z() = part[1];
    } else {
      whole = images * part;
      if (mirror_x_) whole.x() = 0.0;
      if (mirror_y_) whole.y() = 0.0;
    }
    return whole;
  };

  Point support = Point::Zero();
  std::vector<char> held(mesh_.node_count(), 0);
  for (const auto& face : mesh_.faces) {
    if (face.boundary != Boundary::held) continue;
    for (const int node : face.nodes) held[node] = 1;
  }
  for (int node = 0; node < mesh_.node_count(); ++node) {
    if (held[node]) support += F.col(node);
  }
  seen.support_force_n = with_images(support);

  double change_m3 = 0.0, rest_m3 = 0.0;
  {
    CellResult<dim> result;
    typename Element<dim>::Nodal X, u;
    for (int c = 0; c < mesh_.cell_count(); ++c) {
      for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
        X.col(a) = mesh_.points_m.col(mesh_.cells[c][a]);
        u.col(a) = state.u_m.col(mesh_.cells[c][a]);
      }
      element_.evaluate(X, u, state.p_pa.col(c), false, result);
      change_m3 += result.volume_change_m3;
      rest_m3 += result.rest_volume_m3;
    }
  }
  seen.volume_change_rel = change_m3 / rest_m3;
  if (!tool_) return seen;

  // Contact forces lambda grad g act on the body; the tool gets their opposite.
  Point force = Point::Zero();
  scene::Vec3 torque = scene::Vec3::Zero();
  double touching_area_m2 = 0.0;
  std::vector<double> pressure_pa(mesh_.node_count(), 0.0);
  std::vector<double> opening_m(mesh_.node_count(), std::numeric_limits<double>::infinity());
  for (const int node : contact_nodes_) {
    const Gap<dim> g = gap(state, node);
    opening_m[node] = g.value_m;
    seen.node_penetration_m = std::max(seen.node_penetration_m, -g.value_m);
    if (!state.touching[node]) continue;
    Point normal = g.gradient;
    for (int i = 0; i < dim; ++i) {
      if (prescribed_[node * dim + i]) normal[i] = 0.0;
    }
    const double lambda_n = F.col(node).dot(normal) / normal.squaredNorm();
    const Point on_tool_n = -lambda_n * g.gradient;
    force += on_tool_n;
    if constexpr (dim == 3) {
      torque += scene::Vec3(mesh_.points_m.col(node) + state.u_m.col(node) - tool_->center_m).cross(on_tool_n);
    }
    touching_area_m2 += area_m2_[node];
    if (area_m2_[node] > 0.0) pressure_pa[node] = lambda_n / area_m2_[node];
  }
  seen.force_n = with_images(force);
  if constexpr (dim == 3) {
    // Torque is a pseudo-vector: mirrored in x = 0 only its x component survives.
    seen.torque_nm = images * torque;
    if (mirror_x_) seen.torque_nm.y() = seen.torque_nm.z() = 0.0;
    if (mirror_y_) seen.torque_nm.x() = seen.torque_nm.z() = 0.0;
  }
  const double force_n = seen.force_n.norm();
  seen.equilibrium_rel = force_n > 0.0 ? (seen.support_force_n - seen.force_n).norm() / force_n : 0.0;

  // Contact area. The edge is placed between nodes with the field that any frictionless contact has at its edge:
  // pressure A sqrt(s) inside and opening (4 A / 3 E*) s^(3/2) outside, s the distance from the edge (the half-plane
  // solution; K. L. Johnson, Contact Mechanics (1985), 5.1). A is Hertz's, (2 E* / pi R) sqrt(2 a); only the ratio of
  // the two sides matters. The nodal field s, positive inside, is then cut linearly on the deformed surface.
  const double E_star_pa = material_.contact_modulus_pa();
  const double a_m = std::sqrt(images * touching_area_m2 / std::numbers::pi);
  const double A = 2.0 * E_star_pa / (std::numbers::pi * tool_->radius_m) * std::sqrt(2.0 * a_m);
  std::vector<double> s(mesh_.node_count(), -std::numeric_limits<double>::max());
  for (const int node : contact_nodes_) {
    if (state.touching[node]) {
      s[node] = pressure_pa[node] > 0.0 ? (pressure_pa[node] / A) * (pressure_pa[node] / A) : 0.0;
    } else if (A > 0.0 && std::isfinite(opening_m[node])) {
      s[node] = -std::pow(0.75 * E_star_pa * std::max(opening_m[node], 0.0) / A, 2.0 / 3.0);
    }
  }
  for (const auto& hanging : mesh_.hanging) {
    s[hanging.node] = 0.0;
    for (const auto& [master, weight] : hanging.masters) s[hanging.node] += weight * s[master];
  }
  if constexpr (dim == 2) {
    for (const int node : contact_nodes_) {
      if (axis_partner_[node] >= 0 && state.touching[node]) s[node] = s[axis_partner_[node]];
    }
  }
  const bool finite = kinematics_ == scene::Kinematics::finite;
  const auto place = [&](int node) -> Point {
    return finite ? Point(mesh_.points_m.col(node) + state.u_m.col(node)) : Point(mesh_.points_m.col(node));
  };
  const GaussRule<dim - 1> rule;
  for (const auto& face : mesh_.faces) {
    if (face.boundary != Boundary::free) continue;
    const bool touched = std::any_of(face.nodes.begin(), face.nodes.end(), [&](int n) { return s[n] > 0.0; });
    if (!touched) continue;
    if constexpr (dim == 2) {
      for (int k = 0; k < 2; ++k) {
        Point x0 = place(face.nodes[k]), x1 = place(face.nodes[k + 1]);
        const double s0 = s[face.nodes[k]], s1 = s[face.nodes[k + 1]];
        if (s0 <= 0.0 && s1 <= 0.0) continue;
        if (s0 * s1 < 0.0) (s0 < 0.0 ? x0 : x1) = x0 + s0 / (s0 - s1) * (x1 - x0);
        seen.area_m2 += std::numbers::pi * (x0[0] + x1[0]) * (x1 - x0).norm();
        seen.contact_radius_m = std::max({seen.contact_radius_m, x0[0], x1[0]});
      }
    } else {
      // Four quarters, each cut along either diagonal and averaged, which keeps mirror images equal; of each triangle
      // the part with s > 0.
      for (const int corner : {0, 1, 3, 4}) {
        const int c00 = corner, c10 = corner + 1, c01 = corner + 3, c11 = corner + 4;
        const int triangles[4][3] = {{c00, c10, c11}, {c00, c11, c01}, {c00, c10, c01}, {c10, c11, c01}};
        for (const auto& triangle : triangles) {
          std::vector<Point> polygon;
          for (int k = 0; k < 3; ++k) {
            const int from = face.nodes[triangle[k]], to = face.nodes[triangle[(k + 1) % 3]];
            if (s[from] > 0.0) polygon.push_back(place(from));
            if ((s[from] > 0.0) != (s[to] > 0.0)) {
              polygon.push_back(place(from) + s[from] / (s[from] - s[to]) * (place(to) - place(from)));
            }
          }
          for (std::size_t k = 2; k < polygon.size(); ++k) {
            const Eigen::Vector3d side1 = polygon[k - 1] - polygon[0], side2 = polygon[k] - polygon[0];
            seen.area_m2 += 0.5 * images * 0.5 * side1.cross(side2).norm();
          }
        }
      }
    }
    // Penetration where nothing enforces contact.
    for (int q = 0; q < GaussRule<dim - 1>::size; ++q) {
      const Q2<dim - 1> shape(rule.points[q]);
      Point X = Point::Zero(), u = Point::Zero(), N = Point::Zero();
      for (int a = 0; a < Mesh<dim>::nodes_per_face; ++a) {
        X += shape.value[a] * mesh_.points_m.col(face.nodes[a]);
        u += shape.value[a] * state.u_m.col(face.nodes[a]);
        N += shape.value[a] * surface_normal_.col(face.nodes[a]);
      }
      const Gap<dim> g = finite ? tool_->gap(X + u) : tool_->gap_along(X, N.normalized(), u);
      seen.between_nodes_penetration_m = std::max(seen.between_nodes_penetration_m, -g.value_m);
    }
  }
  for (const auto& hanging : mesh_.hanging) {
    if (surface_normal_.col(hanging.node).isZero(0.0)) continue;
    seen.between_nodes_penetration_m = std::max(seen.between_nodes_penetration_m, -gap(state, hanging.node).value_m);
  }
  return seen;
}

template Observation ContactProblem<2>::observe(const State<2>&) const;
template Observation ContactProblem<3>::observe(const State<3>&) const;

}  // namespace touchstone::reference
