// Which meshes count as convex: those of convex solids, however coarse, rounded or placed; none with a concavity.
#include "scene/input/scene_io.h"
#include "scene/mesh/mesh_file.h"
#include "scene/mesh/mesh_formats.h"
#include "scene/mesh/triangle_mesh.h"
#include "scene/shape/surface.h"
#include "support/shapes.h"
#include "support/source_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace touchstone::scene {
namespace {

double diagonal_m(const TriangleMesh& mesh) {
  const Bounds bounds = mesh.bounds();
  return (bounds.upper_m - bounds.lower_m).norm();
}

TriangleMesh mesh_of(const Shape& shape, int triangles) {
  const Surface surface = tessellate(shape, triangles);
  return {surface.points_m, surface.triangles};
}

/// A solid of revolution as modellers export it: rings with equally many segments, poles as fans.
TriangleMesh turned(const std::vector<Eigen::Vector2d>& rz_m, int segments) {
  TriangleMesh mesh;
  const auto rings = static_cast<int>(rz_m.size());
  mesh.points_m.resize(3, rings * segments);
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < segments; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / segments, r_m = rz_m[static_cast<std::size_t>(ring)].x();
      mesh.points_m.col(ring * segments + k) =
          Vec3(r_m * std::cos(angle), r_m * std::sin(angle), rz_m[static_cast<std::size_t>(ring)].y());
    }
  }
  for (int ring = 0; ring + 1 < rings; ++ring) {
    for (int k = 0; k < segments; ++k) {
      const std::int32_t a = ring * segments + k, b = ring * segments + (k + 1) % segments;
      mesh.triangles.push_back({a, b, b + segments});
      mesh.triangles.push_back({a, b + segments, a + segments});
    }
  }
  return mesh;
}

TriangleMesh capsule(int segments, int bands) {
  constexpr double radius_m = 0.006, half_m = 0.01;
  std::vector<Eigen::Vector2d> rz_m;
  for (const int side : {-1, 1}) {
    for (int k = 0; k <= bands; ++k) {
      const double up = 0.5 * std::numbers::pi * (side < 0 ? k - bands : k) / bands;
      rz_m.emplace_back(k == (side < 0 ? 0 : bands) ? 0.0 : radius_m * std::cos(up),
                        side * half_m + radius_m * std::sin(up));
    }
  }
  return turned(rz_m, segments);
}

class Convexity : public testing::Test {
 protected:
  /// Written as a binary STL file, which holds single precision, and read again.
  [[nodiscard]] TriangleMesh from_stl(const TriangleMesh& mesh, double unit_m = 1e-3) const {
    const auto file = std::filesystem::temp_directory_path() / ("convexity-" + std::to_string(::getpid()) + ".stl");
    write_stl(mesh, file, unit_m);
    std::vector<Fault> faults;
    const auto read = read_triangle_mesh(file, unit_m, faults);
    std::filesystem::remove(file);
    EXPECT_TRUE(faults.empty()) << faults.front().message;
    return read.value_or(TriangleMesh());
  }
  [[nodiscard]] bool convex(const TriangleMesh& mesh, double unit_m = 1e-3) const {
    return from_stl(mesh, unit_m).convex;
  }
};

TriangleMesh moved(TriangleMesh mesh, const Vec3& by_m, const Eigen::Quaterniond& turn) {
  mesh.points_m = (turn.toRotationMatrix() * mesh.points_m).colwise() + by_m;
  return mesh;
}

const Eigen::Quaterniond askew = Eigen::Quaterniond(0.8, 0.3, -0.5, 0.1).normalized();

TEST_F(Convexity, OfExportedSolidsAtAnyPlaceAndFineness) {
  std::vector<std::pair<std::string, TriangleMesh>> solids = {{"coarse capsule", capsule(8, 2)},
                                                              {"capsule", capsule(48, 12)},
                                                              {"fine capsule", capsule(128, 32)},
                                                              {"slivers at the poles", capsule(600, 3)}};
  for (const auto& [name, shape] : test::every_shape()) {
    if (name == "Box" || name == "Sphere" || name == "Cylinder" || name == "Capsule" || name == "Ellipsoid") {
      for (const int triangles : {100, 3000}) {
        solids.emplace_back(name + " of " + std::to_string(triangles), mesh_of(*shape, triangles));
      }
    }
  }
  for (const auto& [name, solid] : solids) {
    const double size_m = diagonal_m(solid);
    EXPECT_TRUE(convex(solid)) << name;
    EXPECT_TRUE(convex(moved(solid, size_m * Vec3(1.0, -0.7, 0.4), askew))) << name << ", beside the origin";
    EXPECT_TRUE(convex(moved(solid, size_m * Vec3(70.0, -50.0, 30.0), askew))) << name << ", far from the origin";
  }
}

