#include "reference/contact/observation.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::reference {
namespace {

/// Moments of a region's area, seen along its normal force.
struct Moments {
  scene::Vec3 normal = scene::Vec3::Zero();  ///< unit length
  double area_m2 = 0.0;
  scene::Vec3 first_m3 = scene::Vec3::Zero();
  scene::Mat3 second_m4 = scene::Mat3::Zero();

  /// Corners from any common origin, in any order.
  void add_triangle(const scene::Vec3& a_m, const scene::Vec3& b_m, const scene::Vec3& c_m) {
    const double seen_m2 = 0.5 * std::abs(normal.dot((b_m - a_m).cross(c_m - a_m)));
    const scene::Vec3 middle_m = (a_m + b_m + c_m) / 3.0;
    area_m2 += seen_m2;
    first_m3 += seen_m2 * middle_m;
    second_m4 +=
        seen_m2 / 12.0 *
        (a_m * a_m.transpose() + b_m * b_m.transpose() + c_m * c_m.transpose() + 9.0 * middle_m * middle_m.transpose());
  }
  /// A ring about the axis, which is the normal; outwards positive.
  void add_ring(double r0_m, double r1_m) {
    area_m2 += std::numbers::pi * (r1_m * r1_m - r0_m * r0_m);
    second_m4.topLeftCorner<2, 2>() +=
        0.25 * std::numbers::pi * (std::pow(r1_m, 4) - std::pow(r0_m, 4)) * Eigen::Matrix2d::Identity();
  }
  /// Of an ellipse with semi-axes a and b the second moments over the area are a^2 / 4 and b^2 / 4.
  [[nodiscard]] Eigen::Vector2d half_axes_m() const {
    if (area_m2 == 0.0) return Eigen::Vector2d::Zero();
    const scene::Vec3 middle_m = first_m3 / area_m2;
    const scene::Mat3 along = scene::Mat3::Identity() - normal * normal.transpose();
    const Eigen::SelfAdjointEigenSolver<scene::Mat3> spread(
        along * (second_m4 / area_m2 - middle_m * middle_m.transpose()) * along, Eigen::EigenvaluesOnly);
    return 2.0 * spread.eigenvalues().tail<2>().reverse().cwiseMax(0.0).cwiseSqrt();
  }
};

}  // namespace

Eigen::Vector2d Observation::half_axes_m() const {
  const auto most = std::ranges::max_element(regions, {}, [](const ContactRegion& one) { return one.force_n.norm(); });
  return most == regions.end() ? Eigen::Vector2d::Zero() : most->half_axes_m;
}

