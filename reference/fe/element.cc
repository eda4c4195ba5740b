#include "reference/fe/element.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace touchstone::reference {
namespace {

/// mu / kappa of what Newton takes for incompressible.
constexpr double nearly_incompressible = 1e-4;

/// K(a, b) += x(a) y(b) + z(a) v(b) + q(a) t(b), the whole cost of a tangent. n is a multiple of four: padded nodes.
/// The wider clone is chosen by the processor at start-up; sums keep their order, only fused multiply-adds differ.
template <int n>
inline __attribute__((always_inline)) void add_three_products_inline(double* K, const double* x, const double* y,
                                                                     const double* z, const double* v, const double* q,
                                                                     const double* t) {
  for (int a = 0; a < n; ++a) {
    double* row = K + a * n;
    const double xa = x[a], za = z[a], qa = q[a];
    for (int b = 0; b < n; ++b) row[b] += xa * y[b] + za * v[b] + qa * t[b];
  }
}
#if defined(__x86_64__)
#define TOUCHSTONE_CLONES __attribute__((target_clones("default", "arch=haswell")))
#else
#define TOUCHSTONE_CLONES
#endif
TOUCHSTONE_CLONES void add_three_products_28(double* K, const double* x, const double* y, const double* z,
                                             const double* v, const double* q, const double* t) {
  add_three_products_inline<28>(K, x, y, z, v, q, t);
}
TOUCHSTONE_CLONES void add_three_products_12(double* K, const double* x, const double* y, const double* z,
                                             const double* v, const double* q, const double* t) {
  add_three_products_inline<12>(K, x, y, z, v, q, t);
}
#undef TOUCHSTONE_CLONES

}  // namespace

MixedMaterial::MixedMaterial(const scene::Material& material, scene::Kinematics kinematics_in)
    : mu_pa(material.shear_modulus_pa()),
      inverse_kappa_per_pa(3.0 * (1.0 - 2.0 * material.poissons_ratio) / material.youngs_modulus_pa),
      inverse_kappa_tangent_per_pa(std::max(inverse_kappa_per_pa, nearly_incompressible / mu_pa)),
      kinematics(kinematics_in) {}

template <int dim>
Element<dim>::Element(const MixedMaterial& body, const std::vector<MixedMaterial>& inclusions, double bulk_factor)
    : materials_{body} {
  materials_.insert(materials_.end(), inclusions.begin(), inclusions.end());
  // A soft incompressible inclusion is squeezed by the stiffer body around it: Newton needs a bulk modulus to match.
  for (MixedMaterial& material : materials_) {
    material.inverse_kappa_tangent_per_pa = std::max(
        material.inverse_kappa_per_pa, nearly_incompressible / (bulk_factor * std::max(material.mu_pa, body.mu_pa)));
  }
}

