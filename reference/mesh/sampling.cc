#include "reference/mesh/sampling.h"

#include "reference/discretisation/shape.h"
#include "scene/base/error.h"

#include <Eigen/LU>

#include <cmath>
#include <limits>
#include <string>

namespace touchstone::reference {
namespace {

/// Nearest place on a quadratic face, in its unit coordinates, by Gauss-Newton kept inside the face.
template <int dim>
Eigen::Matrix<double, dim - 1, 1> nearest_on_face(
    const Eigen::Matrix<double, dim, Discretisation<dim>::nodes_per_face>& X_m,
    const Eigen::Matrix<double, dim, 1>& point_m) {
  using Unit = Eigen::Matrix<double, dim - 1, 1>;
  Unit xi = Unit::Constant(0.5);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Shape<dim - 1> shape(xi);
    const Eigen::Matrix<double, dim, dim - 1> tangent = X_m * shape.gradient;
    const Eigen::Matrix<double, dim - 1, dim - 1> normal_matrix = tangent.transpose() * tangent;
    const Unit step = normal_matrix.inverse() * (tangent.transpose() * (point_m - X_m * shape.value));
    const Unit next = (xi + step).cwiseMax(0.0).cwiseMin(1.0);
    const double moved = (next - xi).norm();
    xi = next;
    if (moved < 1e-14) break;
  }
  return xi;
}

}  // namespace

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
  const double size_m = (mesh.points_m.rowwise().maxCoeff() - mesh.points_m.rowwise().minCoeff()).maxCoeff();
  const double off_surface_m = 1e-3 * size_m;

  for (Eigen::Index k = 0; k < rest_points_m.cols(); ++k) {
    const Eigen::Vector3d P = rest_points_m.col(k);
    Sample sample;
    Point folded;
    if constexpr (dim == 3) {
      sample.to_world = Eigen::Matrix3d::Identity();
      folded = P;
      if (mirror_x && P.x() < 0.0) folded.x() *= sample.to_world(0, 0) = -1.0;
      if (mirror_y && P.y() < 0.0) folded.y() *= sample.to_world(1, 1) = -1.0;
    } else {
      const double r = std::hypot(P.x(), P.y());
      folded = {r, P.z()};
      sample.to_world.setZero();
      if (r > 0.0) sample.to_world.col(0) << P.x() / r, P.y() / r, 0.0;
      sample.to_world(2, 1) = 1.0;
    }
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Candidate& candidate : candidates) {
      const Point outside = (candidate.low_m - folded).cwiseMax(folded - candidate.high_m).cwiseMax(0.0);
      if (outside.norm() >= std::min(nearest_m, off_surface_m)) continue;
      const auto xi = nearest_on_face<dim>(candidate.X_m, folded);
      const Shape<dim - 1> shape(xi);
      const double distance_m = (candidate.X_m * shape.value - folded).norm();
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

template class SurfaceSampler<2>;
template class SurfaceSampler<3>;

}  // namespace touchstone::reference
