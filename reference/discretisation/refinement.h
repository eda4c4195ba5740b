// Where the cells of a mesh are too large, estimated from a solution on it.
#pragma once

#include "reference/discretisation/discretisation.h"

#include <Eigen/Core>

#include <vector>

namespace touchstone::reference {

/// Estimate of each cell's squared error in the energy norm, up to a factor: the jumps of the displacement's normal
/// derivative to the neighbours, by deal.II's KellyErrorEstimator (D. W. Kelly et al., Int. J. Numer. Methods Eng. 19
/// (1983) 1593-1619). It sees no error of what acts on the surface. dim = 2: times the distance from the axis.
template <int dim>
[[nodiscard]] Eigen::VectorXd squared_error_estimate(const Discretisation<dim>& mesh,
                                                     const typename Discretisation<dim>::Nodal& displacement_m);

/// This share of the cells, rounded up, those with the largest error; one flag per cell.
[[nodiscard]] std::vector<char> worst_cells(const Eigen::VectorXd& squared_error, double share);

}  // namespace touchstone::reference
