// A first scene from a few numbers: it loads, has the given values, and needs no constant.
#include "scene/input/new_scene.h"

#include "scene/model/area_law.h"

#include "scene/input/scene_io.h"
#include "scene/model/first_contact.h"
#include "scene/model/solid_kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace touchstone::scene {
namespace {

using testing::HasSubstr;
using testing::Not;

NewScene ball_on_block() {
  NewScene asked;
  asked.title = "A ball on a \"block\"";
  asked.body.size_m = Vec3(0.06, 0.05, 0.04);
  asked.body.material = {3.0e6, 0.45};
  asked.tool.radius_m = 0.01;
  asked.depth_m = 0.003;
  return asked;
}

Scene loaded(const NewScene& asked) { return parse_scene(new_scene_toml(asked, "a.toml"), "a.toml"); }

TEST(NewScene, SaysWhatWasAsked) {
  const Scene scene = loaded(ball_on_block());
  EXPECT_EQ(scene.title, "A ball on a \"block\"");
  EXPECT_EQ(scene.body.size_m, Vec3(0.06, 0.05, 0.04));
  EXPECT_EQ(scene.body.material.youngs_modulus_pa, 3.0e6);
  EXPECT_EQ(scene.body.material.poissons_ratio, 0.45);
  EXPECT_EQ(scene.tool.radius_m, 0.01);
  ASSERT_EQ(scene.track.size(), 2u);
  EXPECT_EQ(scene.track[0].pose.position_m, Vec3(0, 0, 0.0506));
  EXPECT_EQ(scene.track[1].pose.position_m, Vec3(0, 0, 0.047));
  EXPECT_EQ(no_contact_warning(scene), "");
  // One recorded instant every tenth of the depth.
  EXPECT_NEAR(pose_at(scene.track, instants_s(scene)[3]).position_m.z(), 0.0506 - 0.0009, 1e-12);
}

TEST(NewScene, TheLawFollowsFromTheMaterial) {
  NewScene asked = ball_on_block();
  const double flat = 2.0 * 3.0e6 / (1.0 - 0.45 * 0.45);
  const double rounded = area_law_constant_n_per_m2(asked.body.material, asked.tool, Formulation::corrected);
  EXPECT_NEAR(rounded, std::sqrt(0.5) * flat, 1e-4 * flat);
  EXPECT_NEAR(area_law_constant_n_per_m2(asked.body.material, asked.tool, Formulation::published), flat, 1e-4 * flat);
  const Scene scene = loaded(asked);
  EXPECT_EQ(scene.contact.law, ContactLaw::area_aware);
  // Exactly equal, or comparisons would list the scene beside the untuned model.
  EXPECT_EQ(scene.contact.k1_per_radius_n_per_m2, rounded);
  EXPECT_EQ(scene.fast.s_c_m2, stiff_beam_area_m2(asked.body));
  EXPECT_EQ(scene.contact.k3_n_per_m3, 0.0);
  for (const ToolShape shape : {ToolShape::cylinder, ToolShape::box}) {
    asked.tool.shape = shape;
    asked.tool.length_m = 0.02;
    asked.tool.size_m = Vec3(0.01, 0.02, 0.03);
    EXPECT_NEAR(loaded(asked).contact.k1_per_radius_n_per_m2, flat, 1e-4 * flat);
    EXPECT_THAT(new_scene_toml(asked, "a.toml"), Not(HasSubstr("* 0.707.")));
  }
}

TEST(NewScene, EveryBodyWithEveryTool) {
  for (const SolidKind& body : solid_kinds()) {
    for (const ToolShape tool : {ToolShape::sphere, ToolShape::capsule, ToolShape::cylinder, ToolShape::box}) {
      NewScene asked = ball_on_block();
      asked.body.shape = body.shape;
      asked.body.named = body.named() ? body.word : "";
      asked.body.radius_m = asked.body.length_m = 0.03;
      asked.body.semi_axes_m = Vec3(0.04, 0.05, 0.03);
      asked.body.profile.rz_m = {{0.0, 0.0}, {0.03, 0.0}, {0.03, 0.04}, {0.0, 0.04}};
      complete(asked.body);
      asked.tool.shape = tool;
      asked.tool.length_m = 0.02;
      asked.tool.size_m = Vec3(0.01, 0.01, 0.02);
      asked.place_m = {0.004, -0.002};
      asked.slide_m = 0.005;
      const Scene scene = loaded(asked);
      EXPECT_EQ(kind_of(scene.body).word, body.word);
      EXPECT_EQ(scene.tool.shape, tool);
      ASSERT_EQ(scene.track.size(), 3u);
      EXPECT_EQ(scene.track[0].pose.position_m.head<2>(), Eigen::Vector2d(0.004, -0.002));
      EXPECT_NEAR(scene.track[2].pose.position_m.x(), 0.009, 1e-15);
      const auto shape = body_shape(scene.body);
      for (const int row : {1, 2}) {
        const Pose& pose = scene.track[static_cast<std::size_t>(row)].pose;
        EXPECT_NEAR(*first_contact_m(*shape, scene.tool, pose, Vec3(0, 0, -1)), -0.003, 1e-9);
      }
    }
  }
}

TEST(NewScene, ShowsHowCoulombFrictionIsWritten) {
  NewScene asked = ball_on_block();
  EXPECT_FALSE(loaded(asked).contact.friction.has_value());
  // Without the comment signs the lines are valid in a scene.
  std::string text = new_scene_toml(asked, "a.toml");
  const std::size_t table = text.find("# [contact.friction]"), end = text.find("\n\n", table);
  std::string lines = text.substr(table, end - table);
  for (std::size_t at = 0; (at = lines.find("# ", at)) != std::string::npos; ++at) {
    if (at == 0 || lines[at - 1] == '\n') lines.erase(at, 2);
  }
  text.replace(table, end - table, lines);
  const auto friction = parse_scene(text, "a.toml").contact.friction;
  ASSERT_TRUE(friction.has_value());
  EXPECT_EQ(friction->K, 0.3);
  asked.friction = 0.25;
  const Scene rough = loaded(asked);
  ASSERT_TRUE(rough.contact.friction.has_value());
  EXPECT_EQ(rough.contact.friction->K, 0.25);
  EXPECT_EQ(rough.contact.friction->beta, 1.0);
  EXPECT_EQ(rough.contact.friction->mu_D, 0.25);
}

TEST(NewScene, NoLineIsLongerThanAPage) {
  NewScene asked = ball_on_block();
  asked.slide_m = 0.01;
  asked.body.radius_m = 0.03;
  asked.body.semi_axes_m = Vec3(0.04, 0.05, 0.03);
  for (const BodyShape body : {BodyShape::box, BodyShape::sphere, BodyShape::ellipsoid}) {
    asked.body.shape = body;
    if (body != BodyShape::box) asked.friction = 0.25;
    std::istringstream in(new_scene_toml(asked, "block.toml"));
    for (std::string line; std::getline(in, line);) {
      EXPECT_LE(line.size(), 100u) << line;
      EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
    }
  }
}

}  // namespace
}  // namespace touchstone::scene
