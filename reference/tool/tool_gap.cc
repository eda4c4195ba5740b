#include "reference/tool/tool_gap.h"

#include "scene/base/in_space.h"

#include <algorithm>
#include <cmath>

namespace touchstone::reference {
namespace {

using scene::Vec3;

/// First intersection of the line p + s direction with the surface, coming from s = -infinity; infinite if there is
/// none.
double first_hit_m(const ToolDistance& distance, const Vec3& p_m, const Vec3& direction) {
  const scene::Bounds bounds = distance.bounds();
  double s_m = -std::numeric_limits<double>::infinity(), end_m = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double below_m = bounds.lower_m[axis] - p_m[axis], above_m = bounds.upper_m[axis] - p_m[axis];
    if (direction[axis] == 0.0) {
      if (below_m > 0.0 || above_m < 0.0) return std::numeric_limits<double>::infinity();
      continue;
    }
    const double one_m = below_m / direction[axis], other_m = above_m / direction[axis];
    s_m = std::max(s_m, std::min(one_m, other_m));
    end_m = std::min(end_m, std::max(one_m, other_m));
  }
  // Sphere tracing: a step of the distance never passes the surface. Close to it Newton's step is as safe and much
  // longer.
  const double close_m = 1e-2 * distance.half_width_m(), there_m = 1e-13 * distance.half_width_m();
  for (int step = 0; step < 500 && s_m <= end_m; ++step) {
    const Gap<3> here = distance.at(p_m + s_m * direction);
    if (std::abs(here.value_m) <= there_m) return s_m;
    const double slope = here.gradient.dot(direction);
    s_m += here.value_m < close_m && slope < -0.05 ? -here.value_m / slope : here.value_m;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

template <int dim>
RigidTool<dim>::RigidTool(std::shared_ptr<const ToolDistance> distance, const scene::Pose& pose)
    : distance_(std::move(distance)), pose_(pose), to_world_(pose.orientation.toRotationMatrix()) {}

template <int dim>
Vec3 RigidTool<dim>::in_tool_frame(const Point& x_m) const {
  return to_world_.transpose() * (scene::in_space<dim>(x_m) - pose_.position_m);
}

template <int dim>
Vec3 RigidTool<dim>::turned_into_tool_frame(const Point& direction) const {
  return to_world_.transpose() * scene::in_space<dim>(direction);
}

template <int dim>
typename RigidTool<dim>::Point RigidTool<dim>::in_world(const Vec3& p_T_m) const {
  Vec3 x_m = to_world_ * p_T_m + pose_.position_m;
  if constexpr (dim == 3) {
    return x_m;
  } else {
    return {x_m.x(), x_m.z()};
  }
}

template <int dim>
Vec3 RigidTool<dim>::entry_T_m(const Vec3& from_T_m, const Vec3& to_T_m) const {
  Vec3 outside_m = from_T_m, inside_m = to_T_m, entry_m = to_T_m;
  if (from_T_m.allFinite() && distance_->at(from_T_m).value_m > 0.0) {
    for (int halving = 0; halving < 50; ++halving) {
      entry_m = 0.5 * (outside_m + inside_m);
      (distance_->at(entry_m).value_m > 0.0 ? outside_m : inside_m) = entry_m;
    }
  }
  for (int step = 0; step < 4; ++step) {
    const Gap<3> here = distance_->at(entry_m);
    entry_m -= here.value_m / here.gradient.squaredNorm() * here.gradient;
  }
  return entry_m;
}

template <int dim>
Gap<dim> RigidTool<dim>::gap(const Point& x_m) const {
  const Gap<3> in_tool = distance_->at(in_tool_frame(x_m));
  Eigen::Matrix<double, 3, dim> to_tool;
  for (int i = 0; i < dim; ++i) to_tool.col(i) = turned_into_tool_frame(Point::Unit(i));
  return {in_tool.value_m, to_tool.transpose() * in_tool.gradient,
          to_tool.transpose() * in_tool.hessian_per_m * to_tool};
}

template <int dim>
Gap<dim> RigidTool<dim>::gap_along(const Point& X_m, const Point& N, const Point& u_m) const {
  Gap<dim> g;
  const Vec3 X_T_m = in_tool_frame(X_m);
  double along_m = first_hit_m(*distance_, X_T_m, turned_into_tool_frame(N));
  // If the tool lies behind the point without containing it, the line meets the tool through the body, from another
  // side; this does not count.
  if (along_m < 0.0 && distance_->at(X_T_m).value_m > 0.0) along_m = std::numeric_limits<double>::infinity();
  g.value_m = along_m - N.dot(u_m);
  g.gradient = -N;
  return g;
}

template class RigidTool<2>;
template class RigidTool<3>;

}  // namespace touchstone::reference
