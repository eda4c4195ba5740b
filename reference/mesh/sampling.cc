#include "reference/mesh/sampling.h"

#include "reference/discretisation/shape.h"
#include "scene/base/error.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace touchstone::reference {
namespace {

/// Nearest place of a quadratic cell, or of one of its faces, in unit coordinates, by Gauss-Newton kept inside.
/// @tparam unit  dimension of what the nodes belong to
template <int unit, int dim>
Eigen::Matrix<double, unit, 1> nearest_in(const Eigen::Matrix<double, dim, Shape<unit>::size>& X_m,
                                          const Eigen::Matrix<double, dim, 1>& point_m) {
  using Unit = Eigen::Matrix<double, unit, 1>;
  Unit xi = Unit::Constant(0.5);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Shape<unit> shape(xi);
    const Eigen::Matrix<double, dim, unit> tangent = X_m * shape.gradient;
    const Eigen::Matrix<double, unit, unit> normal_matrix = tangent.transpose() * tangent;
    const Unit step = normal_matrix.inverse() * (tangent.transpose() * (point_m - X_m * shape.value));
    const Unit next = (xi + step).cwiseMax(0.0).cwiseMin(1.0);
    const double moved = (next - xi).norm();
    xi = next;
    if (moved < 1e-14) break;
  }
  return xi;
}

template <int dim>
double size_m(const Discretisation<dim>& mesh) {
  return (mesh.points_m.rowwise().maxCoeff() - mesh.points_m.rowwise().minCoeff()).maxCoeff();
}

/// How far from the body a point may be, of the body's size: curved surfaces are quadratic.
constexpr double off_body_share = 1e-3;

}  // namespace

template <int dim>
Folded<dim> folded(const Eigen::Vector3d& point_m, bool mirror_x, bool mirror_y) {
  Folded<dim> result;
  if constexpr (dim == 3) {
    result.to_world.setIdentity();
    if (mirror_x && point_m.x() < 0.0) result.to_world(0, 0) = -1.0;
    if (mirror_y && point_m.y() < 0.0) result.to_world(1, 1) = -1.0;
    result.point_m = result.to_world * point_m;
  } else {
    const double r_m = std::hypot(point_m.x(), point_m.y());
    const Eigen::Vector3d outward =
        r_m > 0.0 ? Eigen::Vector3d(point_m.x() / r_m, point_m.y() / r_m, 0.0) : Eigen::Vector3d::UnitX();
    result.point_m = {r_m, point_m.z()};
    result.to_world << outward, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ().cross(outward);
  }
  return result;
}

template <int dim>
SurfaceSampler<dim>::SurfaceSampler(const Discretisation<dim>& mesh, const Eigen::Matrix3Xd& rest_points_m,
                                    bool mirror_x, bool mirror_y) {
  using Point = Eigen::Matrix<double, dim, 1>;
  struct Candidate {
    const typename Discretisation<dim>::Face* face;
    Eigen::Matrix<double, dim, Discretisation<dim>::nodes_per_face> X_m;
    Point low_m, high_m;
  };
  std::vector<Candidate> candidates;
  for (const auto& face : mesh.faces) {
    if (face.boundary != Boundary::free && face.boundary != Boundary::held) continue;
    Candidate candidate{&face, {}, {}, {}};
    for (int a = 0; a < Discretisation<dim>::nodes_per_face; ++a)
      candidate.X_m.col(a) = mesh.points_m.col(face.nodes[a]);
    candidate.low_m = candidate.X_m.rowwise().minCoeff();
    candidate.high_m = candidate.X_m.rowwise().maxCoeff();
    candidates.push_back(candidate);
  }
  const double off_surface_m = off_body_share * size_m(mesh);

  for (Eigen::Index k = 0; k < rest_points_m.cols(); ++k) {
    const Folded<dim> at = folded<dim>(rest_points_m.col(k), mirror_x, mirror_y);
    Sample sample;
    sample.to_world = at.to_world.template leftCols<dim>();
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : candidates) {
      const Point outside = (candidate.low_m - at.point_m).cwiseMax(at.point_m - candidate.high_m).cwiseMax(0.0);
      if (outside.norm() >= std::min(nearest_m, off_surface_m)) continue;
      const auto xi = nearest_in<dim - 1, dim>(candidate.X_m, at.point_m);
      const Shape<dim - 1> shape(xi);
      const double distance_m = (candidate.X_m * shape.value - at.point_m).norm();
      if (distance_m >= nearest_m) continue;
      nearest_m = distance_m;
      sample.nodes = candidate.face->nodes;
      sample.weights = shape.value;
    }
    if (nearest_m > off_surface_m) {
      throw scene::InputError("rest point " + std::to_string(k) + " is not on the body's rest surface");
    }
    samples_.push_back(sample);
  }
}

