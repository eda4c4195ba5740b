#include "compare/report/section.h"

#include "reference/mesh/boundary_surface.h"
#include "reference/mesh/round_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace touchstone::compare {
namespace {

using scene::Vec3;

/// Area of outlines in the plane of x and z; a hole counts as area too, in either orientation.
double area_m2(const Outlines& outlines_m) {
  double sum = 0.0;
  for (const auto& outline_m : outlines_m) {
    double twice = 0.0;
    for (std::size_t i = 0; i < outline_m.size(); ++i) {
      const Vec3 &a = outline_m[i], &b = outline_m[(i + 1) % outline_m.size()];
      twice += a.x() * b.z() - b.x() * a.z();
    }
    sum += 0.5 * std::abs(twice);
  }
  return sum;
}

/// Extent of outlines, largest less smallest coordinate.
Vec3 extent_m(const Outlines& outlines_m) {
  Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
  for (const auto& outline_m : outlines_m) {
    for (const Vec3& p : outline_m) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  return high - low;
}

/// A pose whose centre plane is slightly beside the cut plane.
constexpr double hair_m = 6e-9;
scene::Pose somewhere() { return {Vec3(0.012, -0.004, 0.07)}; }
double beside(const scene::Pose& pose) { return pose.position_m.y() - hair_m; }

scene::Tool tool_of(scene::ToolShape shape) {
  scene::Tool tool;
  tool.shape = shape;
  tool.radius_m = 0.006;
  tool.length_m = 0.030;
  tool.edge_radius_m = 0.0015;
  tool.size_m = Vec3(0.02, 0.01, 0.03);
  return tool;
}

/// Boxes as one mesh tool.
scene::Tool mesh_of(const std::vector<scene::Box>& boxes) {
  auto mesh = std::make_shared<scene::TriangleMesh>();
  for (const scene::Box& box : boxes) {
    const auto first = static_cast<std::int32_t>(mesh->points_m.cols());
    mesh->points_m.conservativeResize(3, first + 8);
    for (std::int32_t corner = 0; corner < 8; ++corner) {
      const Vec3 side(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
      mesh->points_m.col(first + corner) = box.center_m() + side.cwiseProduct(box.half_m());
    }
    constexpr std::int32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& [a, b, c, d] : faces) {
      mesh->triangles.push_back({first + a, first + b, first + c});
      mesh->triangles.push_back({first + a, first + c, first + d});
    }
  }
  scene::Tool tool;
  tool.shape = scene::ToolShape::mesh;
  tool.mesh = mesh;
  return tool;
}

double perimeter_m(const scene::Surface& surface, const std::vector<EdgePoint>& outline) {
  double sum = 0.0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    sum += (outline[(i + 1) % outline.size()].of(surface.points_m) - outline[i].of(surface.points_m)).norm();
  }
  return sum;
}

TEST(Section, OfABoxIsOneClosedRectangle) {
  const scene::Surface surface = scene::tessellate(scene::Box(Vec3(0.0, 0.0, 1.5), Vec3(1.0, 2.0, 3.0)), 400);
  for (const double y : {-0.71, 1e-7, 0.123}) {
    const auto outlines = cut_at_y(surface, y);
    ASSERT_EQ(outlines.size(), 1u) << y;
    EXPECT_NEAR(perimeter_m(surface, outlines[0]), 8.0, 1e-9) << y;
    for (const EdgePoint& p : outlines[0]) EXPECT_NEAR(p.of(surface.points_m).y(), y, 1e-12);
  }
}

TEST(Section, MissesABodyElsewhere) {
  const scene::Surface surface = scene::tessellate(scene::Box(Vec3(0.0, 0.0, 1.5), Vec3(1.0, 2.0, 3.0)), 400);
  EXPECT_TRUE(cut_at_y(surface, 1.5).empty());
}

/// Section of a reference's mesh of a body, graded so that some nodes hang.
template <int dim>
std::vector<std::vector<EdgePoint>> cut_of_mesh(const reference::Discretisation<dim>& mesh, bool mirrored, double y_m,
                                                scene::Surface& rest) {
  const Eigen::Matrix<double, dim, Eigen::Dynamic> still_m =
      Eigen::Matrix<double, dim, Eigen::Dynamic>::Zero(dim, mesh.node_count());
  rest = reference::boundary_surface<dim>(mesh, still_m, still_m, mirrored, mirrored).rest;
  return cut_at_y(rest, y_m, 5e-3);
}

TEST(Section, OfAReferencesMeshIsOneClosedOutline) {
  scene::Body body;
  body.shape = scene::BodyShape::ellipsoid;
  body.semi_axes_m = {0.040, 0.040, 0.025};
  body.support_height_m = 0.005;
  for (const bool mirrored : {false, true}) {
    reference::RoundSpec spec = reference::round_spec(body);
    spec.symmetric_x = spec.symmetric_y = mirrored;
    reference::Grading<3> grading;
    grading.largest_m = 0.012;
    grading.discs.push_back({{0.0, 0.0, 0.05}, {0.0, 0.0, 1.0}, 0.002, 0.003});
    const reference::Discretisation<3> mesh = reference::round_mesh<3>(spec, grading);
    ASSERT_GT(mesh.hanging_count(), 0);
    for (const double y_m : {-1e-8, 0.0031, -0.0172}) {
      scene::Surface rest;
      const auto outlines = cut_of_mesh(mesh, mirrored, y_m, rest);
      ASSERT_EQ(outlines.size(), 1u) << mirrored << ' ' << y_m;
      // The same cut of the true surface.
      const scene::Surface fine = scene::tessellate(*scene::body_shape(body), 60'000);
      const double true_m = perimeter_m(fine, cut_at_y(fine, y_m).at(0));
      EXPECT_NEAR(perimeter_m(rest, outlines[0]), true_m, 2e-3 * true_m) << mirrored << ' ' << y_m;
    }
  }
  // Revolved from the meridian, whose ends lie on the axis.
  reference::Grading<2> grading;
  grading.largest_m = 0.006;
  grading.discs.push_back({{0.0, 0.05}, {0.0, 1.0}, 0.002, 0.001});
  scene::Surface rest;
  const auto outlines = cut_of_mesh(reference::round_mesh<2>(reference::round_spec(body), grading), false, -8e-9, rest);
  ASSERT_EQ(outlines.size(), 1u);
  const scene::Surface fine = scene::tessellate(*scene::body_shape(body), 60'000);
  const double true_m = perimeter_m(fine, cut_at_y(fine, -8e-9).at(0));
  EXPECT_NEAR(perimeter_m(rest, outlines[0]), true_m, 2e-3 * true_m);
}

TEST(Section, ClippedTrianglesCoverWhatLiesBehind) {
  const scene::Surface surface = scene::tessellate(scene::Box(Vec3(0.0, 0.0, 1.5), Vec3(1.0, 2.0, 3.0)), 400);
  double area_m2 = 0.0;
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const std::vector<EdgePoint> polygon = triangle_behind_y(surface, i, 0.25);
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      const Vec3 a = polygon[0].of(surface.points_m);
      area_m2 += 0.5 * (polygon[k - 1].of(surface.points_m) - a).cross(polygon[k].of(surface.points_m) - a).norm();
    }
    for (const EdgePoint& p : polygon) EXPECT_GE(p.of(surface.points_m).y(), 0.25 - 1e-12);
  }
  // The far end, and three quarters of a unit of the four long sides.
  EXPECT_NEAR(area_m2, 1.0 * 3.0 + 0.75 * 8.0, 1e-9);
}

TEST(ToolOutline, OfASphereIsACircleOfItsDistance) {
  const scene::Tool tool = tool_of(scene::ToolShape::sphere);
  for (const double off_m : {0.0, 0.0035}) {
    const Outlines outlines_m = tool_outlines_m(tool, somewhere(), beside(somewhere()) + off_m);
    ASSERT_EQ(outlines_m.size(), 1u);
    const double radius_m = std::sqrt(tool.radius_m * tool.radius_m - off_m * off_m);
    EXPECT_GT(outlines_m[0].size(), 60u);
    for (const Vec3& p : outlines_m[0]) {
      const Vec3 from_axis_m = p - somewhere().position_m;
      EXPECT_NEAR(std::hypot(from_axis_m.x(), from_axis_m.z()), radius_m, 0.003 * radius_m);
    }
    EXPECT_NEAR(area_m2(outlines_m), std::numbers::pi * radius_m * radius_m, 0.01 * radius_m * radius_m * 3.14);
  }
}

TEST(ToolOutline, OfACapsule) {
  const scene::Tool tool = tool_of(scene::ToolShape::capsule);
  const Outlines outlines_m = tool_outlines_m(tool, somewhere(), beside(somewhere()));
  ASSERT_EQ(outlines_m.size(), 1u);
  EXPECT_NEAR(extent_m(outlines_m).x(), 0.012, 1e-5);
  EXPECT_NEAR(extent_m(outlines_m).z(), 0.042, 1e-5);
  EXPECT_NEAR(area_m2(outlines_m), 0.012 * 0.030 + std::numbers::pi * 36e-6, 2e-6);
}

TEST(ToolOutline, OfACylinderLacksWhatItsEdgesAreRoundedBy) {
  const scene::Tool tool = tool_of(scene::ToolShape::cylinder);
  const Outlines outlines_m = tool_outlines_m(tool, somewhere(), beside(somewhere()));
  ASSERT_EQ(outlines_m.size(), 1u);
  EXPECT_NEAR(extent_m(outlines_m).x(), 0.012, 1e-5);
  EXPECT_NEAR(extent_m(outlines_m).z(), 0.030, 1e-9);
  EXPECT_NEAR(area_m2(outlines_m), 0.012 * 0.030 - (4.0 - std::numbers::pi) * 1.5e-3 * 1.5e-3, 1e-6);
  // Lying along x it is as long as it was high.
  scene::Pose lying = somewhere();
  lying.orientation = Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitY());
  EXPECT_NEAR(extent_m(tool_outlines_m(tool, lying, beside(lying))).x(), 0.030, 1e-9);
}

