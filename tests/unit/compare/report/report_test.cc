#include "compare/report/report.h"
#include "compare/format/page.h"

#include "compare/errors/compute_errors.h"
#include "compare/errors/figures.h"
#include "fast/command/results.h"
#include "fast/step/state.h"
#include "support/synthetic.h"
#include "support/xml.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <regex>

namespace touchstone::compare {
namespace {

using testing::count_of;
using testing::report_of;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The page without the content of its scripts.
std::string markup_of(const std::string& html) {
  std::string out;
  std::size_t from = 0;
  for (std::size_t at = html.find("<script"); at != std::string::npos; at = html.find("<script", from)) {
    at = html.find('>', at) + 1;
    out += html.substr(from, at - from);
    from = html.find("</script>", at);
  }
  return out + html.substr(from);
}

TEST(Report, IsWellFormedAndShowsNoBadNumber) {
  const std::string html = report_of(testing::pressed(5, 600));
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(markup_of(html)));
}

TEST(Report, NeedsNothingFromElsewhere) {
  const std::string html = report_of(testing::pressed(5, 600));
  const std::string markup = markup_of(html);
  EXPECT_FALSE(std::regex_search(markup, std::regex("src\\s*=|href\\s*=\\s*\"[^#]", std::regex::icase)));
  EXPECT_FALSE(std::regex_search(markup, std::regex("<(link|iframe|object|embed|base)\\b", std::regex::icase)));
  EXPECT_FALSE(std::regex_search(markup, std::regex("url\\(|@import", std::regex::icase)));
  EXPECT_TRUE(has(markup, "default-src 'none'"));
}

TEST(Report, TablesEveryFigureThatAppliesWithItsMeaning) {
  const testing::Sides sides = testing::pressed(5, 600);
  const std::string html = report_of(sides);
  for (const scene::Figure& figure : make_figures(compute_errors(sides.scene, sides.run, sides.result.instants),
                                                  sides.result, fast::figures(sides.run))) {
    if (figure.text.starts_with("undefined")) {
      EXPECT_FALSE(has(html, ">" + figure.key + "<")) << figure.key;
      continue;
    }
    const bool in_table = has(html, "<code>" + figure.key + "</code>") || has(html, "title=\"" + figure.key + "\"");
    EXPECT_TRUE(in_table) << figure.key;
  }
}

TEST(Report, ShowsCurvesPicturesLevelsPlansAndScene) {
  testing::Sides sides = testing::pressed(5, 600);
  sides.manifest.resolved_scene += "# 1 < 2 & 3\n";
  const std::string html = report_of(sides);
  for (const char* part : {"Force over depth", "Force over time", "Relative force error over depth",
                           "Shape error over depth", "reference's uncertainty", "Around the contact", ">Fast model<",
                           "Force over depth, both", "quarter 3D u-p finite strain", "CHOLMOD with OpenBLAS",
                           "4f1c09a7d2be55aa4f1c09a7d2be55aa", "GNU 12.2.0", "8 anchor points, the corners of the box",
                           "tool and track lie on both symmetry planes", "left out", "# 1 &lt; 2 &amp; 3"}) {
    EXPECT_TRUE(has(html, part)) << part;
  }
  // Three levels; the second's force is 1.006 / 0.982 of the first's.
  EXPECT_TRUE(has(html, "2.44\u00a0%"));
}

TEST(Report, DoesNotStretchTheLogarithmicAxesToAGrazingInstant) {
  // With 23 instants one of them touches only by round-off.
  const testing::Sides sides = testing::pressed(23, 200);
  ASSERT_GT(sides.result.instants[2].depth_m, 0.0);
  ASSERT_LT(sides.result.instants[2].depth_m, grazing_depth_m);
  EXPECT_FALSE(has(report_of(sides), ">1 × 10⁻"));
}

TEST(Report, MarksWhatCannotBeDistinguished) {
  testing::Sides sides = testing::pressed(5, 600);
  EXPECT_FALSE(has(report_of(sides), "<td>not distinguishable</td>"));
  for (std::size_t t = 0; t < 5; ++t) sides.run.instants[t] = sides.result.instants[t];
  EXPECT_TRUE(has(report_of(sides), "<td>not distinguishable</td>"));
}

TEST(Report, OfAReferenceWithoutABandIsStillWhole) {
  testing::Sides sides = testing::pressed(5, 600);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  for (scene::ReferenceInstant& instant : sides.result.instants) {
    Eigen::VectorXd& u = instant.displacement_uncertainty_m;
    u.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  const std::string html = report_of(sides);
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(markup_of(html)));
  EXPECT_FALSE(has(markup_of(html), "not finite"));
  EXPECT_TRUE(has(html, "<b>unknown</b>"));
  // Without a band none is named, and the caption says so.
  EXPECT_FALSE(has(html, ">reference's uncertainty<"));
  EXPECT_FALSE(has(html, ">reference's own uncertainty<"));
  EXPECT_FALSE(has(html, "narrower than"));
  EXPECT_TRUE(has(html, "The reference's uncertainty is unknown, so no band is drawn."));
}

TEST(Report, OfOneMeshSaysThatAnUncertaintyNeedsThree) {
  testing::Sides sides = testing::pressed(5, 600);
  sides.result.levels.resize(1);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(has(report_of(sides), "It was solved on one mesh, and an uncertainty needs three."));
}

/// The text below the first plot of this title.
std::string caption_of(const std::string& html, const std::string& title) {
  const std::size_t from = html.find("<figcaption>", html.find("<title>" + title + "</title>"));
  return html.substr(from, html.find("</figcaption>", from) - from);
}

TEST(Report, CaptionOfTheForceSaysWhyAnUncertaintyIsUnknown) {
  testing::Sides sides = testing::pressed(5, 600);
  sides.result.levels.resize(2);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n,
                   std::numeric_limits<double>::quiet_NaN());
  sides.result.refinement.why_ended = "there is no mesh 3: it would take about 31 GiB of memory";
  EXPECT_EQ(caption_of(report_of(sides), "Force over depth"),
            "<figcaption>The reference's uncertainty is unknown, so no band is drawn. It was solved on two meshes, and "
            "an uncertainty needs three. Refinement ended: there is no mesh 3: it would take about 31 GiB of memory.");
}

