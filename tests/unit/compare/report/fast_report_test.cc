#include "compare/report/fast_report.h"

#include "compare/report/fast_drawings.h"
#include "fast/command/results.h"
#include "support/shipped_scenes.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace touchstone::compare {
namespace {

bool page_has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string content_of(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

/// Names of the folder's files with this extension, without it.
std::set<std::string> files(const std::filesystem::path& folder, const std::string& ending) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ending) names.insert(entry.path().stem().string());
  }
  return names;
}

struct Case {
  std::string scene;
  scene::Formulation formulation;
};
void PrintTo(const Case& it, std::ostream* out) { *out << it.scene; }

class FastReportOfAShippedScene : public ::testing::TestWithParam<Case> {};

TEST_P(FastReportOfAShippedScene, IsWholeAndHasWhatTheSceneHas) {
  const scene::Scene scene = test::shipped_scene(GetParam().scene, GetParam().formulation);
  const fast::Run run = fast::run(scene);
  const testing::TemporaryFolder folder;
  write_fast_report(folder.path(), scene, run, scene::make_manifest(scene, "touchstone fast"));

  const std::string html = content_of(folder.path() / "report.html");
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(html));
  EXPECT_FALSE(page_has(html, "not finite"));
  EXPECT_FALSE(page_has(html, "nothing to show"));
  EXPECT_FALSE(
      std::regex_search(html, std::regex("src\\s*=|href\\s*=\\s*\"[^#]|<(script \\w|link|iframe)\\b|url\\(|@import")));
  EXPECT_TRUE(page_has(html, GetParam().formulation == scene::Formulation::published ? "published formulation"
                                                                                     : "corrected formulation"));
  for (const scene::Figure& figure : fast::figures(run)) EXPECT_TRUE(page_has(html, figure.key)) << figure.key;
  // No figure is without its meaning.
  EXPECT_FALSE(page_has(html, "<td><br/>"));

  std::set<std::string> expected = {"force", "depth", "area", "section", "contact", "dent", "view"};
  const bool friction = scene.contact.friction.has_value();
  const bool several =
      std::any_of(run.instants.begin(), run.instants.end(), [](const auto& r) { return r.regions.size() > 1; });
  if (friction) expected.insert("friction");
  if (several) expected.insert("regions");
  // The scenes whose tool slides along the body are those with friction.
  if (friction) expected.insert({"path", "friction-path"});
  EXPECT_EQ(several, GetParam().scene == "compass-two-pins");
  EXPECT_EQ(files(folder.path(), ".svg"), expected);
  for (const std::string& name : expected) {
    const std::string svg = content_of(folder.path() / (name + ".svg"));
    EXPECT_TRUE(testing::is_well_formed(svg)) << name;
    EXPECT_LT(svg.size(), name == "view" ? 100'000u : 60'000u) << name;
  }
  EXPECT_EQ(page_has(html, "inclusion, at rest"), !scene.body.inclusions.empty());
  EXPECT_EQ(page_has(html, ">sliding</text>"), friction);
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const std::string& name : test::shipped_scenes()) all.push_back({name, scene::Formulation::corrected});
  for (const char* name : {"ball-on-cube-slide", "compass-two-pins", "ellipsoid-pvc-inside"}) {
    all.push_back({name, scene::Formulation::published});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, FastReportOfAShippedScene, ::testing::ValuesIn(cases()), [](const auto& it) {
  return test::test_name(it.param.scene) +
         (it.param.formulation == scene::Formulation::published ? "_published" : "_corrected");
});

TEST(FastReport, RemovesDrawingsOfAnEarlierRun) {
  testing::Sides sides = testing::pressed(4, 200);
  const testing::TemporaryFolder folder;
  scene::write_file(folder.path() / "mine.svg", "kept");
  auto& regions = sides.run.instants[2].regions;
  regions.push_back(regions[0]);
  regions[1].id = 1;
  write_fast_report(folder.path(), sides.scene, sides.run, sides.manifest);
  EXPECT_EQ(files(folder.path(), ".svg").count("regions"), 1u);
  regions.pop_back();
  write_fast_report(folder.path(), sides.scene, sides.run, sides.manifest);
  EXPECT_EQ(files(folder.path(), ".svg").count("regions"), 0u);
  EXPECT_EQ(files(folder.path(), ".svg").count("mine"), 1u);
  for (const std::string& name : files(folder.path(), ".svg")) {
    if (name == "mine") continue;
    EXPECT_EQ(std::count(drawing_names().begin(), drawing_names().end(), name), 1) << name;
  }
}

TEST(FastReport, SaysWhenTheToolNeverTouches) {
  testing::Sides sides = testing::pressed(3, 200);
  for (scene::InstantRecord& record : sides.run.instants) record.regions.clear();
  const std::string html = fast_report_html(sides.scene, sides.run, sides.manifest);
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_TRUE(page_has(html, "never touches the body"));
  EXPECT_FALSE(page_has(html, "<h2>Force</h2>"));
}

TEST(FastReport, ShowsStepTimesStatusPlanAndScene) {
  testing::Sides sides = testing::pressed(3, 200);
  const std::string html = fast_report_html(sides.scene, sides.run, sides.manifest);
  for (const char* part : {"11.2\u00a0µs", "14.9\u00a0µs", "21.7\u00a0µs", "<b>ok</b>", "contact detection", "left out",
                           "<h2>Force</h2>", "GNU 12.2.0"}) {
    EXPECT_TRUE(page_has(html, part)) << part;
  }
}

}  // namespace
}  // namespace touchstone::compare
