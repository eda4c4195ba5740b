// First contact of a tool with the body along a line, and the poses of a track that gives depths.
#include "scene/model/first_contact.h"

#include "scene/input/scene_io.h"
#include "scene/shape/surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

namespace touchstone::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Vec3 down(0.0, 0.0, -1.0);
const Box cube_body(Vec3(0, 0, 0.03), Vec3::Constant(0.06));

Tool tool_of(ToolShape shape, double radius_m, double length_m = 0.0) {
  Tool tool;
  tool.shape = shape;
  tool.radius_m = radius_m;
  tool.length_m = length_m;
  return tool;
}

Tool box_shaped_tool(const Vec3& size_m) {
  Tool tool;
  tool.shape = ToolShape::box;
  tool.size_m = size_m;
  return tool;
}

Tool mesh_tool(std::vector<std::pair<const Shape*, int>> parts) {
  TriangleMesh mesh;
  for (const auto& [shape, triangles] : parts) {
    const Surface s = tessellate(*shape, triangles);
    const auto first = static_cast<std::int32_t>(mesh.points_m.cols());
    mesh.points_m.conservativeResize(3, first + s.points_m.cols());
    mesh.points_m.rightCols(s.points_m.cols()) = s.points_m;
    for (const auto& [a, b, c] : s.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
  }
  Tool tool;
  tool.shape = ToolShape::mesh;
  tool.mesh = std::make_shared<TriangleMesh>(std::move(mesh));
  tool.mass_center_m = Vec3::Zero();
  return tool;
}

Pose at(const Vec3& position_m, const Eigen::Quaterniond& turned = Eigen::Quaterniond::Identity()) {
  return {position_m, turned};
}

TEST(FirstContact, OfABallIsExactOnAFaceAnEdgeAndFromTheSide) {
  const Tool ball = tool_of(ToolShape::sphere, 0.01);
  EXPECT_NEAR(first_contact_m(cube_body, ball, at(Vec3(0.01, 0.02, 0.1)), down).value(), 0.03, 1e-15);
  // The length of the direction has no effect; beyond first contact the distance is negative.
  EXPECT_NEAR(first_contact_m(cube_body, ball, at(Vec3(0, 0, 0.065)), 7.0 * down).value(), -0.005, 1e-15);
  // With its centre 6 mm beyond the edge, the ball rests on the edge 8 mm above the top.
  EXPECT_NEAR(first_contact_m(cube_body, ball, at(Vec3(0.036, 0, 0.1)), down).value(), 0.1 - 0.068, 1e-12);
  EXPECT_NEAR(first_contact_m(cube_body, ball, at(Vec3(-0.5, 0, 0.03)), Vec3::UnitX()).value(), 0.46, 1e-15);
  const Vec3 slant(1.0, 0.0, -1.0);
  EXPECT_NEAR(first_contact_m(cube_body, ball, at(Vec3(-0.1, 0, 0.17)), slant).value(), 0.1 * std::sqrt(2.0), 1e-14);
  EXPECT_FALSE(first_contact_m(cube_body, ball, at(Vec3(0.0401, 0, 0.1)), down));
  EXPECT_TRUE(first_contact_m(cube_body, ball, at(Vec3(0.0399, 0, 0.1)), down));
}

TEST(FirstContact, OfAMeshNeedNotBeAtACorner) {
  // A plate of two triangles per side is lowered onto a slim body: the middle of a triangle touches first.
  const Box plate(Vec3::Zero(), Vec3(0.2, 0.2, 0.002));
  const Box slim(Vec3(0, 0, 0.02), Vec3(0.01, 0.01, 0.04));
  const Tool tool = mesh_tool({{&plate, 12}});
  EXPECT_NEAR(first_contact_m(slim, tool, at(Vec3(0.03, 0.01, 0.5)), down).value(), 0.459, 1e-11);
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(0.2, Vec3::UnitY()));
  // Tilted, the plate touches a corner of the body: its lower face z = -t / cos - x tan in the plate's middle plane.
  const double touch_z_m = 0.04 + 0.001 / std::cos(0.2) + 0.005 * std::tan(0.2);
  EXPECT_NEAR(first_contact_m(slim, tool, at(Vec3(0, 0, 0.5), tilted), down).value(), 0.5 - touch_z_m, 1e-10);
  // Of two balls the lower one touches, although its centre is beside the body.
  const Sphere high(Vec3(0, 0, 0.03), 0.005), low(Vec3(0.02, 0, 0), 0.005);
  const Tool pair = mesh_tool({{&high, 3200}, {&low, 3200}});
  EXPECT_NEAR(first_contact_m(slim, pair, at(Vec3(-0.02, 0, 0.5)), down).value(), 0.455, 1e-9);
  EXPECT_NEAR(first_contact_m(slim, pair, at(Vec3(0, 0, 0.5)), down).value(), 0.485, 1e-9);
  EXPECT_FALSE(first_contact_m(slim, pair, at(Vec3(0.02, 0, 0.5)), down));
}

