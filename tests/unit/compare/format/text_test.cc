#include "compare/format/text.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace touchstone::compare {
namespace {

const std::string gap(no_break);

TEST(Text, NumbersHaveThreeDigits) {
  EXPECT_EQ(number_text(0.0), "0");
  EXPECT_EQ(number_text(0.33994), "0.34");
  EXPECT_EQ(number_text(169.7), "170");
  EXPECT_EQ(number_text(9.999), "10");
  EXPECT_EQ(number_text(3952.0), "3952");
  EXPECT_EQ(number_text(275200.0), "275\u2009200");
  EXPECT_EQ(number_text(3.0e8), "3 × 10⁸");
  EXPECT_EQ(number_text(-1.4e-6), "−1.4 × 10⁻⁶");
  EXPECT_EQ(number_text(-77.82), "−77.8");
  EXPECT_EQ(number_text(169.74, 5), "169.74");
}

TEST(Text, MeasuredNumbersHaveFourDigitsAtMostAndCountsAll) {
  EXPECT_EQ(number_text(23208.0), "23\u2009208");
  EXPECT_EQ(number_text(23208.4), "23\u2009210");
  EXPECT_EQ(number_text(-123456.7), "−123\u2009500");
  EXPECT_EQ(percent_text(456.7891), "45\u2009680" + gap + "%");
  EXPECT_EQ(number_text(1234.5), "1234");
}

TEST(Text, WhatIsNotFiniteIsSaid) {
  EXPECT_EQ(number_text(std::numeric_limits<double>::quiet_NaN()), "not finite");
  EXPECT_EQ(percent_text(std::numeric_limits<double>::infinity()), "not finite");
  EXPECT_EQ(quantity_text(std::numeric_limits<double>::quiet_NaN(), "m"), "not finite");
}

TEST(Text, QuantitiesAreScaledToAHandyUnit) {
  EXPECT_EQ(quantity_text(0.005, "m"), "5" + gap + "mm");
  EXPECT_EQ(quantity_text(0.0005, "m"), "0.5" + gap + "mm");
  EXPECT_EQ(quantity_text(5.01e-5, "m"), "50.1" + gap + "µm");
  EXPECT_EQ(quantity_text(319.2, "s"), "5.32" + gap + "min");
  EXPECT_EQ(quantity_text(11.24, "us"), "11.2" + gap + "µs");
  EXPECT_EQ(quantity_text(3.4e6, "byte"), "3.4" + gap + "MB");
  EXPECT_EQ(quantity_text(37.7, "N"), "37.7" + gap + "N");
  EXPECT_EQ(quantity_text(5.2e-18, "m"), "0" + gap + "mm");
  EXPECT_EQ(quantity_text(0.0, "N"), "0" + gap + "N");
  EXPECT_EQ(quantity_text(0.9964, ""), "99.6" + gap + "%");
  EXPECT_EQ(quantity_text(std::nullopt, "m", "none"), "none");
}

TEST(Text, RoundOffIsNotGivenAsANumber) {
  EXPECT_EQ(percent_text(9.7e-19), "below 0.0001" + gap + "%");
  EXPECT_EQ(percent_text(-3e-11), "below 0.0001" + gap + "%");
  EXPECT_EQ(percent_text(1.4e-6), "1.4 × 10⁻⁴" + gap + "%");
  EXPECT_EQ(percent_text(0.0), "0" + gap + "%");
}

TEST(Text, IsWrappedAtSpacesByCharacters) {
  EXPECT_EQ(wrapped("one two three", 7), "one two\nthree");
  EXPECT_EQ(wrapped("ééé ééé ééé", 7), "ééé ééé\nééé");
  EXPECT_EQ(wrapped("longerthanthat a", 4), "longerthanthat\na");
  EXPECT_EQ(wrapped("", 4), "");
}

TEST(Text, IsEscapedForMarkup) { EXPECT_EQ(escape_xml("a<b>&\"c\"\x01"), "a&lt;b&gt;&amp;&quot;c&quot;"); }

TEST(Text, ATitleIsAnAnchor) { EXPECT_EQ(slug("(Force, over time)"), "force-over-time"); }

TEST(CsvCell, IsNoFormula) {
  EXPECT_EQ(csv_cell("=1+cmd|'/c calc'!A0"), "'=1+cmd|'/c calc'!A0");
  EXPECT_EQ(csv_cell("@sum"), "'@sum");
  EXPECT_EQ(csv_cell("-2+3"), "'-2+3");
  EXPECT_EQ(csv_cell("=a,b"), "\"'=a,b\"");
  for (const char* number : {"-0.5", "+3", "-1e-3", "12", "", "middle"}) EXPECT_EQ(csv_cell(number), number);
}

}  // namespace
}  // namespace touchstone::compare
