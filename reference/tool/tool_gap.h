// The rigid tool as a gap function of a material point, with the two derivatives Newton needs.
#pragma once

#include "scene/base/frames.h"

#include <Eigen/Core>

#include <limits>
#include <memory>

namespace touchstone::reference {

/// Gap at one point: g(x + dx) = value + gradient . dx + 1/2 dx . hessian . dx + ...
template <int dim>
struct Gap {
  double value_m = std::numeric_limits<double>::infinity();  ///< negative: the point is inside the tool
  /// Out of the tool; contact pushes along it. Unit length; for a mesh tool only approximately, see distance_grid.h.
  Eigen::Matrix<double, dim, 1> gradient = Eigen::Matrix<double, dim, 1>::Zero();
  Eigen::Matrix<double, dim, dim> hessian_per_m = Eigen::Matrix<double, dim, dim>::Zero();
};

/// A rigid tool's shape: the signed distance from its surface, in the tool frame, whose origin is the mass centre.
/// Immutable; queries may run at the same time.
class ToolDistance {
 public:
  virtual ~ToolDistance() = default;
  /// Value, gradient and Hessian of one function. Outside bounds() the value may be infinite.
  [[nodiscard]] virtual Gap<3> at(const scene::Vec3& p_T_m) const = 0;
  /// Holds the tool.
  [[nodiscard]] virtual scene::Bounds bounds() const = 0;
  /// Half the tool's smallest extent: the unit of tolerances.
  [[nodiscard]] virtual double half_width_m() const = 0;
  /// Whether its surface bends at the edges of facets, on a scale that is due to its triangulation and not to its
  /// shape.
  [[nodiscard]] virtual bool faceted() const { return false; }
};

/// A tool at its place. In two dimensions the tool is a body of revolution about the z axis, and points are (r, z) in
/// its meridian plane.
template <int dim>
class RigidTool {
 public:
  using Point = Eigen::Matrix<double, dim, 1>;

  RigidTool(std::shared_ptr<const ToolDistance> distance, const scene::Pose& pose);

  /// Finite kinematics: signed distance of the deformed point x.
  [[nodiscard]] Gap<dim> gap(const Point& x_m) const;

  /// Small kinematics: distance along the body's rest normal N from the point X + u to the tool's surface above the
  /// rest place X, g = s(X) - N . u. This is the boundary condition of Hertz's and Sneddon's problems. A line that
  /// misses the tool has no gap, nor has one that meets it only behind X, within the body.
  [[nodiscard]] Gap<dim> gap_along(const Point& X_m, const Point& N, const Point& u_m) const;

  /// A point of the world as a point of the tool, and back [m].
  [[nodiscard]] scene::Vec3 in_tool_frame(const Point& x_m) const;
  [[nodiscard]] Point in_world(const scene::Vec3& p_T_m) const;

  /// Where the straight line between two points of the tool frame enters the tool. If the first point is not outside,
  /// the point of the surface nearest to the second.
  [[nodiscard]] scene::Vec3 entry_T_m(const scene::Vec3& from_T_m, const scene::Vec3& to_T_m) const;

  [[nodiscard]] const scene::Vec3& mass_center_m() const noexcept { return pose_.position_m; }
  [[nodiscard]] double half_width_m() const { return distance_->half_width_m(); }
  [[nodiscard]] bool faceted() const { return distance_->faceted(); }

 private:
  [[nodiscard]] scene::Vec3 turned_into_tool_frame(const Point& direction) const;

  std::shared_ptr<const ToolDistance> distance_;
  scene::Pose pose_;
  scene::Mat3 to_world_;
};

}  // namespace touchstone::reference
