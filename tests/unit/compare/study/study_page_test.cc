// The page of a study whose cases are run by a command that only writes figures.
#include "compare/study/study_page.h"

#include "compare/study/study_parameters.h"
#include "compare/study/study_run.h"
#include "compare/study/study_table.h"
#include "fast/command/command_line.h"
#include "scene/base/files.h"
#include "scene/input/scene_io.h"
#include "scene/output/results.h"
#include "support/source_folder.h"
#include "support/temporary_folder.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <regex>

namespace touchstone::compare {
namespace {

using std::filesystem::path;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class StudyPage : public ::testing::Test {
 protected:
  StudyManifest expanded(const std::string& rest) {
    const path file = folder_.path() / "study.toml";
    std::ofstream(file) << "title = \"How deep & how soft\"\nscene = \"" << source_folder()
                        << "/meshes/scenes/ball-on-cube-press.toml\"\nrun = \"compare\"\n"
                        << rest;
    return expand(load_study(file), folder_.path() / "study", "/usr/bin/touchstone", "store");
  }
  /// Runs every case: a force error of 1 % for each 0.01 of C_n, and an uncertainty of 0.2 %, unknown above C_n = 0.25.
  std::string page_of(const StudyManifest& manifest) {
    (void)run_cases(
        manifest, {},
        [](const path& scene_file, const path& result) -> int {
          const scene::Scene scene = scene::load_scene(scene_file);
          if (scene.fast.C_n > 0.35) {
            std::cerr << "C_n is far too large\n";
            return fast::not_converged;
          }
          const bool known = scene.fast.C_n < 0.25;
          scene::write_summary(result / "summary.json",
                               {{"force.nrmse", scene.fast.C_n, "", ""},
                                {"force.nrmse_uncertainty", known ? 0.002 : std::nan(""), known ? "" : "unknown", ""}});
          scene::write_file(result / "report.html", "a report");
          return fast::done;
        },
        [](const std::string&) {});
    (void)collect(manifest);
    return scene::read_file(manifest.folder / "report.html").value();
  }
  static std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  }

  testing::TemporaryFolder folder_;
};

TEST_F(StudyPage, DrawsOneAxisAsALineWithBars) {
  const StudyManifest manifest = expanded("[[axis]]\nkey = \"fast.C_n\"\nvalues = [0.3, 0.1, 0.2]\n");
  const std::string html = page_of(manifest);
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(html));
  EXPECT_THAT(html, HasSubstr("<h1>How deep &amp; how soft</h1>"));
  EXPECT_THAT(html, HasSubstr("<title>Force error over C_n</title>"));
  EXPECT_EQ(count(html, "class=\"bar\""), 2u);
  EXPECT_EQ(count(html, "class=\"unknown\""), 1u);
  EXPECT_THAT(html, HasSubstr("Hollow marks: its uncertainty is unknown."));
  EXPECT_THAT(html, HasSubstr("unknown in 1 of 3 cases"));
  EXPECT_THAT(html, HasSubstr("from 10\u00a0% ± 0.2\u00a0% (fast.C_n = 0.1) to 30\u00a0% ± unknown (fast.C_n = 0.3)"));
  // Sorted along the axis, whatever the order of the cases.
  const std::regex path_of("<path d=\"M([0-9.]+) [0-9.]+L([0-9.]+) [0-9.]+L([0-9.]+) ");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(html, found, path_of));
  EXPECT_LT(std::stod(found[1]), std::stod(found[2]));
  EXPECT_LT(std::stod(found[2]), std::stod(found[3]));
}

TEST_F(StudyPage, NamesItsCasesInTheStudysOrderAndLinksThemWithinItsFolder) {
  const StudyManifest manifest = expanded("[[axis]]\nkey = \"fast.C_n\"\nvalues = [0.3, 0.1, 0.2]\n");
  const std::string html = page_of(manifest);
  std::size_t before = 0;
  for (const ManifestCase& one : manifest.cases) {
    const std::size_t at = html.find("href=\"results/" + one.id + "/report.html\">" + std::to_string(one.index) + ". " +
                                     one.name + "</a>");
    EXPECT_NE(at, std::string::npos) << one.name;
    EXPECT_GT(at, before);
    before = at;
    EXPECT_EQ(count(html, one.id), 1u) << "a hash is for links, not for people";
  }
  EXPECT_THAT(html, Not(HasSubstr(folder_.path().string())));
}

