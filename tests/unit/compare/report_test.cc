#include "compare/report.h"

#include "compare/figures.h"
#include "synthetic.h"
#include "xml.h"

#include <gtest/gtest.h>

#include <limits>
#include <regex>

namespace touchstone::compare {
namespace {

std::string report_of(const testing::Sides& sides) {
  const Errors errors = compute_errors(sides.scene, sides.run, sides.result);
  const scene::Figures figures = make_figures(errors, sides.run, sides.result);
  return report_html({sides.scene, sides.run, sides.result, errors, figures, sides.plans, sides.manifest});
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The page without what its scripts hold.
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
  EXPECT_FALSE(std::regex_search(markup, std::regex("(src|href)\\s*=", std::regex::icase)));
  EXPECT_FALSE(std::regex_search(markup, std::regex("<(link|iframe|object|embed|base)\\b", std::regex::icase)));
  EXPECT_FALSE(std::regex_search(markup, std::regex("url\\(|@import", std::regex::icase)));
  EXPECT_TRUE(has(markup, "default-src 'none'"));
}

TEST(Report, TablesEveryFigureWithItsMeaning) {
  const testing::Sides sides = testing::pressed(5, 600);
  const std::string html = report_of(sides);
  for (const scene::Figure& figure :
       make_figures(compute_errors(sides.scene, sides.run, sides.result), sides.run, sides.result)) {
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
                           "quarter 3D u-p finite strain", "CHOLMOD with OpenBLAS", "4f1c09a7d2be55aa4f1c09a7d2be55aa",
                           "GNU 12.2.0", "8 anchor points, the corners of the box",
                           "tool and track lie on both symmetry planes", "left out", "# 1 &lt; 2 &amp; 3"}) {
    EXPECT_TRUE(has(html, part)) << part;
  }
  // Three levels; the second's force is 1.006 / 0.982 of the first's.
  EXPECT_TRUE(has(html, "2.44\u00a0%"));
}

TEST(Report, DoesNotStretchTheLogarithmicAxesToAGrazingInstant) {
  // With 23 instants one of them touches by rounding alone.
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
  sides.result.force_uncertainty_n.assign(5, std::numeric_limits<double>::quiet_NaN());
  for (Eigen::VectorXd& u : sides.result.displacement_uncertainty_m) {
    u.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  const std::string html = report_of(sides);
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(markup_of(html)));
  EXPECT_FALSE(has(markup_of(html), "not finite"));
  EXPECT_TRUE(has(html, "unknown"));
}

TEST(Report, OfATrackWithoutContactIsStillWhole) {
  testing::Sides sides = testing::pressed(3, 600);
  for (std::size_t t = 0; t < 3; ++t) {
    scene::InstantRecord& r = sides.result.instants[t];
    r.depth_m = 0.0;
    r.regions.clear();
    r.displacement_m.setZero();
    sides.result.force_uncertainty_n[t] = 0.0;
    sides.result.displacement_uncertainty_m[t].setZero();
    for (reference::LevelRecord& level : sides.result.levels) level.force_n[t] = 0.0;
    sides.run.instants[t] = r;
  }
  const std::string html = report_of(sides);
  EXPECT_TRUE(testing::is_well_formed(html));
  EXPECT_FALSE(testing::shows_not_a_number(markup_of(html)));
  EXPECT_TRUE(has(html, "never touches the body"));
  EXPECT_TRUE(has(html, "undefined: the reference is never in contact"));
}

}  // namespace
}  // namespace touchstone::compare