TEST(FirstContact, LeavesNoEarlierContactForAnyBodyAndTool) {
  const std::vector<std::shared_ptr<const Shape>> bodies = {
      std::make_shared<Box>(cube_body), std::make_shared<Sphere>(Vec3(0, 0, 0.03), 0.03),
      std::make_shared<Ellipsoid>(Vec3(0, 0, 0.02), Vec3(0.05, 0.03, 0.02)),
      std::make_shared<Revolution>(cylinder_profile(0.03, 0.05, 0.006), Vec3(0, 0, 0.025))};
  Tool cylinder = tool_of(ToolShape::cylinder, 0.008, 0.03);
  cylinder.edge_radius_m = 0.001;
  const Sphere ball(Vec3(0.02, 0, 0), 0.006);
  const Box bar(Vec3(-0.01, 0, 0), Vec3(0.01, 0.02, 0.04));
  const std::vector<Tool> tools = {tool_of(ToolShape::sphere, 0.01), tool_of(ToolShape::capsule, 0.006, 0.02), cylinder,
                                   box_shaped_tool(Vec3(0.02, 0.01, 0.03)), mesh_tool({{&ball, 300}, {&bar, 12}})};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  int met = 0, passed = 0;
  for (const auto& body : bodies) {
    for (const Tool& tool : tools) {
      for (int trial = 0; trial < 25; ++trial) {
        const Vec3 direction = Vec3(any(random), any(random), any(random)).normalized();
        const Eigen::Quaterniond turned(
            Eigen::AngleAxisd(3.0 * any(random), Vec3(any(random), any(random), any(random)).normalized()));
        const Pose pose{Vec3(0.06 * any(random), 0.06 * any(random), 0.03 + 0.06 * any(random)), turned};
        const auto gap_after_m = [&](double along_m) {
          return gap_m(*body, tool, {pose.position_m + along_m * direction, turned});
        };
        const std::optional<double> touch_m = first_contact_m(*body, tool, pose, direction);
        const double last_m = touch_m ? *touch_m - 1e-6 : 0.3;
        for (int i = 0; i <= 100; ++i) {
          const double along_m = last_m - 0.3 * i / 50.0;
          ASSERT_GT(gap_after_m(along_m), 0.0) << static_cast<int>(tool.shape) << " at " << along_m;
        }
        if (touch_m) {
          EXPECT_NEAR(gap_after_m(*touch_m), 0.0, 3e-9) << static_cast<int>(tool.shape);
        }
        ++(touch_m ? met : passed);
      }
    }
  }
  EXPECT_GT(met, 150);
  EXPECT_GT(passed, 60);
}

const std::string head = R"([body]
shape = "box"
size_m = [0.06, 0.06, 0.06]
[body.material]
youngs_modulus_pa = 3.0e6
poissons_ratio = 0.5
[tool]
shape = "sphere"
radius_m = 0.010
[contact]
k1_n_per_m = 40
k3_n_per_m3 = 3e8
)";

std::string track(const std::string& first, const std::string& second) {
  return "[[track]]\ntime_s = 0.0\n" + first + "\n[[track]]\ntime_s = 1.0\n" + second + "\n";
}

