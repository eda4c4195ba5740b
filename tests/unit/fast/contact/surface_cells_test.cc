#include "fast/contact/surface_cells.h"

#include "fast/contact/cell_batch.h"
#include "fast/contact/contact_detection.h"
#include "fast/contact/tool_samples.h"
#include "fast/step/cell_rule.h"
#include "fast/step/stages.h"
#include "fast/step/step.h"
#include "support/press.h"
#include "support/tools.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace touchstone::fast {
namespace {

using scene::Vec3;

using test::NamedTool;
using test::tools;

class CellsOf : public testing::TestWithParam<NamedTool> {};

TEST_P(CellsOf, AreTheSurfaceHoweverOftenTheyAreHalved) {
  const ToolSamples samples = cell_tool(GetParam().tool, 300);
  const bool groups = !samples.groups.nodes.empty();
  double area_m2 = 0.0, sampled_m2 = 0.0;
  Vec3 projected_m2 = Vec3::Zero();
  for (std::size_t i = 0; i < samples.cell.size(); ++i) {
    EXPECT_EQ(samples.cell[i].sample, static_cast<int>(i));
    sampled_m2 += samples.area_m2[i];
    std::vector<SurfaceCell> parts{samples.cell[i]};
    for (int round = 0; round < 6; ++round) {
      std::vector<SurfaceCell> halved;
      for (const SurfaceCell& part : parts) {
        const auto two = halves(part, samples.groups);
        const Vec3 both_m2 = two[0].area_m2 * two[0].normal_T + two[1].area_m2 * two[1].normal_T;
        EXPECT_LT((both_m2 - part.area_m2 * part.normal_T).norm(), (part.curved ? 1e-3 : 1e-12) * part.area_m2);
        for (const SurfaceCell& half : two) {
          EXPECT_EQ(half.sample, static_cast<int>(i));
          EXPECT_LE((half.center_T_m - part.center_T_m).norm(), part.radius_m);
          EXPECT_LT(half.radius_m, (part.group >= 0 ? 1.5 : 1.1) * part.radius_m);
          halved.push_back(half);
        }
      }
      parts = std::move(halved);
    }
    for (const SurfaceCell& part : parts) {
      area_m2 += part.area_m2;
      projected_m2 += part.area_m2 * part.normal_T;
    }
  }
  // A small cell is almost flat.
  EXPECT_NEAR(area_m2, sampled_m2, (groups ? 1e-5 : 1e-3) * sampled_m2);
  EXPECT_LT(projected_m2.norm(), 1e-6 * sampled_m2) << "a closed surface";
}
INSTANTIATE_TEST_SUITE_P(Tools, CellsOf, testing::ValuesIn(tools(0.01)),
                         [](const auto& named) { return named.param.name; });

TEST(CutPolygon, KeepsWhatLiesBelow) {
  const std::array square{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};
  CutPolygon polygon(square);
  polygon.keep_below(Vec3::UnitX(), -2.0);
  EXPECT_FALSE(polygon.is_cut());
  polygon.keep_below(Vec3::UnitX(), -0.5);  // x < 0.5
  EXPECT_TRUE(polygon.is_cut());
  EXPECT_NEAR(polygon.moments().area_m2, 3.0, 1e-15);
  EXPECT_LT((polygon.moments().center_m - Vec3(-0.25, 0, 0)).norm(), 1e-15);
  polygon.keep_below(Vec3(1, 1, 0).normalized(), 0.0);  // below the diagonal
  EXPECT_NEAR(polygon.moments().area_m2, 2.0 - 0.125, 1e-15);
  polygon.keep_below(Vec3::UnitZ(), 1.0);
  EXPECT_EQ(polygon.moments().area_m2, 0.0);
}

/// Of a cap of the ball that the cube's top cuts off, projected.
TEST(CellsOfABall, AreCutWhereItsSurfaceIsNotAtTheirChords) {
  const scene::Scene scene = test::ball_on_cube();
  FastModel model(scene);
  model.cells->rule.points = 48;
  FastState state(model);
  for (int k = 1; k <= 20; ++k) {
    const double depth_m = 0.0002 * k;
    step_force(model, test::pressed(depth_m), state);
    const double area_m2 = std::numbers::pi * depth_m * (2.0 * scene.tool.radius_m - depth_m);
    EXPECT_NEAR(state.regions[0].extent.area_m2, area_m2, 4e-3 * area_m2) << depth_m;
  }
}

std::vector<SurfaceCell> halved(std::vector<SurfaceCell> cells, int times, const CellGroups& groups) {
  for (; times > 0; --times) {
    std::vector<SurfaceCell> next;
    for (const SurfaceCell& cell : cells) {
      for (const SurfaceCell& half : halves(cell, groups)) next.push_back(half);
    }
    cells = std::move(next);
  }
  return cells;
}

/// A cell whose surface is all above a plane is not looked at again, so no surface may be below what is said of it.
TEST_P(CellsOf, DipNoFurtherBelowTheirCornersThanIsSaid) {
  const ToolSamples samples = cell_tool(GetParam().tool, 100);
  CellBatch batch;
  double dips_m = 0.0, bulges_m = 0.0;
  for (const SurfaceCell& whole : samples.cell) {
    if (!whole.curved) continue;
    for (const SurfaceCell& cell : {whole, halves(whole, samples.groups)[0]}) {
      const std::vector<SurfaceCell> parts = halved({cell}, 8, samples.groups);
      for (int k = 0; k < 6; ++k) {
        const Vec3 tilt(std::sin(1.0 + k), std::sin(2.0 * k), std::sin(3.0 - 2.0 * k));
        const Vec3 normal = (0.15 * k * tilt - cell.normal_T).normalized();
        batch.count = 1;
        batch.set_corners(0, cell);
        batch.distance_m[0] = 0.0;
        batch.nx[0] = normal.x();
        batch.ny[0] = normal.y();
        batch.nz[0] = normal.z();
        level_batch(scene::Mat3::Identity(), batch);
        double lowest_m = std::numeric_limits<double>::max();
        for (const SurfaceCell& part : parts) {
          for (const Vec3& corner_m : part.corner_m)
            lowest_m = std::min(lowest_m, normal.dot(part.center_T_m + corner_m - cell.center_T_m));
        }
        EXPECT_GE(lowest_m, batch.lowest_m[0] - batch.dip_m[0] - 1e-12 * cell.radius_m);
        dips_m += batch.dip_m[0];
        bulges_m += cell.bulge_m;
      }
    }
  }
  EXPECT_LE(dips_m, 0.5 * bulges_m);
}

/// The area of a part, and where it looks, follow from those of the whole cell.
TEST_P(CellsOf, HalvesHaveTheAreaOfPartsOfTheWhole) {
  const ToolSamples samples = cell_tool(GetParam().tool, 300);
  for (const SurfaceCell& whole : samples.cell) {
    for (const SurfaceCell& half : halves(whole, samples.groups)) {
      const Vec3 half_m2 = half.area_m2 * half.normal_T;
      // A fine mesh's triangles are not a smooth surface.
      if (whole.group >= 0 && half.group < 0) continue;
      const Vec3 part_m2 =
          part_area_m2(whole, half_m2.dot(whole.normal_T) / whole.area_m2, half.center_T_m - whole.center_T_m);
      EXPECT_LT((part_m2 - half_m2).norm(), (whole.group >= 0 ? 0.05 : 0.01) * half.area_m2);
    }
  }
}

/// d leads from a part of a piece of surface to one face of the body and from the rest to another: the depth is the
/// mean over the piece.
TEST(PiecesOverAnEdge, HaveTheMeanDepth) {
  const Vec3 d = Vec3(-0.8, 0.1, -0.6).normalized();
  const Vec3 along_m(0.001, 0.0004, -0.0012), across_m(0.0003, 0.0015, 0.0);
  PointStore store(1);
  for (const auto& [name, body] : test::four_bodies()) {
    if (body.shape != scene::BodyShape::box && body.shape != scene::BodyShape::revolution) continue;
    const auto shape = scene::body_shape(body);
    const Detection detection = detection_for(*shape);
    for (const double x_m : {0.0265, 0.0275, 0.0285, 0.029, 0.0293}) {
      const Vec3 middle_m(x_m, 0.0, 0.0584);
      RegionPoints points = store.window();
      points.count = 1;
      points.spread = true;
      points.set(0, {{middle_m, middle_m, d, 1e-6, 0.001, 0},
                     Vec3::UnitX(),
                     {along_m / std::sqrt(12.0), across_m / std::sqrt(12.0)},
                     {Vec3::Zero(), Vec3::Zero()},
                     nullptr});
      (void)detection.measure_depths(*shape, scene::Mat3::Identity(), d, points);
      double sum_m = 0.0;
      constexpr int steps = 100;
      for (int i = 0; i < steps; ++i) {
        for (int k = 0; k < steps; ++k) {
          const Vec3 at_m = middle_m + ((i + 0.5) / steps - 0.5) * along_m + ((k + 0.5) / steps - 0.5) * across_m;
          sum_m += detection.exit_distance_m(*shape, at_m, -d);
        }
      }
      // The ways' difference is not quite evenly spread over a parallelogram.
      EXPECT_NEAR(points.depth_m[0], sum_m / (steps * steps), 2.5e-5) << name << " " << x_m;
    }
  }
}

/// Force and direction with that many points, after a slow press of 2 mm. @param toward  where the tool is pressed to
std::pair<Vec3, double> pressed_with(scene::Scene scene, const CellRule& rule, const Vec3& from_m, const Vec3& toward) {
  scene.contact.k3_n_per_m3 = 0.0;
  FastModel model(scene);
  model.cells->rule = rule;
  FastState state(model);
  for (const double depth_m : {-0.001, 0.0001, 0.001, 0.002})
    step_force(model, {from_m + depth_m * toward, Eigen::Quaterniond::Identity()}, state);
  return {state.regions[0].d, total_force_n(state).norm()};
}

/// Where a tool touches the edge of a body, few cells tell the direction and the force of many.
TEST(PiecesOverAnEdge, GiveTheDirectionOfManySmallOnes) {
  for (const auto& [name, body] : test::four_bodies()) {
    if (body.shape != scene::BodyShape::box && body.shape != scene::BodyShape::revolution) continue;
    scene::Scene scene = test::ball_on_cube();
    scene.body = body;
    scene.tool.shape = scene::ToolShape::box;
    scene.tool.size_m = Vec3(0.018, 0.0126, 0.027);
    const Vec3 from_m(0.039, 0.0, 0.06);
    const auto [coarse, coarse_n] = pressed_with(scene, {.points = 48}, from_m, -Vec3::UnitX());
    const auto [fine, fine_n] = pressed_with(scene, {.points = 4000, .room = 65536}, from_m, -Vec3::UnitX());
    EXPECT_LT((coarse - fine).norm(), 0.004) << name;
    EXPECT_NEAR(coarse_n, fine_n, 0.01 * fine_n) << name;
  }
}

/// Much of a rounded edge's area looks aside; its cells, and the cut ones, have their own normals.
TEST(CellsOfARoundedEdge, PressLikeManySmallOnes) {
  scene::Scene scene = test::ball_on_cube();
  scene.tool.shape = scene::ToolShape::cylinder;
  scene.tool.radius_m = 0.0025;
  scene.tool.length_m = 0.02;
  scene.tool.edge_radius_m = 0.001;
  for (const double deeper_m : {-0.0015, 0.0, 0.001}) {
    const Vec3 from_m(0.0, 0.0, 0.07 - deeper_m);
    const double coarse_n = pressed_with(scene, {.points = 48}, from_m, -Vec3::UnitZ()).second,
                 fine_n = pressed_with(scene, {.points = 4000, .room = 65536}, from_m, -Vec3::UnitZ()).second;
    EXPECT_NEAR(coarse_n, fine_n, 0.006 * fine_n) << deeper_m;
  }
}

struct Press {
  std::string name;
  scene::Scene scene;
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  std::shared_ptr<const scene::Shape> tool;
  Vec3 toward = Vec3::UnitZ();  ///< where on the body, from its middle
};

/// Many more points than a scene chooses.
constexpr CellRule fine_cells{.points = 4000, .room = 65536};

/// Force of a slow press, whose deepest point is 2 mm or a third of a small tool's radius below the body's surface.
/// @param rule  null for that which the scene chooses
double press_n(const Press& press, int samples, const CellRule* rule) {
  scene::Scene scene = press.scene;
  scene.fast.tool_samples = samples;
  const auto body = scene::body_shape(scene.body);
  const double radius_m = scene.tool.radius_m, depth_m = std::min(0.002, 0.3 * radius_m);
  const scene::Bounds around = body->bounds();
  const scene::SurfaceQuery at = body->query(0.5 * (around.lower_m + around.upper_m) + 0.2 * press.toward);
  // The tool's surface passes through that place where the tool is `height_m` above it.
  double low_m = 0.0, high_m = 6.0 * radius_m;
  for (int k = 0; k < 100; ++k) {
    const double height_m = 0.5 * (low_m + high_m);
    const Vec3 seen_m = press.orientation.conjugate() * Vec3(-height_m * at.normal);
    (press.tool->signed_distance_m(seen_m) < 0.0 ? low_m : high_m) = height_m;
  }
  const auto pose = [&](double share) {
    return scene::Pose{at.point_m + (low_m - depth_m * share) * at.normal, press.orientation};
  };
  scene.track = {{0.0, pose(-0.15)}, {1.0, pose(1.0)}};
  FastModel model = model_of(scene);
  if (rule != nullptr) model.cells->rule = *rule;
  FastState state(model);
  for (const double share : {-0.15, 0.05, 0.25, 0.5, 0.75, 1.0}) step_force(model, pose(share), state);
  return total_force_n(state).norm();
}

/// Of the scene's own settings against as many cells as there is room for, over all tools, bodies and ratios of size.
TEST(CellsConverge, TheForceIsWithinOnePercentOfItsLimit) {
  for (const auto& [name, body] : test::four_bodies()) {
    for (const double ratio : {1e-3, 1e-2, 0.1, 0.3, 0.5, 1.0, 3.0, 10.0, 100.0, 1000.0}) {
      for (const NamedTool& tool : tools(0.03 * ratio)) {
        Press press;
        press.scene = test::ball_on_cube();
        press.scene.body = body;
        press.scene.contact.k3_n_per_m3 = 0.0;
        press.scene.tool = tool.tool;
        press.tool = tool.shape;
        const double limit_n = press_n(press, 8000, &fine_cells), force_n = press_n(press, 2000, nullptr);
        EXPECT_GT(limit_n, 0.0);
        EXPECT_LT(std::abs(force_n / limit_n - 1.0), 0.01) << tool.name << " " << ratio << " on " << name;
      }
    }
  }
}

/// The mass centre is far away, and the line through it along d has to be where it belongs.
TEST(CellsConverge, OffTheMiddleOfARoundBodyALargeToolIsWithinOnePercent) {
  for (const auto& [name, body] : test::four_bodies()) {
    if (body.shape != scene::BodyShape::sphere && body.shape != scene::BodyShape::ellipsoid) continue;
    for (const double ratio : {10.0, 30.0, 100.0}) {
      for (const NamedTool& tool : tools(0.03 * ratio)) {
        // Its facets are not the surface that the depth is measured from.
        if (tool.tool.shape == scene::ToolShape::mesh) continue;
        Press press;
        press.scene = test::ball_on_cube();
        press.scene.body = body;
        press.scene.contact.k3_n_per_m3 = 0.0;
        press.scene.tool = tool.tool;
        press.tool = tool.shape;
        for (const Vec3& toward : {Vec3(0.2, 0.35, 1.0), Vec3(1.0, 0.4, 1.0), Vec3(0.5, 0.0, 1.0)}) {
          press.toward = toward.normalized();
          const double limit_n = press_n(press, 60000, &fine_cells), force_n = press_n(press, 2000, nullptr);
          EXPECT_GT(limit_n, 0.0);
          EXPECT_LT(std::abs(force_n / limit_n - 1.0), 0.01)
              << tool.name << " " << ratio << " on " << name << " at " << toward.x();
        }
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
