#include "compare/report/viewer.h"

#include "compare/errors/compute_errors.h"
#include "compare/viewer/viewer_bundle.h"
#include "scene/base/files.h"
#include "support/synthetic.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>

namespace touchstone::compare {
namespace {

using ::testing::Contains;
using Json = nlohmann::json;

std::string section_of(const testing::Sides& sides) {
  return viewer_section(sides.scene, sides.run, sides.result,
                        compute_errors(sides.scene, sides.run, sides.result.instants));
}

std::string data_text(const std::string& section) {
  const std::size_t from = section.find('>', section.find("id=\"viewer-data\"")) + 1;
  return section.substr(from, section.find("</script>", from) - from);
}

std::vector<float> decoded(const std::string& base64) {
  std::vector<unsigned char> bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : base64) {
    if (c == '=') break;
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    group = group << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((bits += 6) >= 8) bytes.push_back(static_cast<unsigned char>(group >> (bits -= 8)));
  }
  std::vector<float> out(bytes.size() / sizeof(float));
  std::memcpy(out.data(), bytes.data(), out.size() * sizeof(float));
  return out;
}

TEST(Viewer, TakesAllInstantsOrFewWithTheDeepest) {
  EXPECT_EQ(viewer_instants(4, 2, 100), (std::vector<std::size_t>{0, 1, 2, 3}));
  for (const std::size_t deepest : {0u, 1u, 617u, 998u, 999u}) {
    for (const Eigen::Index points : {100, 20'000, 10'000'000}) {
      const std::vector<std::size_t> chosen = viewer_instants(1000, deepest, points);
      EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
      EXPECT_EQ(std::adjacent_find(chosen.begin(), chosen.end()), chosen.end());
      EXPECT_EQ(chosen.front(), 0u);
      EXPECT_EQ(chosen.back(), 999u);
      EXPECT_THAT(chosen, Contains(deepest));
      EXPECT_LE(chosen.size(), 48u);
    }
  }
  EXPECT_LT(viewer_instants(1000, 0, 20'000).size(), viewer_instants(1000, 0, 100).size());
}

TEST(Viewer, CarriesPlacesAndDisplacementsInSinglePrecision) {
  const testing::Sides sides = testing::pressed(5, 600);
  const Json data = Json::parse(data_text(section_of(sides)));
  const auto expect_equal = [](const Json& encoded, const Eigen::Matrix3Xd& vectors) {
    const std::vector<float> numbers = decoded(encoded.get<std::string>());
    ASSERT_EQ(numbers.size(), static_cast<std::size_t>(vectors.size()));
    for (std::size_t i = 0; i < numbers.size(); ++i) EXPECT_EQ(numbers[i], static_cast<float>(vectors.data()[i]));
  };
  expect_equal(data["points_m"], sides.run.surface.points_m);
  ASSERT_EQ(data["instants"].size(), 5u);
  for (std::size_t t = 0; t < 5; ++t) {
    expect_equal(data["instants"][t]["fast"], sides.run.instants[t].displacement_m);
    expect_equal(data["instants"][t]["reference"], sides.result.instants[t].displacement_m);
  }
  EXPECT_EQ(data["deepest"], 4);
}

TEST(Viewer, IsWellFormedAndItsDataEndsNoScript) {
  const std::string section = section_of(testing::pressed(3, 200));
  EXPECT_TRUE(testing::is_well_formed("<div>" + section + "</div>"));
  EXPECT_EQ(data_text(section).find_first_of("<>&"), std::string::npos);
  EXPECT_NE(section.find(viewer_bundle), std::string::npos);
}

TEST(Viewer, HoldsVtkJsWithItsLicence) {
  EXPECT_NE(viewer_bundle.find("with @kitware/vtk.js:\n"), std::string_view::npos);
  EXPECT_EQ(viewer_bundle.find("]]>"), std::string_view::npos);
}

}  // namespace
}  // namespace touchstone::compare