const std::string by_depth = head + track("position_m = [0.0, 0.0]\ndepth_m = -0.0005",  //
                                          "position_m = [0.0, 0.0]\ndepth_m = 0.005");

std::string refusal(const std::string& text, const std::vector<std::string>& set = {}) {
  try {
    (void)parse_scene(text, "a.toml", set);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TrackByDepth, IsTheSameSceneAsTheHeightsItComesTo) {
  const Scene by_height =
      parse_scene(head + track("position_m = [0.0, 0.0, 0.0705]", "position_m = [0.0, 0.0, 0.065]"), "a.toml");
  EXPECT_EQ(scene_hash(parse_scene(by_depth, "a.toml")), scene_hash(by_height));
  // The smaller tool starts as far above and moves as deep.
  const Scene small = parse_scene(by_depth, "a.toml", {"tool.radius_m=0.004", "track[1].depth_m=0.002"});
  EXPECT_EQ(small.track[0].pose.position_m.z(), 0.0645);
  EXPECT_EQ(small.track[1].pose.position_m.z(), 0.062);
}

TEST(TrackByDepth, GoesAlongADirection) {
  const Scene side = parse_scene(head + track("position_m = [0.0, 0.0, 0.03]\ndepth_m = -0.01\ndirection = [2, 0, 0]",
                                              "position_m = [0.0, 0.0, 0.03]\ndepth_m = 0.001\ndirection = [2, 0, 0]"),
                                 "a.toml");
  EXPECT_EQ(side.track[0].pose.position_m, Vec3(-0.05, 0.0, 0.03));
  EXPECT_EQ(side.track[1].pose.position_m, Vec3(-0.039, 0.0, 0.03));
}

TEST(TrackByDepth, ResolvedSceneHasTheSamePosesBitForBit) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    const auto number = [&] { return std::to_string(any(random)); };
    const std::string row = "position_m = [0.001, 0.002, 0.03]\ndirection = [" + number() + ", " + number() +
                            ", -1.5]\norientation_wxyz = [1.0, " + number() + ", " + number() + ", " + number() +
                            "]\ndepth_m = ";
    const Scene scene = parse_scene(head + track(row + "-0.001", row + "0.002"), "a.toml",
                                    {"tool.shape=cylinder", "tool.length_m=0.03"});
    const Scene again = parse_scene(resolved_toml(scene), "a.toml");
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(again.track[i].pose.position_m, scene.track[i].pose.position_m);
      EXPECT_EQ(again.track[i].pose.orientation.coeffs(), scene.track[i].pose.orientation.coeffs());
    }
    EXPECT_EQ(scene_hash(again), scene_hash(scene));
  }
}

TEST(TrackByDepth, BothNeitherAndNowhereAreRefusedAtTheirPlace) {
  const std::string flat = "position_m = [0.0, 0.0]", full = "position_m = [0.0, 0.0, 0.065]";
  EXPECT_EQ(refusal(head + track(full, full + "\ndepth_m = 0.001")),
            "a.toml:19:11: track[1].depth_m: the height is given twice, by depth_m and by the third number of "
            "position_m; expected position_m = [0.0, 0.0] with depth_m, or position_m alone");
  EXPECT_EQ(refusal(head + track(flat, full)),
            "a.toml:15:14: track[0].position_m: the height is missing; expected a third number, or depth_m beside "
            "[0.0, 0.0]");
  EXPECT_THAT(refusal(head + track(full, "depth_m = 0.001")),
              HasSubstr("track[1].position_m: missing; expected three"));
  EXPECT_THAT(refusal(head + track(full + "\ndirection = [0, 0, -1]", full)),
              HasSubstr("a.toml:16:13: track[0].direction: only applies with depth_m"));
  EXPECT_THAT(refusal(head + track(full + "\ndirection = [0, 0, 0]\ndepth_m = 0.0", full)),
              HasSubstr("direction: is zero; expected a non-zero length"));
  EXPECT_THAT(refusal(head + track(flat + "\ndirection = [1, 0, -1]\ndepth_m = 0.0", full)),
              HasSubstr("track[0].position_m: a direction that is not vertical needs a point of its line"));
  EXPECT_EQ(
      refusal(by_depth, {"track[1].position_m=[0.05, 0.0]"}),
      "a.toml:20:11: track[1].depth_m: moved straight down the tool never touches the body; expected x and y above "
      "the body");
  EXPECT_THAT(refusal(head + track(full, full + "\ndepth_m = 0.001\ndirection = [0, 0, 1]\n"),
                      {"track[1].position_m=[0.05, 0.0, 0.0]"}),
              HasSubstr("the tool never touches the body along this direction"));
  EXPECT_THAT(refusal(by_depth, {"track[0].depth_m=0.001"}), HasSubstr("the tool starts 1 mm inside the body"));
  EXPECT_THAT(refusal(by_depth, {"track[0].depth_m=deep"}), HasSubstr("expected a number in"));
}

