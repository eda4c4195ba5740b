// Volume, area, surface and regularity of the meshes of round bodies.
#include "reference/round_mesh.h"

#include "reference/element.h"
#include "verification/closed_forms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
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

template <int dim>
Grading<dim> uniform(double size_m) {
  Grading<dim> grading;
  grading.largest_m = size_m;
  return grading;
}

struct Measures {
  double volume_m3 = 0.0, area_m2 = 0.0, smallest_ratio = 1.0;  ///< of det J, in a cell, to its largest
};

template <int dim>
Measures measure(const Mesh<dim>& mesh) {
  Measures sum;
  const GaussRule<dim> rule;
  for (const auto& cell : mesh.cells) {
    Eigen::Matrix<double, dim, Mesh<dim>::nodes_per_cell> X;
    for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) X.col(a) = mesh.points_m.col(cell[a]);
    double least = 1e300, most = -1e300;
    const auto determinant = [&](const Q2<dim>& shape) {
      const double det = Eigen::Matrix<double, dim, dim>(X * shape.gradient).determinant();
      least = std::min(least, det);
      most = std::max(most, det);
      return det;
    };
    for (int q = 0; q < GaussRule<dim>::size; ++q) {
      const Q2<dim> shape(rule.points[q]);
      const double around = dim == 2 ? 2.0 * std::numbers::pi * (X * shape.value)[0] : 1.0;
      sum.volume_m3 += rule.weights[q] * determinant(shape) * around;
    }
    for (int a = 0; a < Mesh<dim>::nodes_per_cell; ++a) {
      Eigen::Matrix<double, dim, 1> xi;
      for (int d = 0, index = a; d < dim; ++d, index /= 3) xi[d] = 0.5 * (index % 3);
      determinant(Q2<dim>(xi));
    }
    sum.smallest_ratio = std::min(sum.smallest_ratio, least / most);
  }
  const GaussRule<dim - 1> face_rule;
  for (const auto& face : mesh.faces) {
    if (face.boundary != Boundary::free && face.boundary != Boundary::held) continue;
    Eigen::Matrix<double, dim, Mesh<dim>::nodes_per_face> X;
    for (int a = 0; a < Mesh<dim>::nodes_per_face; ++a) X.col(a) = mesh.points_m.col(face.nodes[a]);
    for (int q = 0; q < GaussRule<dim - 1>::size; ++q) {
      const Q2<dim - 1> shape(face_rule.points[q]);
      const Eigen::Matrix<double, dim, dim - 1> tangents = X * shape.gradient;
      const double stretch = std::sqrt((tangents.transpose() * tangents).determinant());
      const double around = dim == 2 ? 2.0 * std::numbers::pi * (X * shape.value)[0] : 1.0;
      sum.area_m2 += face_rule.weights[q] * stretch * around;
    }
  }
  return sum;
}

template <int dim>
void expect_good(const Named& named, double size_m, double smallest_ratio) {
  SCOPED_TRACE(named.name);
  RoundSpec spec = round_spec(named.body);
  spec.symmetric_x = spec.symmetric_y = dim == 3;
  ASSERT_EQ(round_fault(spec), "");
  const auto shape = scene::body_shape(named.body);
  const double images = dim == 3 ? 4.0 : 1.0;
  double volume_error[2], area_error[2];
  for (const int k : {0, 1}) {
    const Mesh<dim> mesh = round_mesh<dim>(spec, uniform<dim>(size_m / (k + 1)));
    const Measures seen = measure(mesh);
    volume_error[k] = std::abs(images * seen.volume_m3 / shape->volume_m3() - 1.0);
    area_error[k] = std::abs(images * seen.area_m2 / shape->area_m2() - 1.0);
    EXPECT_GT(seen.smallest_ratio, smallest_ratio);
    printf("%s %d %d cells %d ratio %.3f volume %.2e area %.2e hang %zu\n", named.name, dim, k, mesh.cell_count(), seen.smallest_ratio, volume_error[k], area_error[k], mesh.hanging.size());
  }
}

TEST(RoundMesh, A) {
  for (const Named& named : bodies()) {
    if (named.body.shape != scene::BodyShape::ellipsoid || named.body.semi_axes_m.x() == named.body.semi_axes_m.y())
      expect_good<2>(named, 0.008, 0.0);
    expect_good<3>(named, 0.012, 0.0);
  }
}

}  // namespace
}  // namespace touchstone::reference
