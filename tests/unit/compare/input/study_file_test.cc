// Study files: their cases, and the messages about faulty ones.
#include "compare/input/study_file.h"

#include "scene/input/scene_io.h"
#include "support/source_folder.h"
#include "unit/compare/input/study_file_test.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace touchstone::compare {
namespace {

using namespace scene;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string base = source_folder() + "/meshes/scenes/ball-on-cube-press.toml";
const std::string head = "scene = \"" + base + "\"\nrun = \"fast\"\n";

class StudyTest : public StudyFileTest {
 protected:
  Study read(const std::string& text) { return load_study(written(text)); }
  std::string refusal(const std::string& text) {
    return refusal_of([&] { (void)load_cases(read(text)); });
  }
};

std::vector<std::string> names(const Study& study) {
  std::vector<std::string> list;
  for (const StudyCase& one : study.cases) list.push_back(one.name);
  return list;
}

TEST_F(StudyTest, AxesAreCrossedAndCasesStandBeside) {
  const Study study = read(head + R"(
[set]
fast.triangles = 500
[[axis]]
key = "fast.C_n"
values = [0.0, 0.25]
[[axis]]
name = "place"
labels = ["middle", "off"]
[axis.zip]
"track[0].position_m[0]" = [0.0, 0.01]
"track[1].position_m[0]" = [0.0, 0.01]
[[case]]
name = "stiff"
set = { body.material.youngs_modulus_pa = 1e9, fast.triangles = 12 }
)");
  EXPECT_THAT(study.axes, ElementsAre("fast.C_n", "place"));
  EXPECT_THAT(names(study), ElementsAre("fast.C_n = 0.0, place = middle", "fast.C_n = 0.0, place = off",
                                        "fast.C_n = 0.25, place = middle", "fast.C_n = 0.25, place = off", "stiff"));
  const std::vector<Scene> scenes = load_cases(study);
  ASSERT_EQ(scenes.size(), 5u);
  const Scene plain = load_scene(base);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(scenes[k].fast.triangles, 500);
    EXPECT_EQ(scenes[k].fast.C_n, k < 2 ? 0.0 : 0.25);
    for (const std::size_t row : {0, 1}) {
      const Vec3 shift_m = scenes[k].track[row].pose.position_m - plain.track[row].pose.position_m;
      EXPECT_EQ(shift_m, Vec3(k % 2 == 0 ? 0.0 : 0.01, 0.0, 0.0));
    }
  }
  EXPECT_EQ(scenes[4].fast.triangles, 12);
  EXPECT_EQ(scenes[4].fast.C_n, plain.fast.C_n);
  EXPECT_EQ(scenes[4].body.material.youngs_modulus_pa, 1e9);
}

TEST_F(StudyTest, RangesEndWhereTheySayAndStepEvenly) {
  const auto values = [&](const std::string& range) {
    std::vector<double> list;
    for (const StudyCase& one : read(head + "[[axis]]\nkey = \"fast.C_n\"\nrange = " + range + "\n").cases) {
      list.push_back(std::stod(one.settings.at(0).value));
    }
    return list;
  };
  const std::vector<double> linear = values("{ from = 0.1, to = 0.7, count = 4 }");
  ASSERT_EQ(linear.size(), 4u);
  EXPECT_EQ(linear.front(), 0.1);
  EXPECT_EQ(linear.back(), 0.7);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_NEAR(linear[i] - linear[i - 1], 0.2, 1e-15);
  const std::vector<double> log = values("{ from = 1e-3, to = 1.0, count = 4, spacing = \"log\" }");
  ASSERT_EQ(log.size(), 4u);
  EXPECT_EQ(log.front(), 1e-3);
  EXPECT_EQ(log.back(), 1.0);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_NEAR(log[i] / log[i - 1], 10.0, 1e-12);
  // A range of whole numbers with whole steps stays whole, as keys with whole values need.
  const Study whole = read(head + "[[axis]]\nkey = \"fast.triangles\"\nrange = { from = 100, to = 300, count = 3 }\n");
  EXPECT_EQ(load_cases(whole).at(1).fast.triangles, 200);
}

