// The meshes of round bodies: right in size, closed, on the surface, regular.
#include "reference/mesh/round_mesh.h"

#include "reference/discretisation/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace touchstone::reference {
namespace {

struct Named {
  const char* name;
  scene::Body body;
};

scene::Body round_body(scene::BodyShape shape) {
  scene::Body body;
  body.shape = shape;
  body.support_height_m = 0.005;
  return body;
}

std::vector<Named> bodies() {
  std::vector<Named> all;
  scene::Body body = round_body(scene::BodyShape::sphere);
  body.radius_m = 0.03;
  all.push_back({"sphere", body});
  body.support_height_m = 0.025;
  all.push_back({"sphere held high", body});
  body = round_body(scene::BodyShape::ellipsoid);
  body.semi_axes_m = {0.040, 0.030, 0.025};
  all.push_back({"ellipsoid", body});
  body.semi_axes_m = {0.020, 0.020, 0.060};
  all.push_back({"spheroid", body});
  body.semi_axes_m = {0.060, 0.030, 0.020};
  all.push_back({"slender ellipsoid", body});
  body = round_body(scene::BodyShape::revolution);
  body.profile = {{{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}, {0.0, 0.04}}, {}};
  all.push_back({"cylinder", body});
  body.profile = scene::cylinder_profile(0.03, 0.02, 0.004);
  all.push_back({"filleted disc", body});
  body.profile = scene::capsule_profile(0.02, 0.05);
  all.push_back({"capsule", body});
  body.profile = {{{0.0, 0.0}, {0.03, 0.0}, {0.02, 0.04}, {0.0, 0.04}}, {}};
  all.push_back({"frustum", body});
  body.profile = {{{0.0, 0.0}, {0.03, 0.0}, {0.0, 0.05}}, {}};
  all.push_back({"cone", body});
  body.profile = {{{0.0, 0.0}, {0.02, 0.0}, {0.02, 0.05}, {0.0, 0.05}}, {0.0, 0.04, 0.0}};
  all.push_back({"barrel", body});
  body.profile = {{{0.0, 0.0}, {0.03, 0.015}, {0.0, 0.03}}, {0.04, 0.04}};
  all.push_back({"lens", body});
  return all;
}

/// Cells of one size but for smaller ones at the top, so that some nodes hang.
template <int dim>
Grading<dim> graded(const scene::Body& body, double size_m) {
  const scene::Vec3 top_m = scene::body_shape(body)->bounds().upper_m.cwiseProduct(scene::Vec3::UnitZ());
  Grading<dim> grading;
  grading.largest_m = size_m;
  grading.discs.push_back({top_m.tail<dim>(), Eigen::Matrix<double, dim, 1>::Unit(dim - 1), 0.0, 0.3 * size_m});
  return grading;
}

struct Measures {
  double volume_m3 = 0.0, area_m2 = 0.0;
  double enclosed_m3 = 0.0;     ///< the volume again, from the surface
  double smallest_ratio = 1.0;  ///< of a cell's least to its largest det J, over Gauss points and nodes
};

template <int dim>
double ring_m(double r_m) {
  return dim == 2 ? 2.0 * std::numbers::pi * r_m : 1.0;
}

template <int dim>
Measures measure(const Discretisation<dim>& mesh) {
  using Point = Eigen::Matrix<double, dim, 1>;
  Measures sum;
  const std::vector<CellGeometry<dim>> geometry = mesh.cell_geometry();
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const Eigen::Matrix<double, dim, Discretisation<dim>::nodes_per_cell> X = mesh.points_m(Eigen::all, mesh.cells[c]);
    double least = std::numeric_limits<double>::infinity(), most = -least;
    const auto determinant = [&](const Shape<dim>& shape) {
      const double det = Eigen::Matrix<double, dim, dim>(X * shape.gradient).determinant();
      least = std::min(least, det);
      most = std::max(most, det);
      return det;
    };
    for (int q = 0; q < CellGeometry<dim>::points; ++q) {
      const GaussPoint<dim>& point = gauss_points<dim>()[q];
      const double det = determinant(point.shape), weight = geometry[c].weight[q];
      EXPECT_NEAR(weight / (point.weight * det), 1.0, 1e-10);
      sum.volume_m3 += weight * ring_m<dim>(geometry[c].place_m[q][0]);
    }
    for (int a = 0; a < Discretisation<dim>::nodes_per_cell; ++a) {
      Point xi;
      for (int d = 0, index = a; d < dim; ++d, index /= 3) xi[d] = 0.5 * (index % 3);
      determinant(Shape<dim>(xi));
    }
    sum.smallest_ratio = std::min(sum.smallest_ratio, least / most);
  }
  const Point inside_m = mesh.points_m.rowwise().mean();
  for (const auto& face : mesh.faces) {
    if (face.boundary != Boundary::free && face.boundary != Boundary::held) continue;
    Eigen::Matrix<double, dim, Discretisation<dim>::nodes_per_face> X;
    for (int a = 0; a < Discretisation<dim>::nodes_per_face; ++a) X.col(a) = mesh.points_m.col(face.nodes[a]);
    for (const auto& [xi, xi_weight, shape] : gauss_points<dim - 1>()) {
      const Eigen::Matrix<double, dim, dim - 1> tangents = X * shape.gradient;
      const Point place_m = X * shape.value;
      Point normal;  // its length is the area
      if constexpr (dim == 3) {
        normal = Eigen::Vector3d(tangents.col(0)).cross(Eigen::Vector3d(tangents.col(1)));
      } else {
        normal = {tangents(1), -tangents(0)};
      }
      if (normal.dot(place_m - inside_m) < 0.0) normal *= -1.0;
      const double weight = xi_weight * ring_m<dim>(place_m[0]);
      sum.area_m2 += weight * normal.norm();
      sum.enclosed_m3 += weight * normal.dot(place_m) / 3.0;
    }
  }
  return sum;
}

