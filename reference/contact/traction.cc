#include "reference/contact/traction.h"

#include <algorithm>

namespace touchstone::reference {

template <int dim>
ContactTraction<dim> contact_traction(const ContactModel<dim>& model, const ElasticBody<dim>& body,
                                      const State<dim>& state) {
  ContactTraction<dim> traction;
  traction.nodal_pa.setZero(dim, model.mesh.node_count());
  if (!model.tool) return traction;
  for (const NodeContact<dim>& contact :
       model.contacts_of(state, body.forces(state).nodal_n, model.touching_points(state, model.region_gap_m))) {
    const double area_m2 = model.area_m2[contact.node];
    if (!(area_m2 > 0.0)) continue;
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