template <int dim>
Eigen::Matrix3Xd SurfaceSampler<dim>::at_points(const Eigen::Matrix<double, dim, Eigen::Dynamic>& nodal) const {
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    Eigen::Matrix<double, dim, 1> v = Eigen::Matrix<double, dim, 1>::Zero();
    for (int a = 0; a < Discretisation<dim>::nodes_per_face; ++a)
      v += samples_[k].weights[a] * nodal.col(samples_[k].nodes[a]);
    result.col(static_cast<Eigen::Index>(k)) = samples_[k].to_world * v;
  }
  return result;
}

template <int dim>
BodySampler<dim>::BodySampler(const Discretisation<dim>& mesh, const Eigen::Matrix3Xd& points_m, bool mirror_x,
                              bool mirror_y)
    : mesh_(mesh) {
  using Point = typename Discretisation<dim>::Point;
  constexpr int count = Discretisation<dim>::nodes_per_cell;
  const double off_body_m = off_body_share * size_m(mesh), same_m = 1e-9 * size_m(mesh);
  std::vector<Folded<dim>> at;
  std::vector<double> nearest_m(static_cast<std::size_t>(points_m.cols()), off_body_m);
  for (const auto& point_m : points_m.colwise()) at.push_back(folded<dim>(point_m, mirror_x, mirror_y));
  samples_.resize(at.size());
  for (int cell = 0; cell < mesh.cell_count(); ++cell) {
    const Eigen::Matrix<double, dim, count> X_m = mesh.points_m(Eigen::all, mesh.cells[cell]);
    const Point low_m = X_m.rowwise().minCoeff(), high_m = X_m.rowwise().maxCoeff();
    for (std::size_t k = 0; k < at.size(); ++k) {
      const Point& point_m = at[k].point_m;
      const double outside_m = (low_m - point_m).cwiseMax(point_m - high_m).cwiseMax(0.0).norm();
      if (outside_m > nearest_m[k] + same_m) continue;
      const Shape<dim> shape(nearest_in<dim, dim>(X_m, point_m));
      const double distance_m = (X_m * shape.value - point_m).norm();
      if (distance_m > nearest_m[k] + same_m) continue;
      if (distance_m < nearest_m[k] - same_m) samples_[k].cells.clear();
      nearest_m[k] = std::min(nearest_m[k], distance_m);
      samples_[k].cells.push_back({cell, shape.value});
    }
  }
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (samples_[k].cells.empty()) throw scene::InputError("point " + std::to_string(k) + " is not in the body");
    samples_[k].to_world = at[k].to_world;
    for (InCell& one : samples_[k].cells) one.weights /= static_cast<double>(samples_[k].cells.size());
  }
}

template <int dim>
Eigen::Matrix3Xd BodySampler<dim>::vectors(const Eigen::Matrix<double, dim, Eigen::Dynamic>& nodal) const {
  Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    for (const InCell& one : samples_[k].cells) {
      result.col(static_cast<Eigen::Index>(k)) +=
          samples_[k].to_world.template leftCols<dim>() * (nodal(Eigen::all, mesh_.cells[one.cell]) * one.weights);
    }
  }
  return result;
}

template <int dim>
Eigen::RowVectorXd BodySampler<dim>::numbers(const Eigen::RowVectorXd& values) const {
  constexpr int count = Discretisation<dim>::nodes_per_cell;
  Eigen::RowVectorXd result = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    for (const InCell& one : samples_[k].cells) {
      result[static_cast<Eigen::Index>(k)] +=
          values.template segment<count>(Eigen::Index{count} * one.cell).dot(one.weights);
    }
  }
  return result;
}

template <int dim>
Eigen::Matrix<double, 9, Eigen::Dynamic> BodySampler<dim>::tensors(
    const Eigen::Matrix<double, 9, Eigen::Dynamic>& values) const {
  constexpr int count = Discretisation<dim>::nodes_per_cell;
  Eigen::Matrix<double, 9, Eigen::Dynamic> result(9, static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    Eigen::Matrix<double, 9, 1> in_mesh = Eigen::Matrix<double, 9, 1>::Zero();
    for (const InCell& one : samples_[k].cells) {
      in_mesh += values.template middleCols<count>(Eigen::Index{count} * one.cell) * one.weights;
    }
    const Eigen::Matrix3d& turn = samples_[k].to_world;
    const Eigen::Matrix3d in_world = turn * in_mesh.template reshaped<Eigen::ColMajor>(3, 3) * turn.transpose();
    result.col(static_cast<Eigen::Index>(k)) = in_world.reshaped();
  }
  return result;
}

template Folded<2> folded(const Eigen::Vector3d&, bool, bool);
template Folded<3> folded(const Eigen::Vector3d&, bool, bool);
template class SurfaceSampler<2>;
template class SurfaceSampler<3>;
template class BodySampler<2>;
template class BodySampler<3>;

}  // namespace touchstone::reference
