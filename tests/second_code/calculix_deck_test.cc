// The deck's text without CalculiX: equations of hanging nodes, the tool's surface elements, materials, refusals.
#include "reference/calculix/deck.h"
#include "reference/calculix/tool.h"
#include "reference/tool/tool_distance.h"
#include "second_code/pressed_scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <sstream>

namespace touchstone::second_code {
namespace {

using scene::Vec3;
using testing::HasSubstr;
using testing::Not;

/// Numbers of a deck's cards, line by line; commas and line ends count as space.
struct Cards {
  std::map<int, std::vector<double>> nodes;
  std::vector<std::vector<double>> equations;  ///< node, direction, weight, ...
  explicit Cards(const std::string& text) {
    std::istringstream lines(text);
    std::string card;
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("**", 0) == 0) continue;
      if (line[0] == '*') {
        card = line;
        if (card == "*EQUATION") {
          std::getline(lines, line);  // the number of terms
          equations.emplace_back();
        }
        continue;
      }
      std::replace(line.begin(), line.end(), ',', ' ');
      std::istringstream words(line);
      const std::vector<double> numbers{std::istream_iterator<double>(words), {}};
      if (card.rfind("*NODE, NSET=", 0) == 0)
        nodes[static_cast<int>(numbers[0])] = {numbers.begin() + 1, numbers.end()};
      if (card == "*EQUATION") equations.back().insert(equations.back().end(), numbers.begin(), numbers.end());
    }
  }
  /// Largest residual of the equations for a displacement that is the same function in every direction.
  [[nodiscard]] double largest_gap(const std::function<double(const std::vector<double>&)>& f) const {
    double largest = 0.0;
    for (const std::vector<double>& terms : equations) {
      double sum = 0.0;
      for (std::size_t k = 0; k < terms.size(); k += 3) sum += terms[k + 2] * f(nodes.at(static_cast<int>(terms[k])));
      largest = std::max(largest, std::abs(sum));
    }
    return largest;
  }
};

// In units of the body's size, so that every term counts.
TEST(Deck, SidesOfSmallerCellsFollowEveryQuadraticOfTheMeridianPlane) {
  const Cards cards(reference::calculix_deck(pressed(cylinder(0.3), 0.003, 1), {.level = 0}).text);
  ASSERT_GT(cards.equations.size(), 20u);
  const auto f = [](const std::vector<double>& x_m) {
    const double r = x_m[0] / 0.05, z = x_m[1] / 0.05;
    return 1.0 + r - 2.0 * z + 3.0 * r * z + r * r - 2.0 * z * z;
  };
  EXPECT_LT(cards.largest_gap(f), 1e-4);  // the bore at the axis
  const auto cubic = [](const std::vector<double>& x_m) { return std::pow(x_m[0] / 0.05, 3); };
  EXPECT_GT(cards.largest_gap(cubic), 1e-4);
}

TEST(Deck, SidesOfSmallerCellsFollowEverySerendipityPolynomialInSpace) {
  const Cards cards(reference::calculix_deck(pressed(block(0.3), 0.004, 1), {.level = 0}).text);
  ASSERT_GT(cards.equations.size(), 100u);
  const auto f = [](const std::vector<double>& x_m) {
    const double x = x_m[0] / 0.03, y = x_m[1] / 0.03, z = x_m[2] / 0.06;
    return 1.0 + x - 2.0 * y + 3.0 * z + x * y - 2.0 * y * z + 3.0 * z * x + x * x - 2.0 * y * y + 3.0 * z * z +
           4.0 * x * y * z + 5.0 * x * x * y - x * y * y + 2.0 * y * y * z - 3.0 * y * z * z + x * z * z +
           6.0 * x * x * z;
  };
  EXPECT_LT(cards.largest_gap(f), 1e-9);
  const auto beyond = [](const std::vector<double>& x_m) { return std::pow(x_m[0] * x_m[1] / 9e-4, 2); };
  EXPECT_GT(cards.largest_gap(beyond), 1e-4);
}

TEST(Deck, NoEquationHasATermThatIsTied) {
  const Cards cards(reference::calculix_deck(pressed(block(0.3), 0.004, 1), {.level = 1}).text);
  std::set<double> tied;
  for (const auto& terms : cards.equations) tied.insert(terms[0]);
  for (const auto& terms : cards.equations) {
    for (std::size_t k = 3; k < terms.size(); k += 3) ASSERT_FALSE(tied.contains(terms[k])) << terms[k];
  }
}

scene::Tool tool(scene::ToolShape shape) {
  scene::Tool tool;
  tool.shape = shape;
  tool.radius_m = 0.006;
  tool.length_m = 0.03;
  tool.edge_radius_m = 0.002;
  tool.size_m = {0.012, 0.01, 0.014};
  tool.mass_center_m = Vec3(0.0, 0.0, 0.004);
  return tool;
}

reference::ModelChoice choice_for(const scene::Tool& tool) {
  reference::ModelChoice choice;
  choice.tool = reference::tool_distance(tool);
  choice.half_width_m = 0.004;
  return choice;
}

class Coat : public testing::TestWithParam<scene::ToolShape> {};

