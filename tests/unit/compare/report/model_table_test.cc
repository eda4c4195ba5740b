#include "compare/report/model_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace touchstone::compare {
namespace {

using ::testing::HasSubstr;

TEST(ModelTableText, SaysWhatEachErrorIsRelativeToAndAlignsItsColumns) {
  const std::vector<JudgedModel> models = {
      {"paper", "paper as printed", "Duffing, published", {0.482, 0.0017}, {0.746, {}}, 11.8},
      {"area_aware", "untuned", "area-aware, published", {0.001, 0.0017}, {{}, {}}, 9.0},
      {.key = "columns", .name = "columns", .absent = "there is friction"}};
  const std::string text = model_table_text(models);
  EXPECT_THAT(text, HasSubstr("100 %"));
  EXPECT_THAT(text, HasSubstr("48.2"));
  EXPECT_THAT(text, HasSubstr("< 0.17"));
  const std::size_t begin = text.find('\n') + 1;
  const std::string head = text.substr(begin, text.find('\n', begin) - begin);
  EXPECT_TRUE(head.ends_with("step")) << head;
  EXPECT_THAT(model_table_html(models), HasSubstr("<td>paper as printed</td>"));
  EXPECT_THAT(text, HasSubstr("\ncolumns is absent: there is friction\n"));
  EXPECT_THAT(model_table_html(models), HasSubstr("<td>columns (absent: there is friction)</td>"));
}

TEST(ModelTableText, HasAColumnForPressureWhereAModelGivesIt) {
  std::vector<JudgedModel> models = {{"paper", "paper as printed", "", {0.482, 0.0017}, {0.746, {}}, 11.8},
                                     {"response", "response", "", {0.01, 0.0017}, {0.03, {}}, 9.8}};
  EXPECT_THAT(model_table_html(models), ::testing::Not(HasSubstr("<th class=\"n\">Pressure error</th>")));
  EXPECT_THAT(model_table_text(models), ::testing::Not(HasSubstr("pressure")));
  models[1].pressure_rel_l2 = {0.063, 0.01};
  models[1].pressure_peak_rel = {-0.02, 0.01};
  EXPECT_THAT(model_table_text(models), HasSubstr("pressure"));
  EXPECT_THAT(model_table_html(models), HasSubstr("<th class=\"n\">Pressure error</th>"));
  const scene::Figures figures = model_figures(models);
  ASSERT_EQ(figures.size(), 14u);
  EXPECT_EQ(figures[9].key, "model.response.contact.pressure_rel_l2");
  EXPECT_EQ(figures[11].number, -0.02);
}

TEST(ModelFigures, HaveAKeyPerModel) {
  const scene::Figures figures = model_figures({{"paper", "", "", {0.482, 0.0017}, {0.746, {}}, 11.8}});
  ASSERT_EQ(figures.size(), 5u);
  EXPECT_EQ(figures[0].key, "model.paper.force.nrmse");
  EXPECT_EQ(figures[0].number, 0.482);
  EXPECT_TRUE(std::isnan(figures[3].number)) << "an unknown uncertainty";
  EXPECT_EQ(figures[3].text, "unknown");
  EXPECT_EQ(figures[4].unit, "us");
  const scene::Figures absent = model_figures({{.key = "columns", .absent = "there is friction"}});
  for (const scene::Figure& figure : absent) EXPECT_TRUE(std::isnan(figure.number)) << figure.key;
  EXPECT_EQ(absent[0].text, "absent: there is friction");
}

}  // namespace
}  // namespace touchstone::compare
