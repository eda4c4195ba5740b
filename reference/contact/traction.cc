#include "reference/contact/traction.h"

#include "reference/discretisation/shape.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numbers>

namespace touchstone::reference {
namespace {

/// Per node the current area of the surface that may touch, in its first row: what the Gauss-Lobatto rule, whose points
/// are the nodes, gives on the faces [m^2].
template <int dim>
typename ContactModel<dim>::Nodal current_area_m2(const ContactModel<dim>& model, const State<dim>& state) {
  constexpr std::array weight = {1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0};
  constexpr int count = Discretisation<dim>::nodes_per_face;
  std::vector<Shape<dim - 1>> at_node;
  for (int a = 0; a < count; ++a) {
    Eigen::Matrix<double, dim - 1, 1> xi;
    const int row = a / 3;
    xi[0] = 0.5 * (a % 3);
    if constexpr (dim == 3) xi[1] = 0.5 * row;
    at_node.emplace_back(xi);
  }
  typename ContactModel<dim>::Nodal area_m2 = ContactModel<dim>::Nodal::Zero(dim, model.mesh.node_count());
  for (const auto& face : model.mesh.faces) {
    if (face.boundary != Boundary::free) continue;
    Eigen::Matrix<double, dim, count> x_m;
    for (int a = 0; a < count; ++a) x_m.col(a) = model.place_m(state, face.nodes[a]);
    for (int a = 0; a < count; ++a) {
      const Eigen::Matrix<double, dim, dim - 1> tangent = x_m * at_node[a].gradient;
      if constexpr (dim == 3) {
        const Eigen::Vector3d first = tangent.col(0), second = tangent.col(1);
        area_m2(0, face.nodes[a]) += weight[a % 3] * weight[a / 3] * first.cross(second).norm();
      } else {
        area_m2(0, face.nodes[a]) += weight[a] * tangent.norm() * 2.0 * std::numbers::pi * x_m(0, a);
      }
    }
  }
  model.mesh.condense(area_m2);
  return area_m2;
}

}  // namespace

template <int dim>
ContactTraction<dim> contact_traction(const ContactModel<dim>& model, const ElasticBody<dim>& body,
                                      const State<dim>& state) {
  ContactTraction<dim> traction;
  traction.nodal_pa.setZero(dim, model.mesh.node_count());
  if (!model.tool) return traction;
  const auto areas_m2 = current_area_m2(model, state);
  for (const NodeContact<dim>& contact :
       model.contacts_of(state, body.forces(state).nodal_n, model.touching_points(state, model.region_gap_m))) {
    if (!(model.area_m2[contact.node] > 0.0)) continue;  // on the axis
    const double area_m2 = areas_m2(0, contact.node);
    traction.nodal_pa.col(contact.node) = (contact.normal_n * contact.normal + contact.friction_n) / area_m2;
    traction.pressure_peak_pa = std::max(traction.pressure_peak_pa, contact.normal_n / area_m2);
  }
  model.mesh.distribute(traction.nodal_pa);
  // The node on the axis has no area: nearly its neighbour's, and along the axis.
  for (const int node : model.nodes) {
    if (dim == 2 && model.axis_partner[node] >= 0) {
      traction.nodal_pa(dim - 1, node) = traction.nodal_pa(dim - 1, model.axis_partner[node]);
    }
  }
  return traction;
}

template ContactTraction<2> contact_traction(const ContactModel<2>&, const ElasticBody<2>&, const State<2>&);
template ContactTraction<3> contact_traction(const ContactModel<3>&, const ElasticBody<3>&, const State<3>&);

}  // namespace touchstone::reference
