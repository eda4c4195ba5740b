// Bodies without contact, made for verification: lattices of cells, dead loads, prescribed displacements in steps.
#pragma once

#include "reference/contact/contact_problem.h"
#include "reference/discretisation/discretisation.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace touchstone::verification {

template <int dim>
using Place = Eigen::Matrix<double, dim, 1>;
template <int dim>
using Nodal = Eigen::Matrix<double, dim, Eigen::Dynamic>;

/// Cells in rows, columns and layers over the unit square or cube, each node at the place of its coordinates. The
/// boundary is free unless a caller prescribes it. @param place_m keeps the orientation
template <int dim>
[[nodiscard]] reference::Discretisation<dim> lattice_mesh(const std::array<int, dim>& cells,
                                                          const std::function<Place<dim>(const Place<dim>&)>& place_m);

/// A cube with hanging nodes around one corner of the top, all of its boundary free.
[[nodiscard]] reference::Discretisation<3> graded_cube(double side_m);

/// The cube of 2 x 2 x 2 cells with its middle vertex off the middle; edges are straight. Its boundary is free.
[[nodiscard]] reference::Discretisation<3> distorted_cube(double side_m);

template <int dim>
void free_all_boundaries(reference::Discretisation<dim>& mesh);

/// Nodal forces of a uniform traction on the rest faces whose middle node is `on`.
[[nodiscard]] Nodal<3> traction_force_n(const reference::Discretisation<3>& mesh, const Eigen::Vector3d& traction_pa,
                                        const std::function<bool(const Eigen::Vector3d& middle_m)>& on);

/// Nodes whose displacement may be prescribed: not hanging. @param on of the node's rest place
template <int dim>
[[nodiscard]] std::vector<int> nodes_where(const reference::Discretisation<dim>& mesh,
                                           const std::function<bool(const Place<dim>&)>& on);

/// The node nearest to a place.
template <int dim>
[[nodiscard]] int node_at(const reference::Discretisation<dim>& mesh, const Place<dim>& place_m);

/// Solves on from a state. @throws reference::NotConverged naming `what`
template <int dim>
void advance(reference::ContactProblem<dim>& body, reference::State<dim>& state, const std::string& what);

/// Solves in equal steps from rest. @param set  sets the prescribed values at a fraction of the load
/// @throws reference::NotConverged naming `what`
template <int dim>
[[nodiscard]] reference::State<dim> solve_in_steps(reference::ContactProblem<dim>& body, int steps,
                                                   const std::string& what,
                                                   const std::function<void(double share)>& set);

/// Contact pressure on the axis of a body of revolution: the force on the middle node of the face in contact there,
/// over that node's part of the area, deformed in finite strain [Pa]; NaN when there is no contact there.
[[nodiscard]] double axis_pressure_pa(const reference::ContactProblem<2>& body, const reference::State<2>& state,
                                      scene::Kinematics kinematics);

/// How far a state of uniform strain is off when u = H X is prescribed on the boundary.
struct PatchDeviation {
  double displacement_rel = 0.0;  ///< over the body's size
  double pressure_rel = 0.0;      ///< variation over Young's modulus
};
template <int dim>
[[nodiscard]] PatchDeviation patch_deviation(reference::Discretisation<dim> mesh,
                                             const Eigen::Matrix<double, dim, dim>& H, const scene::Material& material,
                                             scene::Kinematics kinematics);

/// A cube on lubricated plates, pulled or pressed to a stretch in four steps.
struct PulledBar {
  double nominal_stress_pa = 0.0;
  double volume_change_rel = 0.0;
};
[[nodiscard]] PulledBar pull_bar(const scene::Material& material, double stretch);

/// Inflation of the thick incompressible neo-Hookean sphere between radii of 10 and 20 mm on n x n cells of its
/// meridian plane, the inner surface moved to a stretch.
struct InflatedSphere {
  double displacement_error_l2 = 0.0;  ///< relative
  double inner_pressure_pa = 0.0;
  double exact_pressure_pa = 0.0;
  double shear_modulus_pa = 0.0;
};
[[nodiscard]] InflatedSphere inflate_sphere(double stretch, int n);

}  // namespace touchstone::verification
