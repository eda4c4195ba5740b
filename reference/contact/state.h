// A state of equilibrium, or on the way to it.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace touchstone::reference {

/// The state that a load step starts from.
template <int dim>
struct State {
  Eigen::Matrix<double, dim, Eigen::Dynamic> u_m;       ///< one column per node, hanging ones included
  Eigen::Matrix<double, dim + 1, Eigen::Dynamic> p_pa;  ///< one column per cell: coefficients of 1, (X - Xc) / h
  std::vector<char> touching;                           ///< per node: in the active set
  // History of friction; empty without friction, and at rest.
  std::vector<char> slipping{};  ///< per node: active and slipping
  std::vector<char> sliding{};   ///< per node: active, in a region that slips as a whole
  Eigen::Matrix3Xd on_tool_m{};  ///< per node of the free surface: its place in the tool frame
  double dissipated_j = 0.0;     ///< by friction since the body was at rest, of the whole body
};

}  // namespace touchstone::reference
