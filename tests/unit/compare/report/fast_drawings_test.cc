#include "compare/report/fast_drawings.h"

#include "support/synthetic.h"
#include "support/xml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

namespace touchstone::compare {
namespace {

using scene::InstantRecord;
using scene::Vec3;
using testing::count_of;
using ::testing::ElementsAre;

std::vector<std::string> names_of(const std::vector<Drawing>& drawings) {
  std::vector<std::string> names;
  for (const Drawing& drawing : drawings) names.push_back(drawing.name);
  return names;
}

std::string svg_of(const std::vector<Drawing>& drawings, const std::string& name) {
  const auto found = std::find_if(drawings.begin(), drawings.end(), [&](const Drawing& d) { return d.name == name; });
  return found == drawings.end() ? "" : found->svg;
}

/// Lines within the axes: the curves of a plot without markers or bands.
std::size_t curves(const std::string& svg) { return count_of(svg, "<path d=\"M"); }

scene::RegionRecord region(int id, double depth_m, const Vec3& force_n, bool sliding = false) {
  scene::RegionRecord out;
  out.id = id;
  out.depth_m = depth_m;
  out.force_n = force_n;
  out.area_m2 = 1e-5;
  out.sliding = sliding;
  return out;
}

/// The ball pressed on the cube, one instant per letter: '.' no contact, 's' sticking, 'S' slipping.
testing::Sides with_friction(const std::string& letters) {
  testing::Sides sides = testing::pressed(static_cast<int>(letters.size()), 200);
  sides.scene.contact.friction = scene::Friction{1.0, 0.75, 0.5};
  for (std::size_t t = 0; t < letters.size(); ++t) {
    InstantRecord& record = sides.run.instants[t];
    record.regions.clear();
    if (letters[t] == '.') continue;
    record.regions.push_back(region(0, 0.002, Vec3(-1.0, 0.0, 4.0), letters[t] == 'S'));
    record.regions[0].friction_n = Vec3(-1.0, 0.0, 0.0);
  }
  return sides;
}

/// The same with the number of regions given by the digits.
testing::Sides with_regions(const std::string& digits) {
  testing::Sides sides = testing::pressed(static_cast<int>(digits.size()), 200);
  for (std::size_t t = 0; t < digits.size(); ++t) {
    InstantRecord& record = sides.run.instants[t];
    record.regions.clear();
    for (int id = 0; id < digits[t] - '0'; ++id) record.regions.push_back(region(id, 0.001, Vec3(0.0, 0.0, 1.0 + id)));
  }
  return sides;
}

TEST(FastDrawings, OfAPressHaveNothingTheSceneHasNot) {
  const testing::Sides sides = testing::pressed(5, 600);
  const auto forces = force_drawings(sides.scene, sides.run);
  EXPECT_THAT(names_of(forces), ElementsAre("force", "depth", "area"));
  EXPECT_THAT(names_of(shape_drawings(sides.scene, sides.run)), ElementsAre("section", "contact", "dent", "view"));
  EXPECT_NE(forces[0].svg.find(">F_z (up)</text>"), std::string::npos);
  EXPECT_EQ(forces[0].svg.find(">F_x</text>"), std::string::npos);
  EXPECT_NE(forces[0].caption.find("F_x and F_y"), std::string::npos);
  EXPECT_EQ(forces[0].svg.find("stuck"), std::string::npos);
  EXPECT_EQ(svg_of(shape_drawings(sides.scene, sides.run), "section").find("inclusion"), std::string::npos);
}

TEST(FastDrawings, OfATrackWithoutContactAreOfTheShapeOnly) {
  const testing::Sides sides = with_regions("0000");
  EXPECT_TRUE(force_drawings(sides.scene, sides.run).empty());
  EXPECT_THAT(names_of(shape_drawings(sides.scene, sides.run)), ElementsAre("section"));
}

TEST(FastDrawings, OfAGrazingContactShowSomethingOfItsSurroundings) {
  testing::Sides sides = with_regions("0101");
  for (InstantRecord& record : sides.run.instants) {
    record.tool.position_m.z() = 0.0701;
    record.depth_m = 0.0;
    for (auto& r : record.regions) r.depth_m = 0.0;
  }
  for (const Drawing& drawing : shape_drawings(sides.scene, sides.run)) {
    EXPECT_TRUE(testing::is_well_formed(drawing.svg)) << drawing.name;
    EXPECT_FALSE(testing::shows_not_a_number(drawing.svg)) << drawing.name;
  }
}

TEST(FastDrawings, SpansSayOfEveryInstantWhetherItSlides) {
  const std::string letters = ".ssSSsS..S";
  const testing::Sides sides = with_friction(letters);
  const std::vector<Span> spans = friction_spans(sides.run);
  for (std::size_t t = 0; t < letters.size(); ++t) {
    const double time_s = sides.run.instants[t].time_s;
    std::string found;
    for (const Span& span : spans) {
      if (span.from <= time_s && time_s <= span.to) found += span.name;
    }
    EXPECT_EQ(found, letters[t] == '.' ? "" : letters[t] == 'S' ? "sliding" : "stuck") << t;
  }
  ASSERT_EQ(spans.size(), 5u);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_DOUBLE_EQ(spans[i - 1].to, spans[i].from);
  EXPECT_DOUBLE_EQ(spans.back().to, sides.run.instants.back().time_s);
  // They differ in a grey print.
  EXPECT_GT(spans[1].shade, 2.0 * spans[0].shade);
}

TEST(FastDrawings, ShadeForceAndFrictionWhereTheSceneHasFriction) {
  const testing::Sides sides = with_friction(".ssSS");
  const auto drawings = force_drawings(sides.scene, sides.run);
  EXPECT_THAT(names_of(drawings), ElementsAre("force", "friction", "depth", "area"));
  for (const char* name : {"force", "friction"}) {
    for (const char* word : {">stuck</text>", ">sliding</text>"}) {
      EXPECT_EQ(count_of(svg_of(drawings, name), word), 1u) << name << word;
    }
  }
}

TEST(FastDrawings, TakeFrictionOffTheNormalForce) {
  testing::Sides sides = with_friction("ssSSS");
  for (std::size_t t = 0; t < 5; ++t) {
    sides.run.instants[t].depth_m = 0.002;
    sides.run.instants[t].tool.position_m = Vec3(0.004 * static_cast<double>(t), 0.0, 0.068);
  }
  const auto drawings = force_drawings(sides.scene, sides.run);
  EXPECT_NE(svg_of(drawings, "force").find("F_x"), std::string::npos);
  const std::string path = svg_of(drawings, "path");
  EXPECT_EQ(path.find("N_x"), std::string::npos);
  EXPECT_NE(path.find("N_z (up) | x of the tool [mm]: 16; force on the tool [N]: 4<"), std::string::npos);
  EXPECT_NE(svg_of(drawings, "friction-path").find("f_x | x of the tool [mm]: 16; force on the tool [N]: −1<"),
            std::string::npos);
  EXPECT_NE(svg_of(drawings, "depth").find("normal force [N]: 4<"), std::string::npos);
}

TEST(FastDrawings, FollowThePathAlongTheAxisTheToolTravels) {
  testing::Sides sides = with_regions("11111");
  for (std::size_t t = 0; t < 5; ++t) {
    sides.run.instants[t].depth_m = 0.002;
    sides.run.instants[t].tool.position_m = Vec3(0.0, -0.004 * static_cast<double>(t), 0.068);
  }
  EXPECT_NE(svg_of(force_drawings(sides.scene, sides.run), "path").find(">y of the tool [mm]</text>"),
            std::string::npos);
  EXPECT_THAT(instants_shown(sides.run), ElementsAre(4u, 2u, 0u));
  // While the depth grows this is no lateral motion.
  for (std::size_t t = 0; t < 4; ++t) sides.run.instants[t].depth_m = 0.0017;
  EXPECT_EQ(svg_of(force_drawings(sides.scene, sides.run), "path"), "");
  EXPECT_THAT(instants_shown(sides.run), ElementsAre(4u));
}

TEST(FastDrawings, HaveACurvePerRegion) {
  const testing::Sides sides = with_regions("0112332100112");
  const auto drawings = force_drawings(sides.scene, sides.run);
  for (const char* name : {"regions", "depth", "area"}) {
    const std::string svg = svg_of(drawings, name);
    for (const char* legend : {">region 0</text>", ">region 1</text>", ">region 2</text>"}) {
      EXPECT_EQ(count_of(svg, legend), 1u) << name << legend;
    }
    EXPECT_EQ(count_of(svg, ">region 3</text>"), 0u) << name;
    EXPECT_EQ(curves(svg), 3u) << name;
  }
  for (const char* legend : {">1 region</text>", ">2 regions</text>", ">3 regions</text>"}) {
    EXPECT_EQ(count_of(svg_of(drawings, "regions"), legend), 1u) << legend;
  }
  EXPECT_EQ(count_of(svg_of(drawings, "regions"), ">0 regions</text>"), 0u);
  EXPECT_EQ(svg_of(force_drawings(sides.scene, with_regions("01110").run), "regions"), "");
}

TEST(FastDrawings, ShowEachStageOfSeveralRegions) {
  testing::Sides sides = with_regions("0112222100");
  // The two are equal at the fifth instant, although the depth is larger later.
  sides.run.instants[4].regions[0].depth_m = sides.run.instants[4].regions[1].depth_m = 0.0012;
  EXPECT_THAT(instants_shown(sides.run), ElementsAre(2u, 4u, 7u));
  EXPECT_EQ(count_of(svg_of(shape_drawings(sides.scene, sides.run), "section"), "<g transform=\"translate("),
            3u + 3u * 3u)
      << "three panels with three names each";
}

/// Ticks along x of every panel of a drawing.
std::vector<std::string> x_ticks(const std::string& svg) {
  static const std::regex pattern("text-anchor=\"middle\" fill=\"currentColor\">([−0-9.]+)<");
  std::vector<std::string> panels;
  for (std::size_t at = svg.find("translate(0 0)"); at != std::string::npos;) {
    const std::size_t next = svg.find("</svg>\n</g>", at);
    const std::string panel = svg.substr(at, next - at);
    std::string ticks;
    for (std::sregex_iterator it(panel.begin(), panel.end(), pattern), end; it != end; ++it)
      ticks += (*it)[1].str() + " ";
    if (!ticks.empty()) panels.push_back(ticks);
    at = next == std::string::npos ? next : next + 1;
  }
  return panels;
}

TEST(FastDrawings, ShowSeveralRegionsAtOnePlaceAndATravellingToolWhereItIs) {
  testing::Sides sides = with_regions("0112222100");
  for (std::size_t t = 0; t < 10; ++t) sides.run.instants[t].tool.position_m.x() = t < 5 ? -0.005 : 0.005;
  const auto regions = x_ticks(svg_of(shape_drawings(sides.scene, sides.run), "contact"));
  ASSERT_EQ(regions.size(), 3u);
  EXPECT_EQ(regions[0], regions[1]);
  EXPECT_EQ(regions[0], regions[2]);
  sides = with_regions("11111");
  for (std::size_t t = 0; t < 5; ++t) {
    sides.run.instants[t].depth_m = 0.002;
    sides.run.instants[t].tool.position_m = Vec3(0.004 * static_cast<double>(t), 0.0, 0.068);
  }
  const auto places = x_ticks(svg_of(shape_drawings(sides.scene, sides.run), "contact"));
  ASSERT_EQ(places.size(), 3u);
  EXPECT_NE(places[0], places[1]);
  EXPECT_NE(places[1], places[2]);
}

TEST(FastDrawings, ShowNoMoreStagesThanAnyoneLooksAt) {
  const testing::Sides sides = with_regions("1212121212112222");
  const std::vector<std::size_t> shown = instants_shown(sides.run);
  EXPECT_EQ(shown.size(), 6u);
  EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  EXPECT_EQ(shown.back(), 15u);
}

TEST(FastDrawings, GiveSmallForcesInMillinewton) {
  testing::Sides sides = with_regions("11111");
  EXPECT_NE(svg_of(force_drawings(sides.scene, sides.run), "force").find("[N]: 1<"), std::string::npos);
  for (InstantRecord& record : sides.run.instants) record.regions[0].force_n = Vec3(0.0, 0.0, 0.002);
  const auto drawings = force_drawings(sides.scene, sides.run);
  EXPECT_NE(svg_of(drawings, "force").find("force on the tool [mN]: 2<"), std::string::npos);
  EXPECT_NE(svg_of(drawings, "depth").find("normal force [mN]: 2<"), std::string::npos);
}

TEST(FastDrawings, DrawTheDentAsDeepAsItIs) {
  testing::Sides sides = testing::pressed(3, 600);
  Eigen::Matrix3Xd& displacement_m = sides.run.instants[2].displacement_m;
  displacement_m.setZero();
  // A trough on one side; the bottom moves too, but is not the upper side.
  for (Eigen::Index i = 0; i < displacement_m.cols(); ++i) {
    if (sides.run.surface.points_m(0, i) < -0.001) displacement_m(2, i) = -0.003;
  }
  const std::string svg = svg_of(shape_drawings(sides.scene, sides.run), "dent");
  std::smatch path;
  ASSERT_TRUE(std::regex_search(svg, path, std::regex("<path d=\"M([0-9.]+) ([0-9.]+)L[^\"]*L([0-9.]+) ([0-9.]+)\"")));
  EXPECT_LT(std::stod(path[1]), std::stod(path[3]));
  EXPECT_GT(std::stod(path[2]), std::stod(path[4]) + 200.0) << "left is lower by most of the axis";
  EXPECT_EQ(curves(svg), 1u);
}

}  // namespace
}  // namespace touchstone::compare