template <int dim>
RoundSpec quarter_spec(const scene::Body& body) {
  RoundSpec spec = round_spec(body);
  spec.symmetric_x = spec.symmetric_y = dim == 3;
  return spec;
}

template <int dim>
std::vector<Named> bodies_in() {
  std::vector<Named> all = bodies();
  if (dim == 2) {
    std::erase_if(all, [](const Named& named) { return round_spec(named.body).stretch != Eigen::Vector2d::Ones(); });
  }
  return all;
}

/// Quadratic cells have volume and area right to the fourth order; the tip of a cone, of one cell, keeps its area to
/// the second only. The cell's size is taken from their number.
template <int dim>
void expect_volume_and_area() {
  const double images = dim == 3 ? 4.0 : 1.0;
  for (const Named& named : bodies_in<dim>()) {
    SCOPED_TRACE(named.name);
    const RoundSpec spec = quarter_spec<dim>(named.body);
    ASSERT_EQ(round_fault(spec), "");
    const auto shape = scene::body_shape(named.body);
    const bool pointed = std::string(named.name) == "cone";
    double error[2], size[2];
    for (const int k : {0, 1}) {
      Grading<dim> grading;
      grading.largest_m = (dim == 2 ? 0.012 : 0.016) / (k == 0 ? 1.0 : 4.0);
      const Discretisation<dim> mesh = round_mesh<dim>(spec, grading);
      const Measures seen = measure(mesh);
      error[k] = std::abs(images * seen.volume_m3 / shape->volume_m3() - 1.0) +
                 (pointed ? 0.0 : std::abs(images * seen.area_m2 / shape->area_m2() - 1.0));
      size[k] = std::pow(mesh.cell_count(), -1.0 / dim);
      EXPECT_NEAR(seen.area_m2 * images / shape->area_m2(), 1.0, 3e-3);
      EXPECT_NEAR(seen.enclosed_m3 / seen.volume_m3, 1.0, 1e-12);
      EXPECT_GT(seen.smallest_ratio, 0.02);
    }
    EXPECT_LT(error[0], 5e-3);
    if (error[0] > 1e-12) {
      EXPECT_GT(std::log(error[0] / error[1]) / std::log(size[0] / size[1]), 3.3) << error[0] << " " << error[1];
    }
  }
}

