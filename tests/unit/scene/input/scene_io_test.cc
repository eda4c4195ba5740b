#include "scene/input/scene_io.h"

#include "scene/input/fields.h"
#include "scene/model/body_text.h"
#include "scene/model/solid_kinds.h"
#include "support/source_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <set>

namespace touchstone::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const std::string good = R"([body]
shape = "box"
size_m = [0.06, 0.06, 0.06]
[body.material]
youngs_modulus_pa = 3.0e6
poissons_ratio = 0.5
[tool]
shape = "sphere"
radius_m = 0.010
[[track]]
time_s = 0.0
position_m = [0.0, 0.0, 0.0705]
[[track]]
time_s = 1.0
position_m = [0.0, 0.0, 0.065]
[contact]
k1_n_per_m = 40
k3_n_per_m3 = 3e8
)";

/// The message for a scene text with one replacement.
std::string message_for(const std::string& from, const std::string& to, const std::vector<std::string>& set = {}) {
  std::string text = good;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  try {
    (void)parse_scene(text, "a.toml", set);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SceneFile, HoldsProbesAndKeepsThem) {
  const std::string probes =
      "[[probe]]\nname = \"top\"\nposition_m = [0, 0.03, 0.06]\n"
      "[[probe]]\nname = \"below\"\nposition_m = [0.001, 0, 0.05]\n";
  const Scene scene = parse_scene(good + probes, "a.toml");
  ASSERT_EQ(scene.probes.size(), 2u);
  EXPECT_EQ(scene.probes[1].name, "below");
  EXPECT_EQ(scene.probes[1].position_m, Vec3(0.001, 0.0, 0.05));
  const Scene again = parse_scene(resolved_toml(scene), "a.toml");
  ASSERT_EQ(again.probes.size(), 2u);
  EXPECT_EQ(again.probes[0].position_m, scene.probes[0].position_m);
  EXPECT_NE(scene_hash(scene), scene_hash(parse_scene(good, "a.toml")));
}

TEST(SceneFile, RefusesAProbeThatIsNotInTheBody) {
  const auto message = [](const std::string& probes) { return message_for("[contact]", probes + "[contact]"); };
  EXPECT_THAT(message("[[probe]]\nname = \"a\"\nposition_m = [0, 0, 0.061]\n"),
              AllOf(StartsWith("a.toml:18:"), HasSubstr("probe[0].position_m: is 1 mm outside the body at rest; "
                                                        "expected a point in it or on its surface: x in [-0.03, 0.03], "
                                                        "y in [-0.03, 0.03], z in [0, 0.06] m")));
  EXPECT_THAT(message("[[probe]]\nname = \"a\"\nposition_m = [0, 0, 0.05]\n"
                      "[[probe]]\nname = \"a\"\nposition_m = [0, 0, 0.04]\n"),
              AllOf(StartsWith("a.toml:20:"), HasSubstr("probe[1].name: \"a\" is the name of probe[0]")));
  EXPECT_THAT(message("[[probe]]\nname = \"a,b\"\nposition_m = [0, 0, 0.05]\n"), HasSubstr("without comma"));
  EXPECT_THAT(message("[[probe]]\nposition_m = [0, 0, 0.05]\n"),
              HasSubstr("probe[0].name: missing; expected a text, not empty"));
  EXPECT_THAT(message("[[probe]]\nname = \"a\"\nposition_m = [0, 0, 21]\n"),
              HasSubstr("probe[0].position_m = [0, 0, 21]; expected three numbers, each in [-20, 20] m"));
  EXPECT_THAT(message("[[probe]]\nname = \"a\"\nposition_m = [0, 0, 0.05]\nradius_m = 1\n"), HasSubstr("radius_m"));
}

TEST(SceneFile, ANamedShapeIsABodyOfRevolution) {
  const std::string box = "shape = \"box\"\nsize_m = [0.06, 0.06, 0.06]";
  std::string text = good;
  text.replace(text.find(box), box.size(), "shape = \"cylinder\"\nradius_m = 0.03\nlength_m = 0.06");
  const Scene s = parse_scene(text, "a.toml");
  EXPECT_EQ(s.body.shape, BodyShape::revolution);
  EXPECT_TRUE(s.body.flat_bottom());
  const std::unique_ptr<const Shape> body = body_shape(s.body);
  EXPECT_NEAR(body->volume_m3(), 3.141592653589793 * 0.03 * 0.03 * 0.06, 1e-15);
  EXPECT_NEAR(body->bounds().lower_m.z(), 0.0, 1e-15);
  const std::string resolved = resolved_toml(s);
  EXPECT_THAT(resolved, AllOf(HasSubstr("shape = \"cylinder\""), HasSubstr("length_m = 0.06")));
  EXPECT_EQ(scene_hash(parse_scene(resolved, "a.toml")), scene_hash(s));
  EXPECT_THAT(message_for("shape = \"box\"", "shape = \"cylinder\"\nradius_m = 0.03"),
              AllOf(HasSubstr("body.length_m: missing"), HasSubstr("body.size_m: only applies with")));
}

// What stored results are found by: it must stay as it is.
TEST(BodyText, IsOfEveryKindOfSolid) {
  Body body;
  body.size_m = body.semi_axes_m = Vec3(1.0, 2.0, 4.0);
  body.radius_m = 1.0;
  body.length_m = 2.0;
  body.profile = {{{0.0, 0.0}, {1.0, 1.0}, {0.0, 2.0}}, {0.0, 3.0}};
  body.support_height_m = 0.5;
  body.material = {1e6, 0.5};
  const std::string held = "held below 0.5\n";
  const std::vector<std::string> expected = {"box 1 2 4\n", "sphere 1\n" + held, "ellipsoid 1 2 4\n" + held,
                                             "revolution (0 0) (1 1) (0 2) 0 3\n" + held,
                                             "revolution ( 0 -1) ( 1 -1) (1 1) (0 1) 0 0 0\n"};
  ASSERT_EQ(solid_kinds().size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    const SolidKind& kind = solid_kinds()[k];
    EXPECT_TRUE(kind.named() || kind.shape == static_cast<BodyShape>(k)) << kind.word;
    body.shape = kind.shape;
    body.named = kind.named() ? kind.word : "";
    complete(body);
    EXPECT_EQ(&kind_of(body), &kind);
    EXPECT_EQ(body_text(body), "body " + expected[k] + "E 1000000 nu 0.5\n");
  }
}

TEST(SceneFile, ReadsValuesAndFillsDefaults) {
  const Scene s = parse_scene(good, "dir/a.toml");
  EXPECT_EQ(s.name, "a");
  EXPECT_EQ(s.body.size_m, Vec3::Constant(0.06));
  EXPECT_EQ(s.body.material.poissons_ratio, 0.5);
  EXPECT_EQ(s.contact.k1_n_per_m, 40.0);
  EXPECT_EQ(s.fast.formulation, Formulation::corrected);
  EXPECT_EQ(s.fast.triangles, 3952);
  EXPECT_FALSE(s.reference.element_size_m.has_value());
  ASSERT_EQ(s.track.size(), 2u);
  EXPECT_EQ(s.track[1].pose.position_m.z(), 0.065);
}

TEST(SceneFile, LengthsWithoutAValueFollowTheBodysSize) {
  const FastSettings cube = parse_scene(good, "a.toml").fast;
  EXPECT_EQ(parse_scene(good, "a.toml").contact.r_th_m, 0.004);
  EXPECT_EQ(cube.r_R_m, 0.015);
  EXPECT_EQ(cube.C_r_m, 0.002);
  EXPECT_EQ(cube.s_c_m2, 0.001);
  // A body of eight times the volume is twice as large.
  const std::vector<std::string> slab = {"body.size_m=[0.12, 0.12, 0.12]", "track[0].position_m=[0, 0, 0.1305]",
                                         "track[1].position_m=[0, 0, 0.125]"};
  const Scene larger = parse_scene(good, "a.toml", slab);
  EXPECT_EQ(larger.contact.r_th_m, 0.008);
  EXPECT_EQ(larger.fast.r_R_m, 0.03);
  EXPECT_EQ(larger.fast.C_r_m, 0.004);
  EXPECT_EQ(larger.fast.s_c_m2, 0.004);
  EXPECT_EQ(scene_hash(parse_scene(resolved_toml(larger), "a.toml")), scene_hash(larger));
  // Given values stay, and the others still follow the body.
  std::vector<std::string> given = slab;
  given.push_back("contact.r_th_m=0.005");
  EXPECT_EQ(parse_scene(good, "a.toml", given).contact.r_th_m, 0.005);
  EXPECT_EQ(parse_scene(good, "a.toml", given).fast.r_R_m, 0.03);
}

TEST(SceneFile, EveryFaultNamesItsPlaceAndWhatWasExpected) {
  EXPECT_EQ(message_for("radius_m = 0.010", "radios_m = 0.010"),
            "a.toml:7:1: tool.radius_m: missing; expected a number in [1e-05, 10] m\n"
            "a.toml:9:1: unknown key \"tool.radios_m\"; did you mean \"tool.radius_m\"?");
  EXPECT_EQ(message_for("= 0.5\n", "= 0.51\n"),
            "a.toml:6:18: body.material.poissons_ratio = 0.51; expected a number in [0, 0.5]");
  EXPECT_EQ(message_for("3.0e6", "nan"),
            "a.toml:5:21: body.material.youngs_modulus_pa = nan; expected a number in (0, 1e+13] Pa");
  EXPECT_EQ(message_for("3.0e6", "\"stiff\""),
            "a.toml:5:21: body.material.youngs_modulus_pa = \"stiff\"; expected a number in (0, 1e+13] Pa");
  EXPECT_THAT(message_for("[0.0, 0.0, 0.0705]", "[0.0, nan, 0.0705]"),
              AllOf(StartsWith("a.toml:12:14: track[0].position_m"), HasSubstr("three numbers")));
  EXPECT_THAT(message_for("\"box\"", "\"bax\""),
              HasSubstr("a.toml:2:9: body.shape = \"bax\"; expected \"box\" or \"sphere\""));
  EXPECT_THAT(message_for("[body]\n", "[body]\nradius_m = 0.1\n"),
              HasSubstr("body.radius_m: only applies with body.shape = \"sphere\""));
  EXPECT_THAT(message_for("[body]\n", "[body\n"), AllOf(StartsWith("a.toml:1:6: "), HasSubstr("not valid TOML")));
  EXPECT_THAT(message_for("[tool]", "[tol]"), HasSubstr("unknown key \"tol\"; did you mean \"tool\"?"));
  EXPECT_EQ(message_for("position_m = [0.0, 0.0, 0.065]", "position_m = [0.0, 0.0, 0.065]\nspeed = 3"),
            "a.toml:16:1: unknown key \"track[1].speed\"; did you mean \"time_s\"?");
}

TEST(SceneFile, ATrackMayStartWhereTheToolJustTouches) {
  EXPECT_EQ(message_for("0.0705", "0.06999999999999999"), "no error");  // 1e-17 m inside
  EXPECT_THAT(message_for("0.0705", "0.069999"), HasSubstr("the tool starts 0.001 mm inside the body"));
}

TEST(SceneFile, RulesAcrossKeysAreReportedAtTheKey) {
  EXPECT_EQ(
      message_for("0.0705", "0.069"),
      "a.toml:12:14: track[0].position_m: the tool starts 1 mm inside the body; expected a first pose with no overlap");
  EXPECT_EQ(message_for("time_s = 1.0", "time_s = -1.0"),
            "a.toml:14:10: track[1].time_s: time runs backwards: -1 s after 0 s; expected a time above 0 s");
  EXPECT_THAT(
      message_for("3e8", "-1e7"),
      HasSubstr("a.toml:18:15: contact.k3_n_per_m3: the softening law peaks at 1.155 mm but the track reaches 5 mm"));
  EXPECT_EQ(message_for("3e8", "-5e5"), "no error");
  EXPECT_THAT(message_for("k1_n_per_m = 40\nk3_n_per_m3 = 3e8", "k1_n_per_m = 0\nk3_n_per_m3 = 0"),
              HasSubstr("there is no force"));
  EXPECT_THAT(message_for("[tool]", "[fast]\nC_n = 0.9\n[tool]"),
              HasSubstr("a.toml:8:7: fast.C_n: the local factor turns negative"));
  EXPECT_EQ(message_for("[tool]", "[fast]\nC_n = 0.9\nformulation = \"published\"\n[tool]"), "no error");
}

TEST(SceneFile, TheResponseModelIsRefusedWhereItCannotAnswer) {
  const std::string fast = "[fast]\nformulation = \"response\"\n";
  EXPECT_EQ(message_for("[tool]", fast + "[tool]"), "no error");
  EXPECT_EQ(message_for("[tool]", fast + "[contact.friction]\nK = 1.0\nbeta = 1.0\nmu_D = 0.5\n[tool]"), "no error");
  EXPECT_THAT(message_for("[tool]\nshape = \"sphere\"\nradius_m = 0.010",
                          fast + "[tool]\nshape = \"box\"\nsize_m = [0.02, 0.02, 0.02]"),
              HasSubstr("a.toml:8:15: fast.formulation: the response model needs that its tool is a ball"));
}

TEST(SceneFile, AllFaultsComeAtOnceInOrder) {
  try {
    (void)parse_scene("a = 1\n[body]\nshape = 3\n[tool]\nshape = \"cube\"\n", "b.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_GE(error.faults().size(), 6u);
    for (std::size_t i = 1; i < error.faults().size(); ++i)
      EXPECT_GE(error.faults()[i].line, error.faults()[i - 1].line);
  }
}

TEST(SceneFile, OverridesComeLastAndAreNamedInErrors) {
  EXPECT_EQ(parse_scene(good, "a.toml",
                        {"fast.formulation=published", "tool.radius_m=0.02",
                         "track=[{time_s=0,position_m=[0,0,1]},{time_s=1,position_m=[0,0,2]}]"})
                .tool.radius_m,
            0.02);
  EXPECT_EQ(message_for("= 0.5", "= 0.5", {"fast.C_m=1"}),
            "--set fast.C_m=1: unknown key \"fast.C_m\"; did you mean \"fast.C_n\"?");
  EXPECT_THAT(message_for("= 0.5", "= 0.5", {"fast.triangles=1.5"}), HasSubstr("a whole number in [12, 100000]"));
  EXPECT_THAT(message_for("= 0.5", "= 0.5", {"nonsense"}), HasSubstr("expected key=value"));
}

TEST(SceneFile, AFormerNameIsRefusedWithItsNewName) {
  const std::string message = "fast.r_th_m is contact.r_th_m now, because the reference reads it too";
  EXPECT_EQ(message_for("[tool]", "[fast]\nr_th_m = 0.004\n[tool]"), "a.toml:8:1: " + message);
  EXPECT_EQ(message_for("[tool]", "[fast]\nC_n = 0.1\nr_th_m = \"wide\"\n[tool]"), "a.toml:9:1: " + message);
  EXPECT_EQ(message_for("[tool]", "[tool]", {"fast.r_th_m=0.004"}), "--set fast.r_th_m=0.004: " + message);
  // Every new name is a key, and no earlier one.
  EXPECT_EQ(message_for("[tool]", "[tool]", {"contact.r_th_m=0.004"}), "no error");
  EXPECT_EQ(former_name_message("contact.r_th_m"), "");
}

TEST(SceneFile, ResolvedSceneLoadsToTheSameScene) {
  const Scene s =
      parse_scene(good, "a.toml", {"reference.element_size_m=0.00123456789012345", "title=\"say \\\"hi\\\"\""});
  const std::string resolved = resolved_toml(s);
  EXPECT_EQ(resolved_toml(parse_scene(resolved, "a.toml")), resolved);
  const std::string explained = explained_toml(s);
  EXPECT_EQ(resolved_toml(parse_scene(explained, "a.toml")), resolved);
  EXPECT_THAT(explained, HasSubstr("# Young's modulus E of the body.\n"));
}

TEST(SceneHash, FollowsValuesButNotTheTitle) {
  const std::string hash = scene_hash(parse_scene(good, "a.toml"));
  EXPECT_EQ(hash.size(), 32u);
  EXPECT_EQ(scene_hash(parse_scene("title = \"x\"\n" + good, "b.toml")), hash);
  for (const char* change :
       {"fast.C_n=0.1", "body.material.poissons_ratio=0.3", "compare.instants=7", "contact.k1_n_per_m=41"}) {
    EXPECT_NE(scene_hash(parse_scene(good, "a.toml", {change})), hash) << change;
  }
}

class TrackFile : public testing::Test {
 protected:
  std::string message(const std::string& csv) {
    std::ofstream(dir_ / "t.csv") << csv;
    const std::string rows = good.substr(good.find("[[track]]"), good.find("[contact]") - good.find("[[track]]"));
    std::string text = good;
    text.replace(text.find(rows), rows.size(), "[track]\nfile = \"t.csv\"\n");
    try {
      track_ = parse_scene(text, dir_ / "a.toml").track;
    } catch (const InputError& error) {
      std::string out = error.what();
      const std::string prefix = (dir_ / "t.csv").string();
      EXPECT_THAT(out, StartsWith(prefix));
      return out.substr(prefix.size());
    }
    return "no error";
  }
  void SetUp() override {
    dir_ = std::filesystem::path(testing::TempDir()) /
           ("track-" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    std::filesystem::remove_all(dir_);
    std::filesystem::create_directories(dir_);
  }
  void TearDown() override { std::filesystem::remove_all(dir_); }
  std::filesystem::path dir_;
  std::vector<Waypoint> track_;
};

TEST_F(TrackFile, ReadsPosesInAnyColumnOrder) {
  EXPECT_EQ(message("# made by hand\ntime_s,z_m,x_m,y_m\n0,0.08,0,0\r\n0.5, 0.066 ,0.001,-0.002\n"), "no error");
  ASSERT_EQ(track_.size(), 2u);
  EXPECT_EQ(track_[1].pose.position_m, Vec3(0.001, -0.002, 0.066));
  EXPECT_EQ(message("time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.08,2,0,0,0\n1,0,0,0.07,0,0,1,0\n"), "no error");
  EXPECT_EQ(track_[0].pose.orientation.w(), 1.0);
}

TEST_F(TrackFile, FaultsNameLineAndColumn) {
  EXPECT_EQ(message("time_s,x_m,y_m,z_m\n0,0,0,0.08\n1,0,zero,0.07\n"),
            ":3:5: \"zero\" for y_m; expected a number in [-1000, 1000] m");
  EXPECT_EQ(message("time_s,x_m,y_m,z_m\n0,0,0,0.08\n1,0,0,nan\n"),
            ":3:7: \"nan\" for z_m; expected a number in [-1000, 1000] m");
  EXPECT_EQ(message("time_s,x_m,y_m,z_m\n0,0,0,0.08\n1,0,0\n"), ":3:1: expected 4 values, found 3");
  EXPECT_THAT(message("time_s,x,y_m,z_m\n"), HasSubstr(":1:8: unknown or repeated column \"x\""));
  EXPECT_THAT(message("time_s,x_m,y_m\n"), HasSubstr("misses columns"));
  EXPECT_THAT(message("qw,qx,qy,qz\n"), HasSubstr("misses time or position"));
  EXPECT_THAT(message(""), HasSubstr("the track is empty"));
  EXPECT_THAT(message("time_s,x_m,y_m,z_m\n0,0,0,0.08\n"), HasSubstr("at least two poses"));
  EXPECT_THAT(message("time_s,x_m,y_m,z_m\n1,0,0,0.08\n0,0,0,0.07\n"),
              HasSubstr(":3:1: track[1].time_s: time runs backwards"));
  EXPECT_THAT(message("time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.08,0,0,0,0\n"), HasSubstr("norm in [0.5, 2]"));
}

TEST_F(TrackFile, MissingFileIsOneClearMessage) {
  std::filesystem::create_directories(dir_ / "t.csv");
  std::string text = good;
  const std::string rows = good.substr(good.find("[[track]]"), good.find("[contact]") - good.find("[[track]]"));
  text.replace(text.find(rows), rows.size(), "[track]\nfile = \"t.csv\"\n");
  try {
    (void)parse_scene(text, dir_ / "a.toml");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), (dir_ / "a.toml").string() + ":11:8: track.file: cannot read " + (dir_ / "t.csv").string() +
                                ": it is a folder; expected a CSV file of at most 256 MiB");
  }
}

TEST(Fields, EveryDefaultIsInItsOwnRange) {
  // Reading a scene that gives nothing optional takes every default through the same check as a file.
  EXPECT_NO_THROW((void)parse_scene(good, "a.toml"));
  std::set<std::string_view> keys;
  for (const auto& field : scene_fields()) {
    EXPECT_TRUE(keys.insert(field.key).second) << field.key;
    EXPECT_FALSE(field.doc.empty()) << field.key;
    // A unit is part of the key's name, so that a file cannot be misread. The unit of K depends on beta.
    if (field.key == "contact.friction.K") continue;
    EXPECT_TRUE(field.unit.empty() || field.key.find('_') != std::string_view::npos) << field.key;
  }
}

TEST(Fields, WhatMayBeTunedIsAConstantOrAChoiceOfTheFastModel) {
  std::set<std::string_view> names, shared;
  for (const auto& field : scene_fields()) {
    if (!field.tunable) continue;
    EXPECT_TRUE(fast_reads(field.side)) << field.key;
    if (reference_reads(field.side)) shared.insert(field.key);
    EXPECT_EQ(std::holds_alternative<Choice<Scene>>(field.access), field.tunable->stage == TuningStage::model)
        << field.key;
    EXPECT_TRUE(field.tunable->stage == TuningStage::model || std::holds_alternative<double& (*)(Scene&)>(field.access))
        << field.key;
    for (const std::string_view name :
         {field.key, field.tunable->per_mass ? field.tunable->per_mass->key : std::string_view("")}) {
      if (name.empty()) continue;
      EXPECT_TRUE(names.insert(name).second) << name;
      EXPECT_EQ(tunable_field(name), &field) << name;
    }
  }
  EXPECT_EQ(tunable_field("contact.r_th_m"), nullptr);
  EXPECT_EQ(tunable_field(""), nullptr);
  // Using these values makes a stored reference stale; reports/tuning.md and every file with them say so.
  EXPECT_THAT(shared, testing::ElementsAre("contact.friction.K", "contact.friction.beta", "contact.friction.mu_D"));
}

TEST(Documentation, SceneReferenceIsTheTable) {
  std::ifstream in(source_folder() + "/reports/scene-reference.md");
  std::stringstream text;
  text << in.rdbuf();
  EXPECT_THAT(text.str(), HasSubstr(scene_reference_markdown()))
      << "reports/scene-reference.md is not the table of fields.cc; rewrite it with: touchstone --scene-reference";
}

class IncludeTest : public testing::Test {
 protected:
  IncludeTest() : dir_(std::filesystem::temp_directory_path() / ("include-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(dir_);
  }
  ~IncludeTest() override { std::filesystem::remove_all(dir_); }
  void write(const std::string& text) { std::ofstream(dir_ / "parameters.toml") << text; }
  [[nodiscard]] Scene read(const std::string& more = "") const {
    return parse_scene("include = \"parameters.toml\"\n" + more + good, dir_ / "scene.toml");
  }
  [[nodiscard]] std::string refusal(const std::string& more = "") const {
    try {
      (void)read(more);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::filesystem::path dir_;
};

TEST_F(IncludeTest, AFormerNameIsRefusedWhereItStands) {
  write("[contact]\nk3_n_per_m3 = 1e8\n[fast]\nr_th_m = 0.004\n");
  EXPECT_EQ(refusal(), (dir_ / "parameters.toml").string() +
                           ":4:1: fast.r_th_m is contact.r_th_m now, because the reference reads it too");
}

TEST_F(IncludeTest, GivesWhatTheSceneDoesNotSay) {
  write("[fast]\ns_c_m2 = 0.5\n[contact]\nk1_n_per_m = 77.0\n");
  const Scene alone = parse_scene(good, "a.toml");
  ASSERT_NE(alone.fast.s_c_m2, 0.5);
  EXPECT_EQ(read().fast.s_c_m2, 0.5);
  // The scene's own value has precedence, and --set over both.
  EXPECT_EQ(read().contact.k1_n_per_m, alone.contact.k1_n_per_m);
  EXPECT_EQ(
      parse_scene("include = \"parameters.toml\"\n" + good, dir_ / "scene.toml", {"fast.s_c_m2=0.25"}).fast.s_c_m2,
      0.25);
}

TEST_F(IncludeTest, TellsAFaultInTheFileItStandsIn) {
  const std::string included = (dir_ / "parameters.toml").string();
  write("[fast]\ns_c_m2 = -1.0\n");
  EXPECT_THAT(refusal(), HasSubstr(included + ":2:10: fast.s_c_m2 = -1.0; expected a number in"));
  write("[fast]\ns_d_m2 = 1.0\n");
  EXPECT_THAT(refusal(), HasSubstr(included + ":2:1: unknown key"));
  write("[fast\n");
  EXPECT_THAT(refusal(), HasSubstr(included + ":1"));
  write("include = \"other.toml\"\n");
  EXPECT_THAT(refusal(), HasSubstr("scene.toml:1:11: include: " + included + " includes another file"));
  std::filesystem::remove(dir_ / "parameters.toml");
  EXPECT_THAT(refusal(), HasSubstr("scene.toml:1:11: include: cannot read " + included));
}

TEST(ShippedScenes, GiveTheLengthsThatHaveNoFixedDefault) {
  // So no default can change published figures, nor the keys of stored references.
  const std::string folder = source_folder();
  for (const char* place : {"/meshes/scenes", "/tests/gates/scenes"}) {
    for (const auto& entry : std::filesystem::directory_iterator(folder + place)) {
      if (entry.path().extension() != ".toml") continue;
      std::ifstream in(entry.path());
      std::stringstream text;
      text << in.rdbuf();
      for (const char* key : {"\nr_th_m = ", "\nr_R_m = ", "\nC_r_m = ", "\ns_c_m2 = "})
        EXPECT_THAT(text.str(), HasSubstr(key)) << entry.path();
    }
  }
}

TEST(ShippedScenes, AllLoad) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/meshes/scenes")) {
    if (entry.path().extension() != ".toml") continue;
    EXPECT_NO_THROW((void)load_scene(entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace touchstone::scene
