#include "fast/contact/surface_cells.h"

#include "fast/contact/tool_samples.h"
#include "fast/step/cell_rule.h"
#include "fast/step/stages.h"
#include "fast/step/step.h"
#include "scene/shape/surface.h"
#include "support/press.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

namespace touchstone::fast {
namespace {

using scene::Vec3;

struct NamedTool {
  std::string name;
  scene::Tool tool;
  std::shared_ptr<const scene::Shape> shape;  ///< of a mesh, what it was made from
};
void PrintTo(const NamedTool& tool, std::ostream* out) { *out << tool.name; }

/// Tools whose smallest radius is about this.
std::vector<NamedTool> tools(double radius_m) {
  scene::Tool capsule, cylinder, box, mesh, fine;
  capsule.shape = scene::ToolShape::capsule;
  cylinder.shape = scene::ToolShape::cylinder;
  box.shape = scene::ToolShape::box;
  capsule.radius_m = cylinder.radius_m = radius_m;
  capsule.length_m = cylinder.length_m = 3.0 * radius_m;
  box.size_m = radius_m * Vec3(2.0, 1.4, 3.0);
  const auto egg = std::make_shared<scene::Ellipsoid>(Vec3::Zero(), radius_m * Vec3(1.0, 0.7, 1.5));
  const auto of = [&](int triangles) {
    const scene::Surface surface = scene::tessellate(*egg, triangles);
    auto made = std::make_shared<scene::TriangleMesh>();
    made->points_m = surface.points_m;
    made->triangles = surface.triangles;
    made->convex = true;
    return made;
  };
  mesh.shape = fine.shape = scene::ToolShape::mesh;
  mesh.mesh = of(500);
  fine.mesh = of(10000);
  return {{"Sphere", test::ball(radius_m), nullptr},
          {"Capsule", capsule, nullptr},
          {"Cylinder", cylinder, nullptr},
          {"Box", box, nullptr},
          {"Mesh", mesh, egg},
          {"FineMesh", fine, egg}};
}

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
        if (part.group >= 0) {
          EXPECT_LT((both_m2 - part.area_m2 * part.normal_T).norm(), 1e-12 * part.area_m2);
        } else {
          EXPECT_NEAR(two[0].area_m2 + two[1].area_m2, part.area_m2, 2e-3 * part.area_m2);
        }
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
  // A group that six halvings have not taken apart is seen from the way it looks.
  EXPECT_NEAR(area_m2, sampled_m2, (groups ? 1e-5 : 1e-9) * sampled_m2);
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
/// A faceted tool a thousand times larger than the body is the exception: where the direction d is a thousandth off,
/// the line through its mass centre passes by the contact, and 1 / r has another meaning.
TEST(CellsConverge, TheForceIsWithinTwoPercentOfItsLimit) {
  std::vector<scene::Body> bodies(4);
  bodies[0].shape = scene::BodyShape::box;
  bodies[0].size_m = Vec3::Constant(0.06);
  bodies[1].shape = scene::BodyShape::sphere;
  bodies[1].radius_m = 0.03;
  bodies[2].shape = scene::BodyShape::ellipsoid;
  bodies[2].semi_axes_m = Vec3(0.04, 0.03, 0.025);
  bodies[3].shape = scene::BodyShape::revolution;
  bodies[3].profile = scene::cylinder_profile(0.03, 0.06, 0.0);
  int within_one_percent = 0, beyond = 0;
  for (const scene::Body& body : bodies) {
    for (const double ratio : {1e-3, 1e-2, 0.1, 0.3, 0.5, 1.0, 3.0, 10.0, 100.0, 1000.0}) {
      for (const NamedTool& tool : tools(0.03 * ratio)) {
        Press press;
        press.scene = test::ball_on_cube();
        press.scene.body = body;
        press.scene.contact.k3_n_per_m3 = 0.0;
        press.scene.tool = tool.tool;
        press.tool =
            tool.shape != nullptr ? tool.shape : std::shared_ptr<const scene::Shape>(scene::tool_shape(tool.tool));
        press.scene.tool.radius_m = 0.03 * ratio;
        const double limit_n = press_n(press, 8000, &fine_cells), force_n = press_n(press, 2000, nullptr);
        EXPECT_GT(limit_n, 0.0);
        const double error = std::abs(force_n / limit_n - 1.0);
        const bool faceted_and_far = tool.tool.shape == scene::ToolShape::mesh && ratio > 100.0;
        EXPECT_LT(error, faceted_and_far ? 0.31 : 0.017)
            << tool.name << " " << ratio << " on body " << static_cast<int>(body.shape);
        (error < 0.01 ? within_one_percent : beyond)++;
      }
    }
  }
  EXPECT_GE(within_one_percent, 220) << "of " << within_one_percent + beyond;
}

/// The mass centre is far away, and the line through it along d has to be where it belongs.
TEST(CellsConverge, OffTheMiddleOfARoundBodyALargeToolIsWithinOnePercent) {
  std::vector<scene::Body> bodies(2);
  bodies[0].shape = scene::BodyShape::sphere;
  bodies[0].radius_m = 0.03;
  bodies[1].shape = scene::BodyShape::ellipsoid;
  bodies[1].semi_axes_m = Vec3(0.04, 0.03, 0.025);
  for (const scene::Body& body : bodies) {
    for (const double ratio : {10.0, 30.0, 100.0}) {
      for (const NamedTool& tool : tools(0.03 * ratio)) {
        if (tool.tool.shape == scene::ToolShape::mesh) continue;
        Press press;
        press.scene = test::ball_on_cube();
        press.scene.body = body;
        press.scene.contact.k3_n_per_m3 = 0.0;
        press.scene.tool = tool.tool;
        press.scene.tool.radius_m = 0.03 * ratio;
        press.tool = std::shared_ptr<const scene::Shape>(scene::tool_shape(tool.tool));
        for (const Vec3& toward : {Vec3(0.2, 0.35, 1.0), Vec3(1.0, 0.4, 1.0), Vec3(0.5, 0.0, 1.0)}) {
          press.toward = toward.normalized();
          const double limit_n = press_n(press, 60000, &fine_cells), force_n = press_n(press, 2000, nullptr);
          EXPECT_GT(limit_n, 0.0);
          EXPECT_LT(std::abs(force_n / limit_n - 1.0), 0.01)
              << tool.name << " " << ratio << " on body " << static_cast<int>(body.shape) << " at " << toward.x();
        }
      }
    }
  }
}

}  // namespace
}  // namespace touchstone::fast
