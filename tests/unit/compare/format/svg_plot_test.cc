#include "compare/format/svg_plot.h"

#include "support/xml.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <regex>

namespace touchstone::compare {
namespace {

const double nan_value = std::numeric_limits<double>::quiet_NaN();

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// Centres of the round markers, in drawing order.
std::vector<std::pair<double, double>> circles(const std::string& svg) {
  static const std::regex pattern("<circle cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\" r=\"3\" fill=\"[^\"]*\"><title>");
  std::vector<std::pair<double, double>> found;
  for (std::sregex_iterator it(svg.begin(), svg.end(), pattern), end; it != end; ++it) {
    found.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  return found;
}

Plot line(std::vector<double> x, std::vector<double> y) {
  Plot plot;
  plot.title = "a < b & \"c\"";
  plot.x_label = "depth [mm]";
  plot.y_label = "force [N]";
  plot.curves.push_back({"one", Look::reference, std::move(x), std::move(y)});
  return plot;
}

TEST(SvgPlot, TicksAreRoundAndInside) {
  EXPECT_EQ(nice_ticks(0.0, 5.0, 5), (std::vector<double>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(nice_ticks(0.0, 170.0, 6), (std::vector<double>{0, 50, 100, 150}));
  for (const double tick : nice_ticks(-3.3, 8.1, 7)) {
    EXPECT_GE(tick, -3.3);
    EXPECT_LE(tick, 8.1);
  }
}

TEST(SvgPlot, IsWellFormedWithTitleUnitsLegendAndTips) {
  Plot plot = line({0, 1, 2}, {0, 10, 40});
  plot.bands.push_back({"band", Look::reference, {0, 1, 2}, {0, 9, 38}, {0, 11, 42}});
  const std::string svg = to_svg(plot);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_NE(svg.find("a &lt; b &amp; &quot;c&quot;"), std::string::npos);
  EXPECT_NE(svg.find("depth [mm]"), std::string::npos);
  EXPECT_NE(svg.find("force [N]"), std::string::npos);
  EXPECT_NE(svg.find(">one</text>"), std::string::npos);
  EXPECT_NE(svg.find(">band</text>"), std::string::npos);
  EXPECT_NE(svg.find("<title>one | depth [mm]: 2; force [N]: 40</title>"), std::string::npos);
  EXPECT_EQ(count(svg, "<polygon"), 1u);
}

TEST(SvgPlot, PlacesPointsInProportion) {
  const auto at = circles(to_svg(line({0, 1, 4}, {0, 5, 20})));
  ASSERT_EQ(at.size(), 3u);
  EXPECT_NEAR((at[1].first - at[0].first) * 4, at[2].first - at[0].first, 0.5);
  EXPECT_NEAR((at[1].second - at[0].second) * 4, at[2].second - at[0].second, 0.5);
  EXPECT_GT(at[2].first, at[0].first);
  EXPECT_LT(at[2].second, at[0].second);
}

TEST(SvgPlot, MakesAPowerLawStraightOnLogarithmicAxes) {
  Plot plot = line({0, 1, 10, 100}, {0, 2, 200, 20000});
  plot.x_log = plot.y_log = true;
  const auto at = circles(to_svg(plot));
  ASSERT_EQ(at.size(), 3u);  // the point at zero cannot be shown
  EXPECT_NEAR(at[2].first - at[1].first, at[1].first - at[0].first, 0.2);
  EXPECT_NEAR(at[2].second - at[1].second, at[1].second - at[0].second, 0.2);
}

TEST(SvgPlot, InterruptsALineAtWhatIsNotFinite) {
  const std::string svg = to_svg(line({0, 1, 2, 3, 4}, {1, 2, nan_value, 3, std::numeric_limits<double>::infinity()}));
  EXPECT_FALSE(testing::shows_not_a_number(svg));
  EXPECT_EQ(circles(svg).size(), 3u);
  std::smatch path;
  ASSERT_TRUE(std::regex_search(svg, path, std::regex("<path d=\"([^\"]*)\"")));
  EXPECT_EQ(count(path[1], "M"), 2u);
}

TEST(SvgPlot, RangeIsThatOfThePointsShown) {
  // A point without a y must not extend the x axis.
  const auto with = circles(to_svg(line({1, 2, 1000}, {1, 2, nan_value})));
  const auto without = circles(to_svg(line({1, 2}, {1, 2})));
  EXPECT_EQ(with, without);
}

TEST(SvgPlot, SaysWhenThereIsNothingToShow) {
  for (const Plot& plot : {Plot{}, line({}, {}), line({1, 2}, {nan_value, nan_value})}) {
    const std::string svg = to_svg(plot);
    EXPECT_TRUE(testing::is_well_formed(svg));
    EXPECT_NE(svg.find("nothing to show"), std::string::npos);
  }
}

TEST(SvgPlot, SurvivesConstantAndSinglePoints) {
  for (const Plot& plot : {line({1}, {1}), line({0}, {0}), line({1, 2}, {5, 5}), line({1, 1}, {0, 0})}) {
    const std::string svg = to_svg(plot);
    EXPECT_TRUE(testing::is_well_formed(svg));
    EXPECT_FALSE(testing::shows_not_a_number(svg));
  }
}

TEST(SvgPlot, DrawsToOneScaleWhenAsked) {
  Plot plot = line({0, 1, 0}, {0, 0, 1});
  plot.same_scale = true;
  const auto at = circles(to_svg(plot, 700, 300));
  ASSERT_EQ(at.size(), 3u);
  EXPECT_NEAR(at[1].first - at[0].first, at[0].second - at[2].second, 0.2);
}

TEST(SvgPlot, ShadesSpansInProportionAndListsEachNameOnce) {
  Plot plot = line({0, 1, 4}, {0, 5, 20});
  plot.spans = {{"still", 0.0, 1.0, 0.05}, {"moving", 1.0, 2.0, 0.2}, {"still", 2.0, 4.0, 0.05}};
  const std::string svg = to_svg(plot);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_EQ(count(svg, ">still</text>"), 1u);
  EXPECT_EQ(count(svg, ">moving</text>"), 1u);
  static const std::regex pattern(
      "<rect x=\"([0-9.]+)\" y=\"[0-9.]+\" width=\"([0-9.]+)\" [^>]*fill-opacity=\"0.(05|2)\"");
  std::vector<std::pair<double, double>> spans;
  for (std::sregex_iterator it(svg.begin(), svg.end(), pattern), end; it != end; ++it) {
    spans.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]));
  }
  ASSERT_EQ(spans.size(), 3u);
  const auto at = circles(svg);
  EXPECT_NEAR(spans[0].first, at[0].first, 0.2);
  EXPECT_NEAR(spans[1].first, at[1].first, 0.2);
  EXPECT_NEAR(spans[2].first + spans[2].second, at[2].first, 0.3);
  EXPECT_NEAR(spans[2].second, 2 * spans[1].second, 0.3);
}

TEST(SvgPlot, AsAFileIsDarkOnWhiteEverywhere) {
  const std::string svg = to_svg(line({0, 1}, {0, 1}));
  const std::string file = as_file(svg);
  EXPECT_TRUE(testing::is_well_formed(file));
  EXPECT_NE(file.find("<svg color=\"#1c1e21\" xmlns="), std::string::npos);
  // The background is below everything else.
  EXPECT_LT(file.find("fill=\"#ffffff\""), file.find("<text"));
  EXPECT_EQ(svg.find("#ffffff"), std::string::npos);
}

TEST(SvgPlot, NamesNothingInTheLegendThatIsNotDrawn) {
  Plot plot = line({0, 1, 2}, {0, 10, 40});
  const double infinite = std::numeric_limits<double>::infinity();
  plot.bands.push_back({"band", Look::reference, {0, 1, 2}, {0, 0, 0}, {nan_value, infinite, nan_value}});
  plot.curves.push_back({"unknown", Look::fast, {0, 1, 2}, {nan_value, nan_value, infinite}});
  const std::string svg = to_svg(plot);
  EXPECT_EQ(count(svg, ">band<"), 0u);
  EXPECT_EQ(count(svg, ">unknown<"), 0u);
  EXPECT_EQ(count(svg, ">one<"), 1u);
  EXPECT_EQ(band_seen(plot, plot.bands[0]), BandSeen::nowhere);
  plot.bands[0].high[1] = 11.0;
  plot.bands[0].low[1] = 9.0;
  EXPECT_EQ(count(to_svg(plot), ">band<"), 1u);
  EXPECT_EQ(band_seen(plot, plot.bands[0]), BandSeen::area);
  plot.bands[0].high[1] = 9.01;
  EXPECT_EQ(band_seen(plot, plot.bands[0]), BandSeen::narrower_than_the_line);
}

TEST(SvgPlot, KeepsTheAxisTitleClearOfTheTickLabels) {
  for (const auto& [low, high] : {std::pair(0.0, 1.0), std::pair(1.2e5, 1.3e5), std::pair(1.234e-5, 1.235e-5)}) {
    const Plot plot = line({0, 1}, {low, high});
    const std::string svg = to_svg(plot);
    // Tick labels end 7 px left of the axis; a letter is 6.6 px wide; the title extends to 20 px.
    static const std::regex label("<text x=\"([0-9.]+)\" y=\"[0-9.]+\" text-anchor=\"end\"[^>]*>([^<]*)<");
    int labels = 0;
    for (std::sregex_iterator it(svg.begin(), svg.end(), label), end; it != end; ++it, ++labels) {
      const std::string text = (*it)[2];
      const auto letters = std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; });
      EXPECT_GE(std::stod((*it)[1]) - 6.6 * static_cast<double>(letters), 20.0) << text;
    }
    EXPECT_GE(labels, 2);
    EXPECT_NEAR(x_axis_px(plot, 560, 360).first, circles(svg)[0].first, 0.1);
  }
}