template <int dim>
Observation observe(const ContactModel<dim>& model, const ElasticBody<dim>& body, const State<dim>& state,
                    double region_gap_m) {
  using Point = typename ContactModel<dim>::Point;
  Observation seen;
  const typename ContactModel<dim>::Nodal F = body.forces(state).nodal_n;
  const double images = model.images();
  // A mirror image doubles what lies in the mirror's plane and cancels what does not.
  const auto with_images = [&](Point part) {
    scene::Vec3 whole = scene::Vec3::Zero();
    if constexpr (dim == 2) {
      whole.z() = part[1];
    } else {
      whole = images * part;
      if (model.mirror_x) whole.x() = 0.0;
      if (model.mirror_y) whole.y() = 0.0;
    }
    return whole;
  };

  Point support = Point::Zero();
  std::vector<char> held(model.mesh.node_count(), 0);
  for (const auto& face : model.mesh.faces) {
    if (face.boundary != Boundary::held) continue;
    for (const int node : face.nodes) held[node] = 1;
  }
  for (int node = 0; node < model.mesh.node_count(); ++node) {
    if (held[node]) support += F.col(node);
  }
  seen.support_force_n = with_images(support);

  seen.volume_change_rel = body.volume_change_rel(state);
  if (!model.tool) return seen;

  // Contact forces lambda grad g act on the body; the tool gets their opposite.
  std::vector<double> pressure_pa(model.mesh.node_count(), 0.0);
  std::vector<double> opening_m(model.mesh.node_count(), std::numeric_limits<double>::infinity());
  std::vector<char> inside = state.touching;
  std::vector<int> touching_index(model.mesh.node_count(), -1);
  std::vector<Point> on_tool_n;
  for (const int node : model.nodes) {
    const Gap<dim> g = model.gap(state, node);
    opening_m[node] = g.value_m;
    seen.node_penetration_m = std::max(seen.node_penetration_m, -g.value_m);
    if (!state.touching[node]) continue;
    Point normal = g.gradient;
    for (int i = 0; i < dim; ++i) {
      if (model.prescribed[node * dim + i]) normal[i] = 0.0;
    }
    touching_index[node] = static_cast<int>(on_tool_n.size());
    on_tool_n.push_back(-F.col(node).dot(normal) / normal.squaredNorm() * g.gradient);
    if (model.area_m2[node] > 0.0)
      pressure_pa[node] = -on_tool_n.back().dot(g.gradient.normalized()) / model.area_m2[node];
  }
  for (int node = 0; node < model.mesh.node_count(); ++node) {
    if (!model.mesh.hangs(node) || model.normal.col(node).isZero(0.0)) continue;
    opening_m[node] = model.gap(state, node).value_m;
    seen.between_nodes_penetration_m = std::max(seen.between_nodes_penetration_m, -opening_m[node]);
    double share = 0.0;
    for (const auto& [master, weight] : model.mesh.masters(node)) {
      pressure_pa[node] += weight * pressure_pa[master];
      share += weight * inside[master];
    }
    inside[node] = share > 0.5 ? 1 : 0;
  }
  if constexpr (dim == 2) {
    for (const int node : model.nodes) {
      if (model.axis_partner[node] >= 0) pressure_pa[node] = pressure_pa[model.axis_partner[node]];
    }
  }

  const Touching touched = model.touching_points(state, region_gap_m);
  const std::vector<scene::Vec3>& mirrors = touched.mirrors;
  const std::vector<int>& region_of = touched.region_of;
  const int touching_count = static_cast<int>(touched.nodes.size());
  const auto place = [&](int node) { return model.place_m(state, node); };
  // Friction, which the weights by pressure below go without.
  std::vector<Point> friction_on_tool_n(touching_count, Point::Zero());
  if (model.friction) {
    for (const NodeContact<dim>& contact : model.contacts_of(state, F, touched)) {
      friction_on_tool_n[touching_index[contact.node]] = -contact.friction_n;
    }
    seen.dissipated_j = state.dissipated_j;
  }
  std::vector<double> weights_n, stuck_n;
  for (std::size_t point = 0; point < region_of.size(); ++point) {
    const int i = static_cast<int>(point) % touching_count;
    if (region_of[point] == static_cast<int>(seen.regions.size())) {
      seen.regions.emplace_back();
      weights_n.push_back(0.0);
      stuck_n.push_back(0.0);
    }
    ContactRegion& region = seen.regions[region_of[point]];
    const double weight_n = on_tool_n[i].norm();
    weights_n[region_of[point]] += weight_n;
    if (model.friction && !state.slipping[touched.nodes[i]]) stuck_n[region_of[point]] += weight_n;
    if constexpr (dim == 3) {
      const scene::Vec3& mirror = mirrors[point / touching_count];
      const scene::Vec3 at_m = mirror.cwiseProduct(place(touched.nodes[i]));
      const scene::Vec3 friction_n = mirror.cwiseProduct(friction_on_tool_n[i]);
      const scene::Vec3 force_n = mirror.cwiseProduct(on_tool_n[i]) + friction_n;
      region.friction_n += friction_n;
      region.force_n += force_n;
      region.torque_nm += (at_m - model.tool->mass_center_m()).cross(force_n);
      region.center_m += weight_n * at_m;
    } else {
      region.friction_n.z() += friction_on_tool_n[i][1];
      region.force_n.z() += on_tool_n[i][1] + friction_on_tool_n[i][1];
      region.center_m.z() += weight_n * place(touched.nodes[i])[1];
    }
  }
  std::vector<Moments> moments(seen.regions.size());
  for (std::size_t r = 0; r < seen.regions.size(); ++r) {
    moments[r].normal = (seen.regions[r].force_n - seen.regions[r].friction_n).normalized();
    if (model.friction) seen.regions[r].stuck_share = weights_n[r] > 0.0 ? stuck_n[r] / weights_n[r] : 0.0;
    seen.regions[r].center_m /= std::max(weights_n[r], std::numeric_limits<double>::min());
    seen.force_n += seen.regions[r].force_n;
    seen.torque_nm += seen.regions[r].torque_nm;
  }
  const double force_n = seen.force_n.norm();
  seen.equilibrium_rel = force_n > 0.0 ? (seen.support_force_n - seen.force_n).norm() / force_n : 0.0;

  // Contact area: what lies inside the contact's edge on the deformed surface. On a side from a touching node to an
  // open one the edge is placed with the field that any frictionless contact has there: pressure A sqrt(s) at a
  // distance s inside, opening (4 A / 3 E*) s^(3/2) outside (the half-plane solution; K. L. Johnson, Contact Mechanics
  // (1985), 5.1). Pressure, opening and the side's length determine A and the place: with t the share of the side
  // inside, (1 - t)^3 = q^2 t, q = 3 E* opening / (4 pressure length).
  const double E_star_pa = model.material.contact_modulus_pa();
  const auto edge_between = [&](int touching, int open) -> Point {
    Point from = place(touching);
    const Point to = place(open);
    const double q = 0.75 * E_star_pa * std::max(opening_m[open], 0.0) / (pressure_pa[touching] * (to - from).norm());
    if (!(pressure_pa[touching] > 0.0) || !std::isfinite(q)) return from;
    double t = 0.0;  // left of the root of a convex falling function: Newton's method climbs to it
    for (int k = 0; k < 30; ++k)
      t += ((1.0 - t) * (1.0 - t) * (1.0 - t) - q * q * t) / (3.0 * (1.0 - t) * (1.0 - t) + q * q);
    return from + std::min(t, 1.0) * (to - from);
  };
  for (const auto& face : model.mesh.faces) {
    if (face.boundary != Boundary::free) continue;
    const auto first =
        std::find_if(face.nodes.begin(), face.nodes.end(), [&](int n) { return touching_index[n] >= 0; });
    if (first == face.nodes.end()) continue;
    double area_m2 = 0.0;
    const auto region_at = [&](std::size_t m) { return region_of[m * touching_count + touching_index[*first]]; };
    if constexpr (dim == 2) {
      for (int k = 0; k < 2; ++k) {
        const int n0 = face.nodes[k], n1 = face.nodes[k + 1];
        if (!inside[n0] && !inside[n1]) continue;
        const Point x0 = inside[n0] ? place(n0) : edge_between(n1, n0);
        const Point x1 = inside[n1] ? place(n1) : edge_between(n0, n1);
        area_m2 += std::numbers::pi * (x0[0] + x1[0]) * (x1 - x0).norm();
        moments[region_at(0)].add_ring(x0[0], x1[0]);
        seen.contact_radius_m = std::max({seen.contact_radius_m, x0[0], x1[0]});
      }
    } else {
      // Four quarters, each cut along either diagonal and averaged, which keeps mirror images equal.
      for (const int corner : {0, 1, 3, 4}) {
        const int c00 = corner, c10 = corner + 1, c01 = corner + 3, c11 = corner + 4;
        const int triangles[4][3] = {{c00, c10, c11}, {c00, c11, c01}, {c00, c10, c01}, {c10, c11, c01}};
        for (const auto& triangle : triangles) {
          std::vector<Point> polygon;
          for (int k = 0; k < 3; ++k) {
            const int from = face.nodes[triangle[k]], to = face.nodes[triangle[(k + 1) % 3]];
            if (inside[from]) polygon.push_back(place(from));
            if (inside[from] != inside[to])
              polygon.push_back(inside[from] ? edge_between(from, to) : edge_between(to, from));
          }
          for (std::size_t k = 2; k < polygon.size(); ++k) {
            const Eigen::Vector3d side1 = polygon[k - 1] - polygon[0], side2 = polygon[k] - polygon[0];
            area_m2 += 0.5 * 0.5 * side1.cross(side2).norm();
            for (std::size_t m = 0; m < mirrors.size(); ++m) {
              const auto corner_m = [&](std::size_t i) {
                return scene::Vec3(mirrors[m].cwiseProduct(polygon[i]) - seen.regions[region_at(m)].center_m);
              };
              moments[region_at(m)].add_triangle(corner_m(0), corner_m(k - 1), corner_m(k));
            }
          }
        }
      }
    }
    for (std::size_t m = 0; m < mirrors.size(); ++m) {
      seen.area_m2 += area_m2;
      seen.regions[region_at(m)].area_m2 += area_m2;
    }
    // Penetration where nothing enforces contact.
    for (const auto& [xi, weight, shape] : gauss_points<dim - 1>()) {
      Point X = Point::Zero(), u = Point::Zero(), N = Point::Zero();
      for (int a = 0; a < Discretisation<dim>::nodes_per_face; ++a) {
        X += shape.value[a] * model.mesh.points_m.col(face.nodes[a]);
        u += shape.value[a] * state.u_m.col(face.nodes[a]);
        N += shape.value[a] * model.normal.col(face.nodes[a]);
      }
      const Gap<dim> g = model.kinematics == scene::Kinematics::finite ? model.tool->gap(X + u)
                                                                       : model.tool->gap_along(X, N.normalized(), u);
      seen.between_nodes_penetration_m = std::max(seen.between_nodes_penetration_m, -g.value_m);
    }
  }
  for (std::size_t r = 0; r < seen.regions.size(); ++r) seen.regions[r].half_axes_m = moments[r].half_axes_m();
  return seen;
}

template Observation observe(const ContactModel<2>&, const ElasticBody<2>&, const State<2>&, double);
template Observation observe(const ContactModel<3>&, const ElasticBody<3>&, const State<3>&, double);

}  // namespace touchstone::reference