TEST_F(StudyPage, DrawsTwoAxesOverEitherAndAsATable) {
  const std::string html =
      page_of(expanded("[[axis]]\nkey = \"fast.C_n\"\nvalues = [0.1, 0.2]\n[[axis]]\nname = \"depth\"\nkey = "
                       "\"track[1].position_m[2]\"\nvalues = [0.068, 0.065]\nlabels = [\"2 mm\", \"5 mm\"]\n"));
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_THAT(html, HasSubstr("<title>Force error over C_n</title>"));
  EXPECT_THAT(html, HasSubstr("<title>Force error over depth</title>"));
  EXPECT_THAT(html, HasSubstr(">depth [mm]</text>"));
  EXPECT_THAT(html, HasSubstr(">depth = 5 mm</text>"));
  EXPECT_THAT(html, HasSubstr(">C_n = 0.1</text>"));
  EXPECT_EQ(count(html, "style=\"background:rgb("), 4u) << "a colour for each pair";
  EXPECT_THAT(html, HasSubstr("<th>2\u00a0mm</th>"));
}

TEST_F(StudyPage, HasAColumnForEachKeyThatVariesFromCaseToCase) {
  const StudyManifest manifest = expanded(
      "[[case]]\nname = \"as it is\"\nset = {}\n[[case]]\nname = \"sharper\"\nset = { fast.C_n = 0.1 }\n"
      "[[case]]\nname = \"stiffer\"\nset = { fast.C_n = 0.1, body.material.youngs_modulus_pa = 5.0e6, tool.mass_kg = "
      "1.0 "
      "}\n");
  const std::vector<StudyParameter> parameters = study_parameters(manifest);
  ASSERT_EQ(parameters.size(), 2u) << "the mass is what the scene has";
  EXPECT_EQ(parameters[0].name, "fast.C_n");
  EXPECT_THAT(parameters[0].values, ElementsAre("0.2", "0.1", "0.1"));
  EXPECT_EQ(parameters[1].name, "body.material.youngs_modulus_pa");
  EXPECT_THAT(parameters[1].numbers, ElementsAre(3.0e6, 3.0e6, 5.0e6));
  const std::string html = page_of(manifest);
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_THAT(html, HasSubstr(">youngs_modulus_pa</th>"));
  EXPECT_THAT(html, HasSubstr(". stiffer</a>"));
  const std::string csv = scene::read_file(manifest.folder / "summary.csv").value();
  EXPECT_THAT(csv, HasSubstr(",wall_s,fast.C_n,body.material.youngs_modulus_pa,force.nrmse,"));
}

TEST_F(StudyPage, PutsACaseBesideTheAxesWhereItsValueIsOnThem) {
  const StudyManifest manifest = expanded(
      "[[axis]]\nname = \"local\"\nkey = \"fast.C_n\"\nvalues = [0.1, 0.2]\nlabels = [\"weak\", \"strong\"]\n[[case]]\n"
      "name = \"soft\"\nset = { fast.C_n = 0.1, body.material.youngs_modulus_pa = 1e6 }\n");
  const std::vector<StudyParameter> parameters = study_parameters(manifest);
  ASSERT_EQ(parameters.size(), 2u);
  EXPECT_THAT(parameters[0].values, ElementsAre("weak", "strong", "weak"));
  EXPECT_THAT(parameters[1].numbers, ElementsAre(3.0e6, 3.0e6, 1.0e6));
  EXPECT_THAT(page_of(manifest), HasSubstr("<td>soft</td>"));
}

TEST_F(StudyPage, ShowsCasesThatDifferInWordsOnlyAsRows) {
  const std::string html =
      page_of(expanded("[[axis]]\nkey = \"contact.law\"\nvalues = [\"duffing\"]\n[[axis]]\n"
                       "key = \"fast.formulation\"\nvalues = [\"published\", \"corrected\"]\n"));
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_THAT(html, Not(HasSubstr("<title>Force error over")));
  EXPECT_EQ(count(html, "<circle "), 2u);
  EXPECT_THAT(html, HasSubstr("<td>contact.law = duffing, fast.formulation = published</td>"));
}

TEST_F(StudyPage, SaysWhichCasesAreNotDoneAndWhy) {
  const std::string html = page_of(expanded("[[axis]]\nkey = \"fast.C_n\"\nvalues = [0.1, 0.4]\n"));
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_THAT(html, HasSubstr("1 of 2 cases done; what varies: C_n."));
  EXPECT_THAT(html, HasSubstr("failed: C_n is far too large"));
}

TEST_F(StudyPage, KeepsTheNumbersOfAnAxisApart) {
  const std::vector<StudyParameter> parameters =
      study_parameters(expanded("[[axis]]\nkey = \"fast.C_n\"\nvalues = [0.100001, 0.100002]\n"));
  EXPECT_THAT(parameters[0].distinct(), ElementsAre("0.100001", "0.100002"));
  EXPECT_THAT(parameters[0].numbers, ElementsAre(0.100001, 0.100002));
}

}  // namespace
}  // namespace touchstone::compare
