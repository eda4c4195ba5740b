// What a solved state says.
#pragma once

#include "reference/contact/contact_model.h"
#include "reference/contact/elastic_body.h"
#include "reference/contact/regions.h"

#include <vector>

namespace touchstone::reference {

/// Results of a solved state, of the whole body: mirror images are included.
struct Observation {
  scene::Vec3 force_n = scene::Vec3::Zero();          ///< on the tool, sum over the regions
  scene::Vec3 torque_nm = scene::Vec3::Zero();        ///< on the tool, about its mass centre
  scene::Vec3 support_force_n = scene::Vec3::Zero();  ///< of the support on the body
  double area_m2 = 0.0;                               ///< of contact, on the deformed surface
  double contact_radius_m = 0.0;                      ///< bodies of revolution only: of the contact's edge
  double node_penetration_m = 0.0;                    ///< largest over the nodes where contact is enforced
  double between_nodes_penetration_m = 0.0;           ///< largest over face quadrature points and hanging nodes
  double equilibrium_rel = 0.0;                       ///< |contact + support| / |contact|
  double volume_change_rel = 0.0;
  double dissipated_j = 0.0;  ///< by friction since the body was at rest
  std::vector<ContactRegion> regions;

  /// Of the region that pushes most; zero when apart [m].
  [[nodiscard]] Eigen::Vector2d half_axes_m() const;
};

/// @param region_gap_m  separates regions, see ContactModel::touching_points
template <int dim>
[[nodiscard]] Observation observe(const ContactModel<dim>& model, const ElasticBody<dim>& body, const State<dim>& state,
                                  double region_gap_m);

}  // namespace touchstone::reference
