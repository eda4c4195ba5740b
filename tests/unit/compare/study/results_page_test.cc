#include "compare/study/results_page.h"

#include "compare/comparison/compare.h"
#include "scene/base/error.h"
#include "scene/input/scene_io.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ResultsPage : public ::testing::Test {
 protected:
  /// A result folder of the synthetic sides.
  ResultFolder make(const std::string& name, const std::function<void(testing::Sides&)>& change = nullptr) {
    testing::Sides sides = testing::pressed(5, 200);
    sides.manifest.command = "touchstone compare";
    sides.manifest.resolved_scene = scene::resolved_toml(sides.scene);
    if (change) change(sides);
    const std::filesystem::path folder = folder_.path() / name;
    std::filesystem::create_directories(folder);
    (void)write_comparison(folder, sides.scene, sides.run, sides.result, sides.manifest, {});
    return read_result_folder(folder);
  }

  testing::TemporaryFolder folder_;
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST_F(ResultsPage, IsWellFormedAndLinksEveryResultRelatively) {
  const std::string html = results_page_html({make("a b/x"), make("c/x")}, folder_.path() / "pages");
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(html));
  // Once in the table, once at the picture; the folder's space encoded, equal names made unique.
  EXPECT_EQ(count(html, "href=\"../a%20b/x/report.html\""), 2u);
  EXPECT_EQ(count(html, "href=\"../c/x/report.html\""), 2u);
  EXPECT_EQ(count(html, "src=\"../c/x/shape.svg\""), 1u);
  EXPECT_THAT(html, HasSubstr(">a b/x<"));
  EXPECT_THAT(html, HasSubstr(">c/x<"));
  EXPECT_FALSE(std::regex_search(html, std::regex("(src|href)=\"(https?:)?/")));
}

TEST_F(ResultsPage, KeepsTheTitleOfAMeshToolsResultThatWasMoved) {
  const testing::Sides sides = testing::pressed_by_mallet(folder_.path() / "inputs");
  std::filesystem::create_directories(folder_.path() / "made");
  (void)write_comparison(folder_.path() / "made", sides.scene, sides.run, sides.result, sides.manifest, {});
  std::filesystem::remove_all(folder_.path() / "inputs");
  std::filesystem::rename(folder_.path() / "made", folder_.path() / "moved");
  const ResultFolder result = read_result_folder(folder_.path() / "moved");
  const scene::Scene scene = scene::parse_scene(result.resolved_scene, result.folder / "manifest.json");
  EXPECT_EQ(scene::scene_hash(scene), result.scene_hash);
  EXPECT_THAT(results_page_html({result}, folder_.path()),
              HasSubstr(">A mallet's head pressed on a rubber cube (paper, Fig. 15)</a>"));
}

TEST_F(ResultsPage, CallsTheCasesOfAStudyByTheirNamesInItsOrder) {
  const std::filesystem::path study = folder_.path() / "study";
  std::filesystem::create_directories(study);
  scene::write_file(study / "manifest.json",
                    R"({"format": 1, "kind": "sweep", "name": "s", "title": "", "run": "compare",
    "axes": [], "cases": [{"index": 1, "id": "fff", "name": "soft", "along": {}, "set": {}},
                          {"index": 2, "id": "aaa", "name": "stiff", "along": {}, "set": {}}]})");
  const ResultFolder stiff = make("study/results/aaa"), soft = make("study/results/fff"), other = make("other");
  const std::string html = results_page_html({other, stiff, soft}, folder_.path());
  const auto place = [&](const std::string& name) { return html.find("class=\"under\">" + name + "<"); };
  EXPECT_LT(place("other"), place("soft"));
  EXPECT_LT(place("soft"), place("stiff"));
  EXPECT_NE(place("stiff"), std::string::npos);
  EXPECT_EQ(place("aaa"), std::string::npos);
  EXPECT_THAT(html, HasSubstr(">stiff</text>")) << "the legend";
  // With two equal studies, which of them.
  std::filesystem::copy(study, folder_.path() / "again", std::filesystem::copy_options::recursive);
  const std::string both =
      results_page_html({soft, read_result_folder(folder_.path() / "again/results/fff")}, folder_.path());
  EXPECT_THAT(both, HasSubstr(">study: soft<"));
  EXPECT_THAT(both, HasSubstr(">again: soft<"));
}

TEST_F(ResultsPage, SaysWhichErrorsCannotBeDistinguished) {
  const std::string apart = results_page_html({make("apart")}, folder_.path());
  EXPECT_EQ(count(apart, "class=\"under\">not distinguishable<"), 0u);
  const ResultFolder equal = make("equal", [](testing::Sides& sides) {
    for (std::size_t t = 0; t < sides.run.instants.size(); ++t) sides.run.instants[t] = sides.result.instants[t];
  });
  // Force, its peak, and shape.
  EXPECT_EQ(count(results_page_html({equal}, folder_.path()), "class=\"under\">not distinguishable<"), 3u);
}

TEST_F(ResultsPage, SaysWhereTheUncertaintyIsUnknown) {
  const ResultFolder result = make("unknown", [](testing::Sides& sides) {
    testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                     std::numeric_limits<double>::quiet_NaN());
  });
  const std::string html = results_page_html({result}, folder_.path());
  EXPECT_THAT(html, HasSubstr("± unknown"));
  EXPECT_EQ(count(html, "class=\"under\">not distinguishable<"), 0u);
  EXPECT_FALSE(testing::shows_not_a_number(html));
}

TEST_F(ResultsPage, DrawsBothSidesOfEveryResultInItsColour) {
  std::vector<ResultFolder> results;
  for (int i = 0; i < 8; ++i) results.push_back(make("r" + std::to_string(i)));
  const std::string html = results_page_html(results, folder_.path());
  // Six colours: the seventh result begins a second pair of plots.
  EXPECT_EQ(count(html, "<title>Force over the track, relative</title>"), 2u);
  const std::regex curve("<path d=\"[^\"]*\" fill=\"none\" stroke=\"#0072b2\"( [^>]*)?/>");
  const auto lines = std::distance(std::sregex_iterator(html.begin(), html.end(), curve), std::sregex_iterator());
  EXPECT_EQ(lines, 2 * 2 * 2);
}

TEST_F(ResultsPage, RefusesWhatIsNoComparison) {
  const ResultFolder fast = make("fast", [](testing::Sides& s) { s.manifest.command = "touchstone fast"; });
  try {
    (void)results_page_html({make("good"), fast}, folder_.path());
    FAIL() << "was accepted";
  } catch (const scene::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr((folder_.path() / "fast" / "manifest.json").string()));
    EXPECT_THAT(error.what(), HasSubstr("touchstone fast"));
    EXPECT_THAT(error.what(), Not(HasSubstr("good")));
  }
}

TEST_F(ResultsPage, NamesVersionsThatDiffer) {
  const auto versioned = [&](const std::string& version) {
    return make(version, [&](testing::Sides& s) { s.manifest.entries[0].second = version; });
  };
  const ResultFolder first = versioned("1.0"), second = versioned("2.0");
  EXPECT_THAT(results_page_html({first, second}, folder_.path()), HasSubstr("different versions"));
  EXPECT_THAT(results_page_html({first, first}, folder_.path()), Not(HasSubstr("different versions")));
}

}  // namespace
}  // namespace touchstone::compare
