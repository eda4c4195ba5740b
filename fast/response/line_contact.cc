#include "fast/response/line_contact.h"

#include <Eigen/Core>

#include <cmath>
#include <cstdlib>
#include <numbers>

namespace touchstone::fast {
namespace {

constexpr int across = line_cells_across, along = line_cells_along;

/// Displacement at (x, y) by unit pressure on a rectangle of these half sides about the origin, times pi E*.
double love_m(double x_m, double y_m, double half_x_m, double half_y_m) {
  const auto corner = [](double x, double y) {
    return (y == 0.0 ? 0.0 : y * std::asinh(x / std::abs(y))) + (x == 0.0 ? 0.0 : x * std::asinh(y / std::abs(x)));
  };
  return corner(x_m + half_x_m, y_m + half_y_m) - corner(x_m - half_x_m, y_m + half_y_m) -
         corner(x_m + half_x_m, y_m - half_y_m) + corner(x_m - half_x_m, y_m - half_y_m);
}

/// Of all cells of a quarter on each other, with their mirror images; along is the fastest.
Eigen::MatrixXd influence_m_per_pa(double dx_m, double dy_m, double E_star_pa) {
  Eigen::MatrixXd apart(2 * across, 2 * along);  // by the distance in cells
  for (int i = 0; i < 2 * across; ++i) {
    for (int j = 0; j < 2 * along; ++j) {
      apart(i, j) = love_m(i * dx_m, j * dy_m, 0.5 * dx_m, 0.5 * dy_m) / (std::numbers::pi * E_star_pa);
    }
  }
  Eigen::MatrixXd out(across * along, across * along);
  for (int k = 0; k < across * along; ++k) {
    for (int m = 0; m < across * along; ++m) {
      const int i = k / along, j = k % along, p = m / along, q = m % along;
      out(m, k) = apart(std::abs(i - p), std::abs(j - q)) + apart(i + p + 1, std::abs(j - q)) +
                  apart(std::abs(i - p), j + q + 1) + apart(i + p + 1, j + q + 1);
    }
  }
  return out;
}

}  // namespace

LineContact line_contact(double radius_m, double half_line_m, double indentation_m, double E_star_pa) {
  const double R = radius_m, D = indentation_m;
  const double wide_m = std::sqrt(D * (2.0 * R - D)), dx_m = wide_m / across, dy_m = (half_line_m + wide_m) / along;
  const Eigen::MatrixXd A = influence_m_per_pa(dx_m, dy_m, E_star_pa);
  const Eigen::Index count = A.rows();
  Eigen::VectorXd below_m(count);  // the tool's surface at rest under the half space's
  for (int k = 0; k < across * along; ++k) {
    const int row = k / along, column = k % along;
    const double r_m = std::hypot((row + 0.5) * dx_m, std::max(0.0, (column + 0.5) * dy_m - half_line_m));
    below_m[k] = r_m < R ? D - r_m * r_m / (R + std::sqrt(R * R - r_m * r_m)) : -INFINITY;
  }
  Eigen::VectorXd p_pa = (below_m.array() > 0.0).select(Eigen::VectorXd::Constant(count, E_star_pa * D / (R + D)), 0.0);
  Eigen::VectorXd way = Eigen::VectorXd::Zero(count);
  double last = 1.0;
  bool keep = false;
  for (int iteration = 0; iteration < 500; ++iteration) {
    const Eigen::VectorXd apart_m = A * p_pa - below_m;
    const auto pressed = (p_pa.array() > 0.0).cast<double>().matrix().eval();
    const Eigen::VectorXd open_m = (pressed.array() > 0.0).select(apart_m, 0.0);
    const double now = open_m.squaredNorm();
    way = open_m + (keep ? now / last : 0.0) * pressed.cwiseProduct(way);
    last = now;
    const double share = open_m.dot(way) / way.dot(A * way);
    if (!std::isfinite(share)) break;
    p_pa = (p_pa - share * way).cwiseMax(0.0);
    // Cells without pressure that the tool would enter press from now on.
    keep = true;
    for (Eigen::Index k = 0; k < count; ++k) {
      if (p_pa[k] > 0.0 || !(apart_m[k] < 0.0)) continue;
      p_pa[k] = -share * apart_m[k];
      keep = false;
    }
    if (keep && std::abs(share) * way.lpNorm<1>() < 1e-9 * p_pa.sum()) break;
  }
  LineContact out;
  for (int k = 0; k < across * along; ++k) out.pressure_rel.push_back(static_cast<float>(p_pa[k] / p_pa.mean()));
  double middle = 0.0, middle2_m2 = 0.0;
  for (int k = 0; k < across * along; ++k) {
    const int row = k / along, column = k % along;
    const double x_m = (row + 0.5) * dx_m, y_m = (column + 0.5) * dy_m;
    const double x2_m2 = x_m * x_m + dx_m * dx_m / 12.0, y2_m2 = y_m * y_m + dy_m * dy_m / 12.0;
    out.across2_m2 += p_pa[k] * x2_m2 / p_pa.sum();
    out.along2_m2 += p_pa[k] * y2_m2 / p_pa.sum();
    if (k % along > 0) continue;
    middle += p_pa[k];
    middle2_m2 += p_pa[k] * x2_m2;
  }
  out.force_n = 4.0 * dx_m * dy_m * p_pa.sum();
  out.half_width_m = 2.0 * std::sqrt(middle2_m2 / middle);  // of a pressure as (1 - x^2)^(1/2)
  return out;
}

}  // namespace touchstone::fast