TEST_P(Coat, LiesOnTheToolOutsideAndInItInside) {
  const scene::Tool one = tool(GetParam());
  const reference::ModelChoice choice = choice_for(one);
  const auto coat = reference::surface_coat(one, choice, [](const Vec3&) { return true; });
  double volume_m3 = 0.0;
  for (const auto& element : coat.elements) {
    const auto place_m = [&](int k) { return Vec3(coat.points_m.col(element[k])); };
    for (const int k : {3, 4, 5, 9, 10, 11}) ASSERT_NEAR(choice.tool->at(place_m(k)).value_m, 0.0, 1e-8);
    const Vec3 normal = (place_m(4) - place_m(3)).cross(place_m(5) - place_m(3)).normalized();
    for (int k = 0; k < 3; ++k) {
      ASSERT_GT((place_m(3 + k) - place_m(k)).dot(normal), 1e-6);
      ASSERT_GT(choice.tool->at(place_m(3 + k)).gradient.dot(normal), 0.5);
      ASSERT_LT((place_m(12 + k) - 0.5 * (place_m(k) + place_m(3 + k))).norm(), 1e-12);
      ASSERT_LT((place_m(6 + k) + place_m(3 + k) - place_m(k) - place_m(9 + k)).norm(), 1e-12);
    }
    volume_m3 += place_m(3).cross(place_m(4)).dot(place_m(5)) / 6.0;
  }
  // Closed: its corners enclose the tool.
  EXPECT_NEAR(volume_m3 / scene::tool_shape(one)->volume_m3(), 1.0, GetParam() == scene::ToolShape::box ? 0.05 : 0.02);
}
INSTANTIATE_TEST_SUITE_P(Shapes, Coat,
                         testing::Values(scene::ToolShape::sphere, scene::ToolShape::capsule,
                                         scene::ToolShape::cylinder, scene::ToolShape::box));

class MeridianCoat : public testing::TestWithParam<scene::ToolShape> {};

TEST_P(MeridianCoat, LiesOnTheToolWhicheverWayItStands) {
  const scene::Tool one = tool(GetParam());
  const reference::ModelChoice choice = choice_for(one);
  for (const double angle : {0.0, 3.141592653589793}) {
    const Eigen::Quaterniond orientation(Eigen::AngleAxisd(angle, Vec3::UnitX()));
    const auto coat = reference::meridian_coat(one, orientation, choice);
    const auto distance_m = [&](int node) {
      const Eigen::Vector2d place_m = coat.points_m.col(node);
      return choice.tool->at(orientation.conjugate() * Vec3(place_m.x(), 0.0, place_m.y())).value_m;
    };
    for (const auto& element : coat.elements) {
      for (const int k : {0, 1, 4}) ASSERT_NEAR(distance_m(element[k]), 0.0, 1e-12);
      for (const int k : {2, 3, 6}) ASSERT_LT(distance_m(element[k]), -1e-4);
      double area_m2 = 0.0;
      for (int k = 0; k < 4; ++k) {
        const Eigen::Vector2d a = coat.points_m.col(element[k]), b = coat.points_m.col(element[(k + 1) % 4]);
        area_m2 += 0.5 * (a.x() * b.y() - a.y() * b.x());
      }
      ASSERT_GT(area_m2, 0.0);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Shapes, MeridianCoat,
                         testing::Values(scene::ToolShape::sphere, scene::ToolShape::capsule,
                                         scene::ToolShape::cylinder));

TEST(Deck, SaysTheMaterialTheFrictionAndTheSteps) {
  scene::Scene scene = pressed(ball(0.3), 0.004, 2);
  const reference::Deck finite = reference::calculix_deck(scene, {});
  EXPECT_TRUE(finite.axisymmetric);
  EXPECT_THAT(finite.instants, testing::ElementsAre(2, 3));
  EXPECT_THAT(finite.text, HasSubstr("*HYPERELASTIC, NEO HOOKE\n576923.076923, 8e-07\n"));
  EXPECT_THAT(finite.text, HasSubstr("NLGEOM"));
  EXPECT_THAT(finite.text, Not(HasSubstr("*FRICTION")));
  EXPECT_THAT(finite.text, HasSubstr("minus 180 times"));
  scene.reference.kinematics = scene::Kinematics::small;
  scene.contact.friction = scene::Friction{1.0, 0.75, 0.4};
  const reference::Deck small = reference::calculix_deck(scene, {.contact_stiffness_pa_per_m = 2e11});
  EXPECT_THAT(small.text, HasSubstr("*ELASTIC\n3000000, 0.3\n"));
  EXPECT_THAT(small.text, Not(HasSubstr("NLGEOM")));
  EXPECT_THAT(small.text, HasSubstr("PRESSURE-OVERCLOSURE=LINEAR\n200000000000\n*FRICTION\n0.4, "));
}

TEST(Deck, AnInclusionsElementsAreOfItsMaterial) {
  scene::Scene scene = pressed(ball(0.49), 0.004, 1);
  scene::Inclusion inclusion;
  inclusion.shape = scene::BodyShape::sphere;
  inclusion.radius_m = 0.008;
  inclusion.center_m = {0.0, 0.0, 0.04};
  inclusion.material = {30e3, 0.33};
  scene.body.inclusions = {inclusion};
  EXPECT_THAT(reference::calculix_deck(scene, {}).text,
              HasSubstr("*SOLID SECTION, ELSET=OF_INCLUSION_1, MATERIAL=OF_INCLUSION_1"));
  scene.body.inclusions[0].material.poissons_ratio = 0.495;
  const auto faults = reference::unsupported_in_deck(scene);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_THAT(faults[0].message, HasSubstr("body.inclusion[0].material.poissons_ratio"));
}

TEST(Deck, RefusesTheIncompressibleAndTheUntouched) {
  const auto message = [](const scene::Scene& scene) {
    try {
      (void)reference::calculix_deck(scene, {});
    } catch (const scene::InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(message(pressed(ball(0.5), 0.004, 1)),
              HasSubstr("body.material.poissons_ratio: CalculiX needs a finite bulk modulus; expected at most 0.49"));
  scene::Scene apart = pressed(ball(0.3), 0.004, 1);
  apart.track.back() = apart.track.front();
  apart.track.back().time_s = 1.0;
  EXPECT_THAT(message(apart), HasSubstr("never touches"));
}

}  // namespace
}  // namespace touchstone::second_code
