#include "compare/report/picture.h"

#include "support/synthetic.h"
#include "support/xml.h"

#include <gtest/gtest.h>

#include <limits>
#include <regex>

namespace touchstone::compare {
namespace {

std::string half_cuts(const testing::Sides& sides, std::size_t instant) {
  return half_cuts_in_a_row(half_cut_svgs(sides.scene, sides.run, sides.result, instant));
}

TEST(Picture, IsWellFormedAndSmallAtTheDefaultSize) {
  const testing::Sides sides = testing::pressed(3);
  for (const std::string& svg : {half_cuts(sides, 2), section_svg(sides.scene, sides.run, sides.result, 2, false),
                                 section_svg(sides.scene, sides.run, sides.result, 2, true)}) {
    EXPECT_TRUE(testing::is_well_formed(svg));
    EXPECT_FALSE(testing::shows_not_a_number(svg));
    EXPECT_LT(svg.size(), 1'500'000u);
  }
}

TEST(Picture, ShowsBothSidesAndTheErrorOnOneBodyEach) {
  const testing::Sides sides = testing::pressed(3, 600);
  const std::string svg = half_cuts(sides, 2);
  for (const char* title : {">Reference<", ">Fast model<", ">Error, on the reference's shape<"}) {
    EXPECT_NE(svg.find(title), std::string::npos) << title;
  }
  std::size_t cuts = 0;
  for (std::size_t at = svg.find("#e9e6df"); at != std::string::npos; at = svg.find("#e9e6df", at + 1)) ++cuts;
  EXPECT_EQ(cuts, 3u);
}

TEST(Picture, AndItsScaleSurviveAFastModelGoneWild) {
  testing::Sides sides = testing::pressed(3, 600);
  sides.run.instants[2].displacement_m *= 0.5;
  const std::string before = half_cuts(sides, 2);
  EXPECT_EQ(before.find("larger values have the last colour"), std::string::npos);
  sides.run.instants[2].displacement_m *= 50.0;
  // Non-finite positions on the cut and off it.
  Eigen::Index on_cut = 0;
  sides.run.surface.points_m.row(1).cwiseAbs().minCoeff(&on_cut);
  sides.run.instants[2].displacement_m(0, on_cut) = std::numeric_limits<double>::quiet_NaN();
  sides.run.instants[2].displacement_m(0, 7) = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = half_cuts(sides, 2);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_FALSE(testing::shows_not_a_number(svg));
  EXPECT_NE(svg.find("larger values have the last colour"), std::string::npos);
  // The reference's panel is unchanged: its own displacement determines the scale.
  const std::size_t panel = svg.find("<g stroke-width"), end = svg.find("</g>", panel);
  EXPECT_EQ(svg.substr(panel, end - panel), before.substr(panel, end - panel));
  EXPECT_FALSE(testing::shows_not_a_number(section_svg(sides.scene, sides.run, sides.result, 2, false)));
}

/// The path of a curve in a section, by its colour.
std::string path_of(const std::string& svg, Look look) {
  std::smatch found;
  const std::regex path("<path d=\"([^\"]*)\" fill=\"none\" stroke=\"" + colour(look) + "\"");
  return std::regex_search(svg, found, path) ? found[1].str() : "";
}

std::ptrdiff_t count(const std::string& text, const std::string& what) {
  const std::regex pattern(what);
  return std::distance(std::sregex_iterator(text.begin(), text.end(), pattern), std::sregex_iterator());
}

TEST(Picture, SectionDrawsTheReferenceOnItsOwnMesh) {
  testing::Sides sides = testing::pressed(3, 600);
  const auto section = [&](bool around_contact) {
    return section_svg(sides.scene, sides.run, sides.result, 2, around_contact);
  };
  const std::string whole = section(false), near = section(true);
  const std::string reference = path_of(whole, Look::reference), fast = path_of(whole, Look::fast);
  ASSERT_FALSE(reference.empty());
  ASSERT_FALSE(fast.empty());
  // Nineteen thousand triangles of the reference's own against six hundred.
  EXPECT_GT(count(reference, "L"), 4 * count(fast, "L"));

  // Nodes as dots, and the fast model's own points as squares, if they can be distinguished.
  const auto dots = [](const std::string& svg) {
    return count(svg, "<circle [^>]*r=\"1.8\" fill=\"" + colour(Look::reference));
  };
  const auto squares = [](const std::string& svg) {
    return count(svg, "<rect [^>]*width=\"3.6\"[^>]*fill=\"" + colour(Look::fast));
  };
  EXPECT_EQ(dots(whole), 0);
  EXPECT_EQ(squares(whole), 0);
  EXPECT_GT(dots(near), 20);
  EXPECT_GT(squares(near), 3);
  EXPECT_LT(squares(near), dots(near));

  // The reference's values at the fast model's points have no effect; its own surface has.
  sides.result.instants[2].displacement_m *= 1.5;
  EXPECT_EQ(section(false), whole);
  sides.result.deepest_surface.displacement_m *= 1.5;
  EXPECT_NE(path_of(section(false), Look::reference), reference);
  EXPECT_EQ(count(path_of(section(false), Look::fast), "L"), count(fast, "L"));
  sides.result.deepest_surface.is_node.assign(sides.result.deepest_surface.is_node.size(), false);
  EXPECT_EQ(dots(section(true)), 0);
}

TEST(Picture, OfABodyAtRest) {
  const testing::Sides sides = testing::pressed(3, 600);
  const std::string svg = half_cuts(sides, 0);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_FALSE(testing::shows_not_a_number(svg));
  EXPECT_FALSE(std::regex_search(svg, std::regex("fill=\"#(?![0-9a-f]{6}\")"))) << "not a colour";
}

}  // namespace
}  // namespace touchstone::compare