TEST_F(StudyTest, EveryFaultHasItsPlaceAndWhatWasExpected) {
  EXPECT_THAT(
      refusal("scene = \"x.toml\"\nrun = \"fsat\"\n"),
      HasSubstr("2:7: run = \"fsat\"; expected \"fast\" or \"reference\" or \"compare\"; did you mean \"fast\"?"));
  EXPECT_THAT(refusal("run = \"fast\"\n"), HasSubstr("scene: missing"));
  EXPECT_THAT(refusal(head + "kind = \"tune\"\n"), HasSubstr("3:8: kind = \"tune\"; expected \"sweep\""));
  EXPECT_THAT(refusal(head), HasSubstr("no case; expected [[axis]] or [[case]] rows"));
  EXPECT_THAT(refusal(head + "axes = 1\n"), HasSubstr("3:1: unknown key \"axes\"; did you mean \"axis\"?"));
  EXPECT_THAT(refusal(head + "[[axis]]\nkey = \"fast.C_n\"\nvalue = [1]\n"),
              HasSubstr("5:1: unknown key \"axis.value\"; did you mean \"axis.values\"?"));
  EXPECT_THAT(refusal(head + "[[axis]]\nkey = \"fast.C_n\"\nvalues = []\n"),
              HasSubstr("5:10: axis.values: expected a"));
  EXPECT_THAT(refusal(head + "[[axis]]\nkey = \"fast.C_n\"\n"), HasSubstr("3:1: axis: no values; expected one of"));
  EXPECT_THAT(
      refusal(head + "[[axis]]\nkey = \"fast.C_n\"\nrange = { from = 0, to = 1, count = 3, spacing = \"log\" }\n"),
      HasSubstr("axis.range.from: expected a number above 0"));
  EXPECT_THAT(refusal(head + "[[axis]]\nkey = \"fast.C_n\"\nrange = { from = 0, to = 1, count = 1 }\n"),
              HasSubstr("axis.range.count: expected a whole number in [2, 100000]"));
  EXPECT_THAT(refusal(head + "[[axis]]\nname = \"a\"\nzip = { fast.C_n = [1, 2], fast.C_r_m = [1] }\n"),
              HasSubstr("1 values; expected 2 like the other keys of its axis"));
  EXPECT_THAT(refusal(head + "[[axis]]\nkey = \"fast.C_n\"\nvalues = [1, 2]\nlabels = [\"a\"]\n"),
              HasSubstr("6:10: axis.labels: expected 2 texts"));
  EXPECT_THAT(refusal(head + "[[case]]\nset = { fast.C_n = 1 }\n"), HasSubstr("3:1: case.name: missing"));
  EXPECT_THAT(refusal(head + "[[case]]\nname = \"a\"\n[[case]]\nname = \"a\"\n"),
              HasSubstr("two cases are called \"a\""));
  EXPECT_THAT(refusal("scene = ]"), HasSubstr("not valid TOML"));
  EXPECT_THAT(refusal("scene = \"none.toml\"\nrun = \"fast\"\n[[case]]\nname = \"a\"\n"),
              HasSubstr("none.toml: cannot read the scene"));
}

TEST_F(StudyTest, ABadValueIsToldOnceWhereTheStudyGivesIt) {
  // Two values out of range and an unknown key, in a grid where each occurs twice.
  const std::string said = refusal(head + R"([[axis]]
key = "body.material.poissons_ratio"
values = [0.3, 0.6, 0.7]
[[axis]]
key = "fast.C_nn"
values = [1.0, 2.0]
)");
  EXPECT_THAT(said, HasSubstr("5:16: body.material.poissons_ratio = 0.6; expected a number in [0, 0.5] (case \"body."));
  EXPECT_THAT(said, HasSubstr("5:21: body.material.poissons_ratio = 0.7; expected"));
  EXPECT_THAT(said, HasSubstr("8:11: unknown key \"fast.C_nn\"; did you mean \"fast.C_n\"?"));
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 3) << said;
}

TEST_F(StudyTest, AFaultOfSeveralKeysNamesTheCase) {
  EXPECT_THAT(
      refusal(head + "[[axis]]\nkey = \"track[0].position_m[2]\"\nvalues = [0.0705, 0.065]\nlabels = [\"a\", \"b\"]\n"),
      testing::AllOf(HasSubstr("starts 5 mm inside the body"), HasSubstr("(case \"track[0].position_m[2] = b\")")));
}