TEST(SvgPlot, PutsSeveralInRows) {
  const std::string one = to_svg(line({0, 1}, {0, 1}), 300, 200);
  const std::string svg = in_rows("a & b", {one, one, one, one}, 3, 300, 200);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_NE(svg.find("viewBox=\"0 0 900 400\""), std::string::npos);
  for (const char* place : {"(0 0)", "(300 0)", "(600 0)", "(0 200)"}) {
    EXPECT_EQ(count(svg, std::string("<g transform=\"translate") + place), 1u) << place;
  }
}

TEST(SvgPlot, BarsSayHowWellAPointIsKnownAndAHollowMarkerThatItIsNot) {
  Plot plot = line({1, 2, 3}, {10, 20, 30});
  plot.curves[0].y_half = {1.0, 8.0, std::numeric_limits<double>::quiet_NaN()};
  const std::string svg = to_svg(plot);
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_FALSE(testing::shows_not_a_number(svg));
  const std::regex bar("class=\"bar\" d=\"M[0-9.]+ ([0-9.]+)H[0-9.]+M[0-9.]+ [0-9.]+V([0-9.]+)M");
  std::vector<double> heights_px;
  for (std::sregex_iterator at(svg.begin(), svg.end(), bar), end; at != end; ++at) {
    heights_px.push_back(std::stod((*at)[2]) - std::stod((*at)[1]));
  }
  ASSERT_EQ(heights_px.size(), 2u);
  EXPECT_NEAR(heights_px[1] / heights_px[0], 8.0, 0.1);
  EXPECT_EQ(count(svg, "± 8</title>"), 1u);
  EXPECT_EQ(count(svg, "± unknown</title>"), 1u);
  EXPECT_EQ(count(svg, "class=\"unknown\""), 1u);
  // The axis includes the longest error bar.
  plot.curves[0].y_half = {0.0, 200.0, 0.0};
  EXPECT_EQ(count(to_svg(plot), ">200</text>"), 1u);
}