TEST(ToolOutline, OfATurnedBoxHasOnlyItsCorners) {
  const scene::Tool tool = tool_of(scene::ToolShape::box);
  scene::Pose pose = somewhere();
  pose.orientation = Eigen::AngleAxisd(0.3, Vec3::UnitY());
  const Outlines outlines_m = tool_outlines_m(tool, pose, beside(pose));
  ASSERT_EQ(outlines_m.size(), 1u);
  EXPECT_EQ(outlines_m[0].size(), 4u);
  EXPECT_NEAR(area_m2(outlines_m), 0.02 * 0.03, 1e-9);
  EXPECT_NEAR(extent_m(outlines_m).x(), 0.02 * std::cos(0.3) + 0.03 * std::sin(0.3), 1e-9);
  EXPECT_TRUE(tool_outlines_m(tool, pose, beside(pose) + 0.0051).empty());
}

TEST(ToolOutline, OfAMeshIsWhereItsMassCentreIsPut) {
  const scene::Tool tool = mesh_of({scene::Box(Vec3(0.1, 0.2, 0.3), Vec3(0.02, 0.01, 0.03))});
  const Outlines outlines_m = tool_outlines_m(tool, somewhere(), beside(somewhere()));
  ASSERT_EQ(outlines_m.size(), 1u);
  EXPECT_EQ(outlines_m[0].size(), 4u);
  EXPECT_NEAR(area_m2(outlines_m), 0.02 * 0.03, 1e-9);
  for (const Vec3& p : outlines_m[0]) {
    EXPECT_NEAR(std::abs(p.x() - 0.012), 0.010, 1e-9);
    EXPECT_NEAR(std::abs(p.z() - 0.070), 0.015, 1e-9);
  }
}

