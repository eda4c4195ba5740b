// The rigid tool as a gap function of a material point, with the two derivatives Newton needs.
#pragma once

#include <Eigen/Core>

#include <cmath>
#include <limits>

namespace touchstone::reference {

/// Gap at one point: g(x + dx) = value + gradient . dx + 1/2 dx . hessian . dx + ...
template <int dim>
struct Gap {
  double value_m = std::numeric_limits<double>::infinity();  ///< negative: the point is inside the tool
  Eigen::Matrix<double, dim, 1> gradient;                    ///< unit length, out of the tool; contact pushes along it
  Eigen::Matrix<double, dim, dim> hessian_per_m;
};

/// Rigid ball. In two dimensions its centre is on the axis, and the same formulas hold in the meridian plane.
template <int dim>
struct BallTool {
  using Point = Eigen::Matrix<double, dim, 1>;
  double radius_m = 0.0;
  Point center_m = Point::Zero();

  /// Finite kinematics: signed distance of the deformed point x.
  [[nodiscard]] Gap<dim> gap(const Point& x_m) const {
    const Point from_center = x_m - center_m;
    const double distance_m = from_center.norm();
    Gap<dim> g;
    g.value_m = distance_m - radius_m;
    // At the very centre every direction is as good; the tool's lowest point is below it.
    g.gradient = distance_m > 0.0 ? Point(from_center / distance_m) : Point(-Point::Unit(dim - 1));
    g.hessian_per_m = (Eigen::Matrix<double, dim, dim>::Identity() - g.gradient * g.gradient.transpose()) /
                      std::max(distance_m, 1e-3 * radius_m);
    return g;
  }

  /// Small kinematics: distance along the body's rest normal N from the point X + u to the ball's surface above the
  /// rest place X, g = s(X) - N . u. This is the boundary condition of Hertz's and Sneddon's problems.
  [[nodiscard]] Gap<dim> gap_along(const Point& X_m, const Point& N, const Point& u_m) const {
    const Point to_center = center_m - X_m;
    const double height_m = to_center.dot(N);
    const double aside2_m2 = (to_center - height_m * N).squaredNorm();
    Gap<dim> g;
    g.gradient = -N;
    g.hessian_per_m.setZero();
    if (aside2_m2 < radius_m * radius_m) {
      g.value_m = height_m - std::sqrt(radius_m * radius_m - aside2_m2) - u_m.dot(N);
    }
    return g;
  }
};

}  // namespace touchstone::reference
