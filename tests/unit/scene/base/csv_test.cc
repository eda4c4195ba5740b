#include "scene/base/csv.h"

#include "scene/base/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

namespace touchstone::scene {
namespace {

using testing::ElementsAre;

TEST(Csv, GivesRowsWithTheirPlaces) {
  CsvRows rows(
      "\xef\xbb\xbf"
      "a,b\r\n\n1, 2,\n,");
  ASSERT_TRUE(rows.next());
  EXPECT_THAT(rows.cells(), ElementsAre("a", "b"));
  EXPECT_EQ(rows.column(rows.cells()[1]), 3);
  ASSERT_TRUE(rows.next());
  EXPECT_THAT(rows.cells(), ElementsAre(""));
  ASSERT_TRUE(rows.next());
  EXPECT_EQ(rows.line(), 3);
  EXPECT_EQ(rows.text(), "1, 2,");
  EXPECT_THAT(rows.cells(), ElementsAre("1", " 2", ""));
  ASSERT_TRUE(rows.next());
  EXPECT_THAT(rows.cells(), ElementsAre("", ""));
  EXPECT_FALSE(rows.next());
  EXPECT_FALSE(CsvRows("").next());
}

TEST(Csv, ANumberIsTheWholeText) {
  EXPECT_EQ(parsed<double>("-1.5e3"), -1500.0);
  EXPECT_EQ(parsed<std::int64_t>("12"), 12);
  for (const char* text : {"", " 1", "1 ", "1x", "+1", "1e999"}) EXPECT_FALSE(parsed<double>(text)) << text;
  EXPECT_FALSE(parsed<std::int64_t>("1.5"));
}

}  // namespace
}  // namespace touchstone::scene
