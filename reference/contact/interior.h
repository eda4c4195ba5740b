// Stress and volume change inside the body.
#pragma once

#include "reference/contact/state.h"
#include "reference/discretisation/discretisation.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

namespace touchstone::reference {

/// Values at the nodes of every cell, one column per cell and node in the order of Discretisation::cells: cells that
/// share a node have values of their own there. The polynomial of a cell's nodal values goes through those at its
/// Gauss points, where a quadratic element's stress is most accurate (J. Barlow, Int. J. Numer. Methods Eng. 10 (1976)
/// 243-251) and the volume change integrates exactly to the body's.
struct Interior {
  Eigen::Matrix<double, 9, Eigen::Dynamic> stress_pa;  ///< Cauchy's, tension positive, a 3 x 3 matrix by columns; in
                                                       ///< two dimensions of the directions r, z and around the axis
  Eigen::RowVectorXd J_minus_1;                        ///< in small strain the trace of the strain
};

/// @param material, kinematics  of the body; its inclusions are the mesh's
template <int dim>
[[nodiscard]] Interior interior(const Discretisation<dim>& mesh, const scene::Material& material,
                                scene::Kinematics kinematics, const State<dim>& state);

}  // namespace touchstone::reference
