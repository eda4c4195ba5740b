// The boundary of a mesh as triangles, fine enough that its quadratic faces look smooth: what a section is drawn from.
#pragma once

#include "scene/shape/surface.h"

#include <vector>

namespace touchstone::reference {

template <int dim>
class Discretisation;

/// The whole body's surface, symmetric parts put back. Vertices are not shared between faces, so that where faces meet
/// several have the same place, up to the gap between a face and two halves of another along a curved edge.
struct BoundarySurface {
  scene::Surface rest;              ///< points and triangles only, world frame
  Eigen::Matrix3Xd displacement_m;  ///< per point, world frame
  Eigen::Matrix3Xd traction_pa;     ///< the same
  std::vector<bool> is_node;        ///< per point: of the mesh, otherwise in between
};

/// @param u_m  nodal displacements; @param t_pa  nodal tractions
/// @param mirror_x, mirror_y  the mesh is the part x >= 0, y >= 0 of the body; without meaning for dim = 2, whose
///                            meridian is turned about the z axis in even steps, the first at y = 0
template <int dim>
[[nodiscard]] BoundarySurface boundary_surface(const Discretisation<dim>& mesh,
                                               const Eigen::Matrix<double, dim, Eigen::Dynamic>& u_m,
                                               const Eigen::Matrix<double, dim, Eigen::Dynamic>& t_pa, bool mirror_x,
                                               bool mirror_y);

}  // namespace touchstone::reference