template <int dim>
bool Element<dim>::evaluate(const CellGeometry<dim>& cell, const Nodal& u_m, const Pressure& p_pa, Stiffness stiffness,
                            CellResult<dim>& out, const Materials* materials, PointStates* at_points) const {
  const bool with_tangent = stiffness != Stiffness::none;
  constexpr int padded = (nodes + 3) / 4 * 4;
  constexpr int pressures = CellResult<dim>::pressures;
  constexpr int hoop = 2;  // the out-of-plane direction of a ring
  const bool finite = materials_[0].kinematics == scene::Kinematics::finite;

  out.force_n.setZero();
  out.volume_m3.setZero();
  out.rest_volume_m3 = out.volume_change_m3 = 0.0;
  out.smallest_J = 1.0;
  typename CellResult<dim>::Coupling coupling = CellResult<dim>::Coupling::Zero();  // d(volume)/du

  // The pressure's basis psi is 1, (X - Xc) / h in rest coordinates. Integral of psi psi' / kappa, with the tangent's
  // kappa.
  Eigen::Matrix<double, pressures, pressures> compliance = Eigen::Matrix<double, pressures, pressures>::Zero();

  // Blocks (i, j), i <= j, of the tangent, and the part that is the same on the diagonal blocks.
  constexpr int blocks = dim * (dim + 1) / 2;
  alignas(64) double K[blocks][padded * padded];
  alignas(64) double diagonal[padded * padded];
  if (with_tangent) {
    for (auto& block : K) std::fill(std::begin(block), std::end(block), 0.0);
    std::fill(std::begin(diagonal), std::end(diagonal), 0.0);
  }
  // Per node: g = spatial gradient, h = tau_0 g, t = trace and s = tau_0 : l of the unit motion in each direction,
  // v = V t - 2/3 s, e = hoop strain of the unit radial motion. Padding stays zero.
  alignas(64) double g[dim][padded] = {}, h[dim][padded] = {}, t[dim][padded] = {}, s[dim][padded] = {};
  alignas(64) double v[dim][padded] = {}, e[padded] = {}, x[3][padded] = {}, y[padded] = {};

  const auto add = [](double* to, const double* x0, const double* y0, const double* x1, const double* y1,
                      const double* x2, const double* y2) {
    if constexpr (dim == 3) {
      add_three_products_28(to, x0, y0, x1, y1, x2, y2);
    } else {
      add_three_products_12(to, x0, y0, x1, y1, x2, y2);
    }
  };
  static constexpr double none[padded] = {};

  // The pressure unknowns are the least compressible material's. Points of softer bulk have a pressure of their own,
  // kappa (J - 1), and are only tied to the unknowns so weakly that these stay determined in a sliver.
  const MixedMaterial* least_compressible = &materials_[materials ? (*materials)[0] : 0];
  for (int q = 1; materials && q < CellGeometry<dim>::points; ++q) {
    const MixedMaterial& material = materials_[(*materials)[q]];
    if (material.inverse_kappa_per_pa < least_compressible->inverse_kappa_per_pa) least_compressible = &material;
  }
  const double tie_per_pa = nearly_incompressible / least_compressible->mu_pa;

  const std::vector<GaussPoint<dim>>& points = gauss_points<dim>();
  for (int q = 0; q < CellGeometry<dim>::points; ++q) {
    const Shape<dim>& shape = points[q].shape;
    const MixedMaterial& material = materials_[materials ? (*materials)[q] : 0];
    const bool own_pressure = material.inverse_kappa_per_pa > least_compressible->inverse_kappa_per_pa;
    // Lazy, or Eigen takes its path for large matrices.
    const Eigen::Matrix<double, nodes, dim> G = shape.gradient.lazyProduct(cell.inverse_jacobian_per_m[q]);  // dN/dX
    double W_m3 = cell.weight[q];
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    H.template topLeftCorner<dim, dim>() = u_m.lazyProduct(G);
    double radius_m = 0.0;
    if constexpr (dim == 2) {
      radius_m = cell.place_m[q][0];
      W_m3 *= 2.0 * std::numbers::pi * radius_m;
      H(hoop, hoop) = u_m.row(0).dot(shape.value) / radius_m;
    }
    Pressure psi;
    psi[0] = 1.0;
    psi.template tail<dim>() = (cell.place_m[q] - cell.center_m) / cell.scale_m;
    const double unknown_pa = psi.dot(p_pa);
    const double p =
        own_pressure ? (finite ? volume_change(H) : H.trace()) / material.inverse_kappa_per_pa : unknown_pa;
    PointLaw law = finite ? neo_hookean(H, material.mu_pa, p) : linear_elastic(H, material.mu_pa, p);
    if (own_pressure) law.V_pa += law.J * law.J / material.inverse_kappa_per_pa;
    if (stiffness == Stiffness::definite) {
      // S (l_a : l_b^T) is S on the symmetric part of l and -S on the other: the negative one of the two goes. So does
      // what a compressive pressure takes back by V beyond that symmetric part.
      law.mu_bar_pa += 0.5 * std::abs(law.S_pa);
      law.S_pa *= 0.5;
      law.V_pa += std::max(0.0, -2.0 / 3.0 * law.pJ_pa);
    }
    out.smallest_J = std::min(out.smallest_J, 1.0 + law.J_minus_1);
    if (finite && law.J <= smallest_allowed_J) return false;
    out.rest_volume_m3 += W_m3;
    out.volume_change_m3 += W_m3 * law.J_minus_1;
    if (own_pressure) {
      out.volume_m3 -= W_m3 * tie_per_pa * unknown_pa * psi;
      compliance += tie_per_pa * W_m3 * psi * psi.transpose();
    } else {
      out.volume_m3 += W_m3 * (law.J_minus_1 - material.inverse_kappa_per_pa * unknown_pa) * psi;
      compliance += material.inverse_kappa_tangent_per_pa * W_m3 * psi * psi.transpose();
    }

    const Eigen::Matrix<double, nodes, dim> gradients = G * law.F_inverse.template topLeftCorner<dim, dim>();
    const Eigen::Matrix3d tau = law.tau_iso_pa + law.pJ_pa * Eigen::Matrix3d::Identity();
    if (at_points) (*at_points)[q] = {tau / law.J, law.J_minus_1};
    const Eigen::Matrix<double, nodes, dim> tractions = gradients * tau.template topLeftCorner<dim, dim>();
    for (int i = 0; i < dim; ++i) out.force_n.segment(i * nodes, nodes) += W_m3 * tractions.col(i);
    if constexpr (dim == 2) {
      const double per_value = law.F_inverse(hoop, hoop) / radius_m;
      for (int a = 0; a < nodes; ++a) e[a] = shape.value[a] * per_value;
      for (int a = 0; a < nodes; ++a) out.force_n[a] += W_m3 * tau(hoop, hoop) * e[a];
    }
    if (!with_tangent) continue;

    const Eigen::Matrix<double, nodes, dim> stressed = gradients * law.tau_0_pa.template topLeftCorner<dim, dim>();
    for (int i = 0; i < dim; ++i) {
      for (int a = 0; a < nodes; ++a) {
        g[i][a] = t[i][a] = gradients(a, i);
        h[i][a] = s[i][a] = stressed(a, i);
      }
    }
    if constexpr (dim == 2) {
      for (int a = 0; a < nodes; ++a) {
        t[0][a] += e[a];
        s[0][a] += law.tau_0_pa(hoop, hoop) * e[a];
      }
    }
    for (int i = 0; i < dim; ++i) {
      for (int a = 0; a < nodes; ++a) v[i][a] = law.V_pa * t[i][a] - 2.0 / 3.0 * s[i][a];
    }
    for (int i = 0, block = 0; i < dim; ++i) {
      for (int j = i; j < dim; ++j, ++block) {
        for (int a = 0; a < nodes; ++a) {
          x[0][a] = W_m3 * law.S_pa * g[j][a];
          x[1][a] = W_m3 * t[i][a];
          x[2][a] = -2.0 / 3.0 * W_m3 * s[i][a];
        }
        add(K[block], x[0], g[i], x[1], v[j], x[2], t[j]);
      }
    }
    // The diagonal part: l_a : l_b and l_a : (l_b tau_0), summed over directions; a plane cell has room for a zero.
    alignas(64) double z[3][padded] = {};
    for (int m = 0; m < dim; ++m) {
      for (int a = 0; a < nodes; ++a) {
        x[m][a] = W_m3 * g[m][a];
        z[m][a] = h[m][a] + law.mu_bar_pa * g[m][a];
      }
    }
    add(diagonal, x[0], z[0], x[1], z[1], dim == 3 ? x[2] : none, z[2]);
    if constexpr (dim == 2) {
      const double hoop_pa = law.tau_0_pa(hoop, hoop) + law.mu_bar_pa + law.S_pa;
      for (int a = 0; a < nodes; ++a) y[a] = W_m3 * hoop_pa * e[a];
      add(K[0], y, e, none, none, none, none);
    }
    if (own_pressure) continue;
    for (int i = 0; i < dim; ++i) {
      for (int m = 0; m < pressures; ++m) {
        const double factor = W_m3 * law.J * psi[m];
        for (int a = 0; a < nodes; ++a) coupling(m, i * nodes + a) += factor * t[i][a];
      }
    }
  }
  if (!with_tangent) return true;

  // Condense: dp = compliance^-1 (volume + coupling du).
  const Eigen::Matrix<double, pressures, pressures> inverse = compliance.inverse();
  out.pressure_gain = inverse * coupling;
  out.pressure_offset_pa = inverse * out.volume_m3;
  out.condensed_force_n = out.force_n + out.pressure_gain.transpose() * out.volume_m3;
  alignas(64) double coupled[4][dim][padded] = {}, gain[4][dim][padded] = {};
  for (int m = 0; m < pressures; ++m) {
    for (int i = 0; i < dim; ++i) {
      for (int a = 0; a < nodes; ++a) {
        coupled[m][i][a] = coupling(m, i * nodes + a);
        gain[m][i][a] = out.pressure_gain(m, i * nodes + a);
      }
    }
  }
  for (int i = 0, block = 0; i < dim; ++i) {
    for (int j = i; j < dim; ++j, ++block) {
      add(K[block], coupled[0][i], gain[0][j], coupled[1][i], gain[1][j], coupled[2][i], gain[2][j]);
      if (pressures == 4) add(K[block], coupled[3][i], gain[3][j], none, none, none, none);
    }
  }
  for (int i = 0, block = 0; i < dim; ++i) {
    for (int j = i; j < dim; ++j, ++block) {
      for (int a = 0; a < nodes; ++a) {
        for (int b = 0; b < nodes; ++b) {
          const double value = K[block][a * padded + b] + (i == j ? diagonal[a * padded + b] : 0.0);
          out.stiffness(i * nodes + a, j * nodes + b) = value;
          if (i != j) out.stiffness(j * nodes + b, i * nodes + a) = value;
        }
      }
    }
  }
  return true;
}

template class Element<2>;
template class Element<3>;

}  // namespace touchstone::reference