TEST(SvgPlot, BarsStandOnTheAxisSideBySideAndSayTheirRange) {
  Plot plot;
  plot.x_label = "time";
  plot.y_label = "ticks";
  plot.x_range = {0.0, 40.0};
  plot.y_range = {0.0, 8.0};
  plot.bars.push_back({"steps", Look::fast, {0.0, 10.0, 20.0, 40.0}, {4.0, 0.0, 8.0}});
  const std::string svg = to_svg(plot, 480, 266);  // 400 px by 162 px within the axes, below one row of names
  EXPECT_TRUE(testing::is_well_formed(svg));
  EXPECT_NE(svg.find("<rect x=\"64.0\" y=\"139.0\" width=\"99.0\" height=\"81.0\" fill=\"#e4600a\">"
                     "<title>time: 0 to 10; ticks: 4</title>"),
            std::string::npos)
      << svg;
  EXPECT_NE(svg.find("<title>time: 20 to 40; ticks: 8</title>"), std::string::npos);
  EXPECT_EQ(svg.find("time: 10 to 20"), std::string::npos);
  EXPECT_NE(svg.find(">steps</text>"), std::string::npos);
}

TEST(SvgPlot, BarsAloneMakeTheAxes) {
  Plot plot;
  plot.bars.push_back({"", Look::fast, {5.0, 10.0}, {3.0}});
  EXPECT_EQ(to_svg(plot).find("nothing to show"), std::string::npos);
  plot.bars[0].heights = {0.0};
  EXPECT_NE(to_svg(plot).find("nothing to show"), std::string::npos);
}

TEST(SvgPlot, HiddenMarkersTellTheirValuesAndAreNotSeen) {
  Plot plot = line({0, 1, 2}, {0, 10, 40});
  plot.curves[0].hidden_markers = true;
  const std::string svg = to_svg(plot);
  EXPECT_EQ(count(svg, "fill=\"none\" pointer-events=\"all\"><title>one | "), 3u);
  EXPECT_EQ(count(svg, "<circle"), 3u);  // none in the legend
}

TEST(SvgPlot, ThePointsNameStandsOnNoLine) {
  Plot plot = line({0.0, 1.0}, {0.5, 0.5});
  plot.curves[0].markers = false;
  plot.y_range = {0.0, 1.0};
  plot.names = {{"here", 0.5, 0.5}};
  const std::string svg = to_svg(plot);
  std::smatch level, name;
  ASSERT_TRUE(std::regex_search(svg, level, std::regex("<path d=\"M[-0-9.]+[ ,]([-0-9.]+)"))) << svg;
  ASSERT_TRUE(std::regex_search(svg, name, std::regex("y=\"([-0-9.]+)\"[^>]*>here</text>"))) << svg;
  const double baseline_px = std::stod(name[1]), line_px = std::stod(level[1]);
  EXPECT_TRUE(baseline_px < line_px || baseline_px > line_px + 10.0) << baseline_px << ' ' << line_px;
}

}  // namespace
}  // namespace touchstone::compare