TEST(SceneOverride, SetsAnElementOrSaysThatThereIsNone) {
  const Scene scene = load_scene(base, {"track[1].position_m[2]=0.066", "track[0].time_s=-1.0"});
  EXPECT_EQ(scene.track[1].pose.position_m, Vec3(0.0, 0.0, 0.066));
  EXPECT_EQ(scene.track[0].time_s, -1.0);
  EXPECT_EQ(load_scene(base, {"track[0].orientation_wxyz=[0.0, 1.0, 0.0, 0.0]"}).track[0].pose.orientation.x(), 1.0);
  for (const char* setting : {"track[2].position_m[2]=0.1", "track[0].position_m[3]=0.1", "tool.radius_m[0]=0.1",
                              "track[x].time_s=1.0", "[0]=1"}) {
    try {
      (void)load_scene(base, {setting});
      ADD_FAILURE() << setting << " accepted";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("--set " + std::string(setting))) << setting;
    }
  }
  try {
    (void)load_scene(base, {"track[0].position_m[2]=high"});
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("track[0].position_m = [0.0, 0.0, \"high\"]; expected three numbers"));
  }
}

TEST(ShippedStudies, HaveScenesWithoutFault) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/meshes/studies")) {
    if (entry.path().extension() != ".toml") continue;
    std::ifstream in(entry.path());
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    if (text.find("kind = \"tuning\"") != std::string::npos) continue;  // tuning_study_test.cc
    ++count;
    EXPECT_GT(load_cases(load_study(entry)).size(), 1u) << entry.path();
  }
  EXPECT_GT(count, 0);
}

TEST(StudyFile, AFolderIsNoStudy) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path();
  try {
    (void)load_study(folder);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()),
              folder.string() + ": cannot read the study: it is a folder; expected a TOML file of at most 4 MiB");
  }
}

TEST_F(StudyTest, DepthAndRadiusAreTwoAxes) {
  const std::filesystem::path scene = file_.string() + ".scene.toml";
  std::ofstream(scene) << R"([body]
shape = "box"
size_m = [0.06, 0.06, 0.06]
[body.material]
youngs_modulus_pa = 3.0e6
poissons_ratio = 0.5
[tool]
shape = "sphere"
radius_m = 0.010
[contact]
k1_n_per_m = 1000.0
k3_n_per_m3 = 0.0
[[track]]
time_s = 0.0
position_m = [0.0, 0.0]
depth_m = -0.0005
[[track]]
time_s = 1.0
position_m = [0.0, 0.0]
depth_m = 0.005
)";
  const std::vector<Scene> scenes = load_cases(read("scene = \"" + scene.string() + R"("
run = "fast"
[[axis]]
key = "tool.radius_m"
values = [0.005, 0.01]
[[axis]]
key = "track[1].depth_m"
values = [0.001, 0.004]
)"));
  std::filesystem::remove(scene);
  ASSERT_EQ(scenes.size(), 4u);
  const double heights_m[] = {0.064, 0.061, 0.069, 0.066};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(scenes[k].track[1].pose.position_m.z(), heights_m[k]);
    EXPECT_EQ(scenes[k].track[0].pose.position_m.z(), k < 2 ? 0.0655 : 0.0705);
  }
}

TEST(ValueIn, FindsAKeyAsItIsSpeltForSet) {
  const std::string text =
      "[body.material]\nyoungs_modulus_pa = 3e6\n[contact]\nlaw = \"duffing\"\n"
      "[[track]]\nposition_m = [0.0, 0.1, 0.2]\n[[track]]\nposition_m = [0.3, 0.4, 0.5]\n";
  EXPECT_EQ(value_in(text, "a.toml", "body.material.youngs_modulus_pa"), "3e+06");
  EXPECT_EQ(value_in(text, "a.toml", "contact.law"), "\"duffing\"");
  EXPECT_EQ(value_in(text, "a.toml", "track[1].position_m[2]"), "0.5");
  EXPECT_EQ(value_in(text, "a.toml", "track[2].position_m[2]"), std::nullopt);
  EXPECT_EQ(value_in(text, "a.toml", "place"), std::nullopt);
  EXPECT_THROW((void)value_in("a = ", "a.toml", "a"), InputError);
}

}  // namespace
}  // namespace touchstone::compare
