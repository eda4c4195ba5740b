// Q2 displacement with discontinuous linear pressure on one cell, the pressure condensed. In two dimensions the cell is
// a ring of a body of revolution: integrals carry 2 pi r and the hoop strain u_r / r.
// The pair is inf-sup stable: D. Boffi, F. Brezzi, M. Fortin, Mixed Finite Element Methods (Springer 2013), 8.6.3.
#pragma once

#include "reference/discretisation/shape.h"
#include "reference/fe/neo_hookean.h"
#include "scene/model/scene.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace touchstone::reference {

/// Numbers of the material in the form the element uses.
struct MixedMaterial {
  double mu_pa = 0.0;
  double inverse_kappa_per_pa = 0.0;          ///< zero when incompressible
  double inverse_kappa_tangent_per_pa = 0.0;  ///< in the Jacobian only: at least 1e-4 / mu, so that it has an inverse
  scene::Kinematics kinematics = scene::Kinematics::finite;
  MixedMaterial(const scene::Material& material, scene::Kinematics kinematics);
};

/// What a cell gives. Local displacement unknown (node a, direction i) has index i * nodes + a.
template <int dim>
struct CellResult {
  static constexpr int nodes = Shape<dim>::size;
  static constexpr int unknowns = dim * nodes;
  static constexpr int pressures = dim + 1;
  using Vector = Eigen::Matrix<double, unknowns, 1>;
  using Matrix = Eigen::Matrix<double, unknowns, unknowns, Eigen::RowMajor>;
  using Coupling = Eigen::Matrix<double, pressures, unknowns, Eigen::RowMajor>;
  using Pressure = Eigen::Matrix<double, pressures, 1>;

  Vector force_n;      ///< internal force at the given displacement and pressure
  Pressure volume_m3;  ///< integral of psi_m (J - 1 - p / kappa) where p is the unknown: zero at the solution
  double rest_volume_m3 = 0.0;
  double volume_change_m3 = 0.0;
  double smallest_J = 1.0;
  // Only when the tangent was asked for:
  Matrix stiffness;          ///< condensed
  Vector condensed_force_n;  ///< force plus what the pressure's own residual adds
  Coupling pressure_gain;    ///< the pressure follows a displacement change by dp = offset + gain du
  Pressure pressure_offset_pa;
};

/// What the material does at one point. dim = 2: the directions are r, z and around the axis.
struct PointState {
  Eigen::Matrix3d stress_pa;  ///< Cauchy's, tension positive
  double J_minus_1 = 0.0;     ///< volume change; in small strain the trace of the strain
};

/// What is wanted of a cell beside its forces.
enum class Stiffness {
  none,
  consistent,  ///< the forces' derivative
  definite,    ///< without what rotation and volume take back under pressure: leads to the same balance, more slowly,
               ///< and is positive semidefinite where the derivative is not
};

/// One cell of the mixed element. Stateless except for the materials; every method may be called by several threads.
template <int dim>
class Element {
 public:
  static constexpr int nodes = Shape<dim>::size;
  using Nodal = Eigen::Matrix<double, dim, nodes>;
  using Pressure = typename CellResult<dim>::Pressure;

  /// Material of each Gauss point: 0 the body's, k the k-th inclusion's.
  using Materials = std::array<std::uint8_t, CellGeometry<dim>::points>;

  /// @param bulk_factor  on the numerical bulk modulus
  explicit Element(const MixedMaterial& body, const std::vector<MixedMaterial>& inclusions = {},
                   double bulk_factor = 1.0);

  using PointStates = std::array<PointState, CellGeometry<dim>::points>;

  /// @param u_m nodal displacements
  /// @param p_pa pressure coefficients of 1, (X - Xc) / h
  /// @param materials nullptr: the body's throughout
  /// @param at_points nullptr, or what receives the state at the Gauss points
  /// @returns false, with the result unfinished, when some point has J <= smallest_allowed_J (finite strain only)
  bool evaluate(const CellGeometry<dim>& cell, const Nodal& u_m, const Pressure& p_pa, Stiffness stiffness,
                CellResult<dim>& out, const Materials* materials = nullptr, PointStates* at_points = nullptr) const;

  /// Newton may pass through strongly distorted states, not through these.
  static constexpr double smallest_allowed_J = 0.02;

 private:
  std::vector<MixedMaterial> materials_;  // the body's first
};

}  // namespace touchstone::reference