TEST(ToolOutline, OfAMeshInPiecesIsThatOfEachPiece) {
  scene::Tool tool = mesh_of({scene::Box(Vec3(-0.01, 0.0, 0.0), Vec3(0.004, 0.004, 0.02)),
                              scene::Box(Vec3(0.01, 0.0, 0.0), Vec3(0.004, 0.004, 0.02))});
  const Outlines outlines_m = tool_outlines_m(tool, somewhere(), beside(somewhere()));
  EXPECT_EQ(outlines_m.size(), 2u);
  EXPECT_NEAR(area_m2(outlines_m), 2 * 0.004 * 0.02, 1e-9);
  EXPECT_NEAR(extent_m(outlines_m).x(), 0.024, 1e-9);
}

TEST(InclusionOutline, IsAtRestAndOnlyWhereThePlaneMeetsIt) {
  scene::Body body;
  scene::Inclusion inclusion;
  inclusion.shape = scene::BodyShape::sphere;
  inclusion.radius_m = 0.008;
  inclusion.center_m = Vec3(-0.012, 0.003, 0.036);
  body.inclusions = {inclusion};
  const Outlines outlines_m = inclusion_outlines_m(body, -hair_m);
  ASSERT_EQ(outlines_m.size(), 1u);
  const double radius_m = std::sqrt(64e-6 - 9e-6);
  for (const Vec3& p : outlines_m[0]) {
    EXPECT_NEAR(std::hypot(p.x() + 0.012, p.z() - 0.036), radius_m, 0.003 * radius_m);
  }
  EXPECT_TRUE(inclusion_outlines_m(body, 0.0111).empty());
  EXPECT_TRUE(inclusion_outlines_m(scene::Body{}, 0.0).empty());
}

}  // namespace
}  // namespace touchstone::compare
