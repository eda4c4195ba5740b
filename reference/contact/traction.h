// What the tool's pressure and friction are on the body's surface.
#pragma once

#include "reference/contact/contact_model.h"
#include "reference/contact/elastic_body.h"
#include "reference/contact/state.h"

namespace touchstone::reference {

/// Of one solved state.
template <int dim>
struct ContactTraction {
  /// On the body, one column per node, zero where nothing touches [Pa]. Per current area, in small strain that at rest:
  /// with the Gauss-Lobatto rule on the faces it sums to the contact force.
  typename ContactModel<dim>::Nodal nodal_pa;
  double pressure_peak_pa = 0.0;  ///< largest part along the tool's normal at a node
};

/// From the active set's nodal forces. The model's tool must be where it was when the state was solved.
template <int dim>
[[nodiscard]] ContactTraction<dim> contact_traction(const ContactModel<dim>& model, const ElasticBody<dim>& body,
                                                    const State<dim>& state);

}  // namespace touchstone::reference