TEST(Report, CaptionOfTheForceSaysWhyTheErrorAskedForWasNotReached) {
  testing::Sides sides = testing::pressed(5, 600);
  sides.result.refinement.error_asked = 0.001;
  sides.result.refinement.why_ended = "there is no mesh 4: it would take 3 h";
  EXPECT_TRUE(has(caption_of(report_of(sides), "Force over depth"),
                  "The requested uncertainty of 0.1\u00a0% was not reached: there is no mesh 4: it would take 3 h."));
  sides.result.refinement.error_asked = 0.5;
  EXPECT_FALSE(has(report_of(sides), "not reached"));
}

TEST(Report, CaptionOfTheForceFollowsTheBand) {
  testing::Sides sides = testing::pressed(5, 600);
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n, 20.0);
  EXPECT_TRUE(has(report_of(sides), "The blue band is the reference's uncertainty."));
  testing::set_all(sides.result, &scene::ReferenceInstant::force_uncertainty_n, 0.01);
  EXPECT_TRUE(has(report_of(sides), "is narrower than its line."));
}

TEST(Report, DrawsTheContactsRadiusOrBothHalfAxesWhereThereIsContact) {
  testing::Sides sides = testing::pressed(5, 600);
  const auto& instants = sides.result.instants;
  const auto touching = static_cast<std::size_t>(
      std::ranges::count_if(instants, [](const auto& one) { return one.contact_half_axes_m[0] > 0.0; }));
  ASSERT_LT(touching, instants.size());
  const std::string round = report_of(sides);
  EXPECT_TRUE(has(round, "<title>Radius of the contact over depth</title>"));
  EXPECT_EQ(count_of(round, "<title>radius | "), touching);
  EXPECT_EQ(count_of(round, "<title>short | "), 0u);
  for (scene::ReferenceInstant& one : sides.result.instants) one.contact_half_axes_m[1] *= 0.5;
  const std::string narrow = report_of(sides);
  EXPECT_TRUE(has(narrow, "<title>Half axes of the contact over depth</title>"));
  EXPECT_EQ(count_of(narrow, "<title>long | "), touching);
  EXPECT_EQ(count_of(narrow, "<title>short | "), touching);
}

TEST(Report, DrawsOverTimeWhereADepthIsHeld) {
  testing::Sides sides = testing::pressed(5, 600);
  EXPECT_LT(report_of(sides).find("<title>Force over depth</title>"),
            report_of(sides).find("<title>Force over time</title>"));
  sides.result.instants[4].depth_m = sides.result.instants[3].depth_m;
  EXPECT_LT(report_of(sides).find("<title>Force over time</title>"),
            report_of(sides).find("<title>Force over depth</title>"));
}