/// A box of 20 mm whose top has a smooth concavity of full width, in which every edge is nearly flat.
TriangleMesh dented_box(double depth_m) {
  constexpr double half_m = 0.01;
  TriangleMesh mesh = mesh_of(Box(Vec3::Zero(), Vec3::Constant(2.0 * half_m)), 8000);
  for (auto p_m : mesh.points_m.colwise()) {
    if (p_m.z() < half_m) continue;
    const double x = p_m.x() / half_m, y = p_m.y() / half_m;
    p_m.z() -= depth_m * std::pow((1.0 - x * x) * (1.0 - y * y), 2);
  }
  return mesh;
}

TEST_F(Convexity, EndsWhereADentIsDeeperThanTheTolerance) {
  const double allowed_m = convex_tolerance_rel * diagonal_m(dented_box(0.0));
  EXPECT_TRUE(convex(dented_box(0.0)));
  EXPECT_TRUE(convex(dented_box(0.7 * allowed_m)));
  EXPECT_FALSE(convex(dented_box(1.5 * allowed_m)));
  // When rotated, its bounding box is larger, and so is the tolerance.
  const double turned_m = convex_tolerance_rel * diagonal_m(moved(dented_box(0.0), Vec3::Zero(), askew));
  EXPECT_FALSE(convex(moved(dented_box(1.5 * turned_m), Vec3(0.1, 0.2, 0.3), askew)));
}

TEST_F(Convexity, OfAnyUnit) {
  const double allowed_m = convex_tolerance_rel * diagonal_m(dented_box(0.0));
  for (const double unit_m : {1.0, 1e-2, 1e-3, 0.0254}) {
    EXPECT_TRUE(convex(capsule(32, 8), unit_m)) << unit_m;
    EXPECT_TRUE(convex(dented_box(0.7 * allowed_m), unit_m)) << unit_m;
    EXPECT_FALSE(convex(dented_box(1.5 * allowed_m), unit_m)) << unit_m;
  }
}

TEST_F(Convexity, EndsWhereOneCornerIsPushedIn) {
  TriangleMesh box = mesh_of(Box(Vec3::Zero(), Vec3::Constant(0.02)), 300);
  Eigen::Index corner = 0;
  (box.points_m.colwise() - Vec3(0.001, 0.001, 0.01)).colwise().norm().minCoeff(&corner);
  const double allowed_m = convex_tolerance_rel * diagonal_m(box);
  box.points_m(2, corner) -= 0.7 * allowed_m;
  EXPECT_TRUE(convex(box));
  box.points_m(2, corner) -= 0.8 * allowed_m;
  EXPECT_FALSE(convex(box));
}

TEST_F(Convexity, IsNotThatOfTheCornersAlone) {
  // A prism whose top is rotated: all six corners are extreme, but the sides are folded inwards along their diagonals.
  TriangleMesh prism;
  prism.points_m.resize(3, 6);
  for (int k = 0; k < 6; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0 - (k < 3 ? 0.0 : 0.2);
    prism.points_m.col(k) = 0.01 * Vec3(std::cos(angle), std::sin(angle), k < 3 ? -1.0 : 1.0);
  }
  TriangleMesh outwards = prism;
  prism.triangles = outwards.triangles = {{0, 2, 1}, {3, 4, 5}};
  for (std::int32_t k = 0; k < 3; ++k) {
    const std::int32_t next = (k + 1) % 3;
    prism.triangles.push_back({k, next, next + 3});
    prism.triangles.push_back({k, next + 3, k + 3});
    outwards.triangles.push_back({k, next, k + 3});
    outwards.triangles.push_back({next, next + 3, k + 3});
  }
  EXPECT_NE(convex(prism), convex(outwards));
}

TEST_F(Convexity, NeedsOnePiece) {
  TriangleMesh two = mesh_of(Sphere(Vec3::Zero(), 0.01), 300);
  const TriangleMesh other = mesh_of(Sphere(Vec3(0.03, 0.0, 0.0), 0.01), 300);
  const auto shift = static_cast<std::int32_t>(two.points_m.cols());
  two.points_m.conservativeResize(3, shift + other.points_m.cols());
  two.points_m.rightCols(other.points_m.cols()) = other.points_m;
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + shift, b + shift, c + shift});
  EXPECT_FALSE(convex(two));
}

TEST(ConvexTool, IsNoneOfTheShippedMeshes) {
  const std::filesystem::path scenes = std::filesystem::path(source_folder()) / "meshes/scenes";
  for (const char* name : {"mallet-head-on-cube.toml", "compass-two-pins.toml"}) {
    const Scene scene = load_scene(scenes / name);
    EXPECT_FALSE(scene.tool.convex()) << name;
  }
  EXPECT_TRUE(load_scene(scenes / "ball-on-cube-press.toml").tool.convex());
}

}  // namespace
}  // namespace touchstone::scene
