// A mesh's boundary as triangles: the whole body's, at the right places, with the quadratic field on it.
#include "reference/mesh/boundary_surface.h"

#include "reference/mesh/round_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace touchstone::reference {
namespace {

/// Mirrors in x = 0 and y = 0 to itself, and turns about the z axis.
scene::Vec3 field_m(const scene::Vec3& p_m) {
  return {3.0 * p_m.x() * p_m.z(), 3.0 * p_m.y() * p_m.z(), p_m.squaredNorm() - 2.0 * p_m.z()};
}

template <int dim>
Eigen::Matrix<double, dim, Eigen::Dynamic> nodal_field_m(const Discretisation<dim>& mesh) {
  Eigen::Matrix<double, dim, Eigen::Dynamic> u_m(dim, mesh.node_count());
  for (int i = 0; i < mesh.node_count(); ++i) {
    const Eigen::Matrix<double, dim, 1> at_m = mesh.points_m.col(i);
    const scene::Vec3 u =
        field_m(dim == 3 ? scene::Vec3(at_m.x(), at_m.y(), at_m[dim - 1]) : scene::Vec3(at_m.x(), 0.0, at_m[dim - 1]));
    u_m.col(i).template head<dim - 1>() = u.head<dim - 1>();
    u_m(dim - 1, i) = u.z();
  }
  return u_m;
}

double area_m2(const scene::Surface& surface) {
  double sum = 0.0;
  for (const auto& [a, b, c] : surface.triangles) {
    const scene::Vec3 side_m = surface.points_m.col(b) - surface.points_m.col(a);
    sum += 0.5 * side_m.cross(surface.points_m.col(c) - surface.points_m.col(a)).norm();
  }
  return sum;
}

/// Largest difference to the field, over nodes only or over all points.
double off_field_m(const BoundarySurface& surface, bool nodes_only) {
  double found_m = 0.0;
  for (Eigen::Index i = 0; i < surface.rest.points_m.cols(); ++i) {
    if (nodes_only && !surface.is_node[static_cast<std::size_t>(i)]) continue;
    found_m = std::max(found_m, (surface.displacement_m.col(i) - field_m(surface.rest.points_m.col(i))).norm());
  }
  return found_m;
}

TEST(BoundarySurface, OfABlockIsWholeAndItsFieldExact) {
  for (const auto& [mirror_x, mirror_y] : {std::pair{false, false}, {true, false}, {true, true}}) {
    BlockSpec spec;
    spec.lower_m = {mirror_x ? 0.0 : -0.03, mirror_y ? 0.0 : -0.02, 0.0};
    spec.upper_m = {0.03, 0.02, 0.05};
    spec.symmetric_x = mirror_x;
    spec.symmetric_y = mirror_y;
    spec.grading.largest_m = 0.02;
    spec.grading.discs.push_back({{0.0, 0.0, 0.05}, {0.0, 0.0, 1.0}, 0.004, 0.004});
    const Discretisation<3> mesh = block_mesh(spec);
    ASSERT_GT(mesh.hanging_count(), 0);
    const BoundarySurface surface =
        boundary_surface<3>(mesh, nodal_field_m(mesh), nodal_field_m(mesh), mirror_x, mirror_y);
    EXPECT_NEAR(area_m2(surface.rest), 2 * (0.06 * 0.04 + 0.06 * 0.05 + 0.04 * 0.05), 1e-12);
    EXPECT_LT(off_field_m(surface, false), 1e-14);
    // Nine of twenty-five places.
    const auto nodes = std::count(surface.is_node.begin(), surface.is_node.end(), true);
    EXPECT_EQ(25 * nodes, 9 * surface.rest.points_m.cols());
  }
}

TEST(BoundarySurface, OfABallIsWholeInSpaceAndTurnedFromItsMeridian) {
  constexpr double radius_m = 0.03;
  scene::Body body;
  body.shape = scene::BodyShape::sphere;
  body.radius_m = radius_m;
  body.support_height_m = 0.005;
  RoundSpec spec = round_spec(body);
  Grading<2> meridian;
  meridian.largest_m = 0.004;
  const Discretisation<2> flat = round_mesh<2>(spec, meridian);
  spec.symmetric_x = spec.symmetric_y = true;
  Grading<3> space;
  space.largest_m = 0.008;
  const Discretisation<3> quarter = round_mesh<3>(spec, space);
  const BoundarySurface turned = boundary_surface<2>(flat, nodal_field_m(flat), nodal_field_m(flat), false, false);
  const BoundarySurface mirrored =
      boundary_surface<3>(quarter, nodal_field_m(quarter), nodal_field_m(quarter), true, true);
  for (const BoundarySurface* surface : {&turned, &mirrored}) {
    const double whole_m2 = 4.0 * std::numbers::pi * radius_m * radius_m;
    EXPECT_NEAR(area_m2(surface->rest), whole_m2, 0.01 * whole_m2);
    EXPECT_LT(off_field_m(*surface, true), 1e-13);
    EXPECT_LT(off_field_m(*surface, false), 1e-4 * radius_m);
    for (Eigen::Index i = 0; i < surface->rest.points_m.cols(); ++i) {
      const scene::Vec3 from_middle_m = surface->rest.points_m.col(i) - scene::Vec3(0.0, 0.0, radius_m);
      EXPECT_NEAR(from_middle_m.norm(), radius_m, 1e-3 * radius_m);
    }
  }
}

}  // namespace
}  // namespace touchstone::reference