TEST(Report, SaysAboveTheFoldWhyRefinementEnded) {
  testing::Sides sides = testing::pressed(5, 600);
  sides.result.refinement.why_ended = "there is no level 4: the time was up";
  const std::string html = report_of(sides);
  EXPECT_LT(html.find("there is no level 4: the time was up"), html.find("id=\"force\""));
}

TEST(Report, BeginsWithCardsTwoSentencesForceAndBodiesAndFoldsTheRest) {
  const std::string html = markup_of(report_of(testing::pressed(5, 600)));
  std::size_t from = 0;
  for (const char* part : {"<nav>", "class=\"tiles\"", "class=\"lead\"", "Force over depth", "Both bodies in space",
                           "class=\"bodies\"", "<section id=\"why\">"}) {
    from = html.find(part, from);
    ASSERT_NE(from, std::string::npos) << part;
  }
  for (const char* folded : {"All figures", "Every instant", "Settings"}) {
    EXPECT_TRUE(has(html, std::string("<summary><h2>") + folded + "</h2></summary>")) << folded;
    EXPECT_EQ(html.find(std::string("<h2>") + folded), html.rfind(std::string("<h2>") + folded));
  }
  // Every link of the contents leads somewhere.
  static const std::regex link("href=\"#([a-z-]+)\"");
  int links = 0;
  for (std::sregex_iterator it(html.begin(), html.end(), link), end; it != end; ++it, ++links) {
    EXPECT_TRUE(has(html, "id=\"" + (*it)[1].str() + "\"")) << (*it)[1];
  }
  EXPECT_GE(links, 8);
}

TEST(Report, ShowsItsOwnCommandAboveTheContents) {
  testing::Sides sides = testing::pressed(5, 600);
  EXPECT_FALSE(has(markup_of(report_of(sides)), "class=\"command\""));
  sides.manifest.entries.emplace_back("command_line", "touchstone compare a.toml --level 2");
  const std::string html = report_of(sides);
  EXPECT_LT(html.find("<code>touchstone compare a.toml --level 2</code>"), html.find("<nav>"));
}

TEST(Report, CardOfTheReferenceGivesTheUncertaintyOfForceAndShape) {
  const testing::Sides sides = testing::pressed(5, 600);
  const std::string html = report_of(sides);
  const std::size_t card =
      html.find("<span>Reference's uncertainty</span><b>2\u00a0%</b><span>of the force at the worst instant; shape ");
  ASSERT_NE(card, std::string::npos);
  EXPECT_LT(card, html.find("class=\"lead\""));
}

TEST(Report, GivesTheCommandToTypeNext) {
  testing::Sides sides = testing::pressed(5, 600);
  sides.run.status = static_cast<std::uint32_t>(fast::StepStatus::anchors_limited);
  const std::string html = report_of(sides);
  EXPECT_TRUE(has(html, "The beams were too soft for the force"));
  EXPECT_TRUE(has(html, "<pre>touchstone compare meshes/scenes/ball-on-cube-press.toml --level 3 --set fast.s_c_m2="));
}

TEST(Report, OfATrackWithoutContactIsStillWhole) {
  testing::Sides sides = testing::pressed(3, 600);
  for (std::size_t t = 0; t < 3; ++t) {
    scene::InstantRecord& r = sides.result.instants[t];
    r.depth_m = 0.0;
    r.regions.clear();
    r.displacement_m.setZero();
    sides.result.instants[t].force_uncertainty_n = 0.0;
    sides.result.instants[t].displacement_uncertainty_m.setZero();
    for (reference::LevelRecord& level : sides.result.levels) level.force_n[t] = 0.0;
    sides.run.instants[t] = r;
  }
  const std::string html = report_of(sides);
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(markup_of(html)));
  EXPECT_TRUE(has(html, "never touches the body"));
  EXPECT_TRUE(has(html, "Figures that are undefined in this scene are left out"));
}

TEST(Page, LeavesOutAPartWithoutContent) {
  const std::vector<Section> sections = {{"Why", "<p>x</p>"}, {"What to do next", ""}};
  EXPECT_EQ(contents(sections).find("What to do next"), std::string::npos);
  EXPECT_EQ(in_order(sections).find("What to do next"), std::string::npos);
  EXPECT_NE(in_order(sections).find("Why"), std::string::npos);
}

}  // namespace
}  // namespace touchstone::compare