class DepthFileTest : public testing::Test {
 protected:
  DepthFileTest() { std::filesystem::create_directories(folder_); }
  ~DepthFileTest() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path written(const std::string& text, const std::string& name) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string read_csv(const std::string& csv) {
    written(csv, "t.csv");
    try {
      track_ = parse_scene(head + "[track]\nfile = \"t.csv\"\n", folder_ / "a.toml").track;
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  std::vector<Waypoint> track_;
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("depth-" + std::to_string(::getpid()));
};

TEST_F(DepthFileTest, ATableMayHaveDepthsInPlaceOfHeights) {
  EXPECT_EQ(read_csv("time_s,depth_m,x_m,y_m\n0,-0.0005,0,0\n1,0.003,0.01,0\n2,0.003,0.036,0\n"), "no error");
  ASSERT_EQ(track_.size(), 3u);
  EXPECT_EQ(track_[0].pose.position_m, Vec3(0, 0, 0.0705));
  EXPECT_EQ(track_[1].pose.position_m, Vec3(0.01, 0, 0.067));
  EXPECT_NEAR(track_[2].pose.position_m.z(), 0.065, 1e-11);
  EXPECT_THAT(read_csv("time_s,depth_m,x_m,y_m\n0,-0.0005,0,0\n1,0.003,0.05,0\n"),
              HasSubstr("t.csv:3:1: track[1].depth_m: moved straight down the tool never touches the body"));
  EXPECT_THAT(read_csv("time_s,x_m,y_m,z_m,depth_m\n"), HasSubstr("the header has both z_m and depth_m"));
}

TEST(NoContact, SaysTheLeastGapAndWhen) {
  EXPECT_EQ(no_contact_warning(parse_scene(by_depth, "a.toml")), "");
  EXPECT_EQ(no_contact_warning(parse_scene(by_depth, "a.toml", {"track[1].depth_m=-0.0001"})),
            "the tool never touches the body on this track; the least gap is 0.1 mm, at 1 s, so every force is zero");
  // It moves over the middle of a ball, closest half way.
  const std::string over =
      "[body]\nshape = \"sphere\"\nradius_m = 0.03\nsupport_height_m = 0.005\n[body.material]\n"
      "youngs_modulus_pa = 3.0e6\npoissons_ratio = 0.5\n" +
      head.substr(head.find("[tool]"));
  const Scene passes =
      parse_scene(over + track("position_m = [-0.05, 0.0, 0.072]", "position_m = [0.05, 0.0, 0.072]"), "a.toml");
  EXPECT_THAT(no_contact_warning(passes), HasSubstr("the least gap is 2 mm, at 0.5 s"));
  // Between two recorded instants it is in contact.
  const Scene brief = parse_scene(over + track("position_m = [-0.05, 0.0, 0.069]", "position_m = [0.05, 0.0, 0.069]"),
                                  "a.toml", {"compare.instants=4"});
  EXPECT_THAT(no_contact_warning(brief),
              AllOf(HasSubstr("only between the 4 recorded instants"), HasSubstr("raise compare.instants")));
  EXPECT_EQ(no_contact_warning(
                parse_scene(over + track("position_m = [-0.05, 0.0, 0.069]", "position_m = [0.05, 0.0, 0.069]"),
                            "a.toml", {"compare.instants=5"})),
            "");
}

}  // namespace
}  // namespace touchstone::scene