TEST(RoundMesh, VolumeAndAreaConverge) {
  expect_volume_and_area<2>();
  expect_volume_and_area<3>();
}

template <int dim>
void expect_surface() {
  for (const Named& named : bodies_in<dim>()) {
    SCOPED_TRACE(named.name);
    const RoundSpec spec = quarter_spec<dim>(named.body);
    const Discretisation<dim> mesh = round_mesh<dim>(spec, graded<dim>(named.body, 0.012));
    EXPECT_GT(mesh.hanging_count(), 0);
    const auto shape = scene::body_shape(named.body);
    const double size_m = shape->bounds().upper_m.maxCoeff();
    const double held_m = named.body.flat_bottom() ? 0.0 : named.body.support_height_m;
    double lowest_free_m = size_m, highest_held_m = 0.0;
    for (const auto& face : mesh.faces) {
      for (const int node : face.nodes) {
        const Eigen::Matrix<double, dim, 1> x_m = mesh.points_m.col(node);
        if (face.boundary == Boundary::plane_x || face.boundary == Boundary::plane_y) {
          EXPECT_EQ(x_m[face.boundary == Boundary::plane_x ? 0 : 1], 0.0);
          continue;
        }
        if (mesh.hangs(node)) continue;
        const scene::Vec3 place_m(x_m[0], dim == 3 ? x_m[1] : 0.0, x_m[dim - 1]);
        EXPECT_NEAR(shape->signed_distance_m(place_m), 0.0, 1e-12 * size_m);
        if (face.boundary == Boundary::free) lowest_free_m = std::min(lowest_free_m, x_m[dim - 1]);
        if (face.boundary == Boundary::held) highest_held_m = std::max(highest_held_m, x_m[dim - 1]);
      }
    }
    EXPECT_NEAR(lowest_free_m, held_m, 1e-12 * size_m);
    EXPECT_NEAR(highest_held_m, held_m, 1e-12 * size_m);
  }
}

TEST(RoundMesh, NodesLieOnTheSurfaceAndTheSupportEndsAtItsHeight) {
  expect_surface<2>();
  expect_surface<3>();
}

TEST(RoundMesh, QuarterHalfAndWholeAreTheSame) {
  const scene::Body body = bodies()[2].body;
  RoundSpec spec = round_spec(body);
  Grading<3> grading;
  grading.largest_m = 0.012;
  const Measures whole = measure(round_mesh<3>(spec, grading));
  for (const bool y : {false, true}) {
    spec.symmetric_x = true;
    spec.symmetric_y = y;
    const Measures part = measure(round_mesh<3>(spec, grading));
    EXPECT_NEAR(part.volume_m3 * (y ? 4.0 : 2.0) / whole.volume_m3, 1.0, 1e-13);
    EXPECT_NEAR(part.area_m2 * (y ? 4.0 : 2.0) / whole.area_m2, 1.0, 1e-13);
  }
}

TEST(RoundMesh, RefusesSlivers) {
  scene::Body body = bodies()[0].body;
  body.support_height_m = 1e-6;
  EXPECT_NE(round_fault(round_spec(body)), "");
  body.support_height_m = 0.059;
  EXPECT_NE(round_fault(round_spec(body)), "");
  body = bodies()[5].body;
  body.profile.rz_m.insert(body.profile.rz_m.begin() + 2, {0.0300001, 0.0001});
  EXPECT_NE(round_fault(round_spec(body)), "");
}

}  // namespace
}  // namespace touchstone::reference
