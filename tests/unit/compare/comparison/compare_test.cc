#include "compare/comparison/compare.h"

#include "support/spring.h"
#include "support/synthetic.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace touchstone::compare {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> parts;
  std::istringstream in(line);
  for (std::string part; std::getline(in, part, ',');) parts.push_back(part);
  return parts;
}

class WriteComparison : public ::testing::Test {
 protected:
  WriteComparison() {
    comparison_ = write_comparison(folder_.path(), sides_.scene, sides_.run, sides_.result, sides_.manifest, models_,
                                   sides_.call);
  }
  static Contenders with_springs(const scene::Scene& scene) {
    Contenders out = contenders(scene);
    std::erase_if(out.models, [](const ModelEntry& entry) { return entry.family == ModelFamily::response; });
    for (ModelEntry& entry : testing::springs({.scene = scene})) out.models.push_back(std::move(entry));
    return out;
  }

  testing::Sides sides_ = testing::pressed(4, 200);
  Contenders models_ = with_springs(sides_.scene);
  testing::TemporaryFolder folder_;
  Comparison comparison_;
};

TEST_F(WriteComparison, FillsTheFolderAndNothingElse) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    names.push_back(entry.path().filename());
    EXPECT_GT(entry.file_size(), 0u) << names.back();
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"area-aware.toml", "curve.csv", "manifest.json", "report.html",
                                             "shape.svg", "summary.json", "surface.pvd", "surface_0000.vtp",
                                             "surface_0001.vtp", "surface_0002.vtp", "surface_0003.vtp", "tool.pvd",
                                             "tool_0000.vtp", "tool_0001.vtp", "tool_0002.vtp", "tool_0003.vtp"}));
}

TEST_F(WriteComparison, CurveHasOneRowPerInstantAndBothSides) {
  std::ifstream in(folder_.path() / "curve.csv");
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> head = split(line);
  for (const char* name : {"time_s",
                           "tool_z_m",
                           "depth_m",
                           "fast_region0_force_z_n",
                           "reference_region0_force_z_n",
                           "fast_force_n",
                           "reference_force_n",
                           "reference_force_uncertainty_n",
                           "error_force_n",
                           "error_force_rel",
                           "error_shape_rel_l2",
                           "reference_shape_uncertainty_rel_l2",
                           "error_shape_max_m",
                           "error_hausdorff_m",
                           "contact_area_iou",
                           "fast_volume_change_rel",
                           "reference_volume_change_rel",
                           "reference_residual_penetration_m",
                           "reference_between_nodes_penetration_m",
                           "reference_equilibrium_rel"}) {
    EXPECT_EQ(std::count(head.begin(), head.end(), name), 1) << name;
  }
  const auto at = [&](const char* name) {
    return static_cast<std::size_t>(std::find(head.begin(), head.end(), name) - head.begin());
  };
  std::size_t rows = 0;
  for (; std::getline(in, line); ++rows) {
    const std::vector<std::string> values = split(line);
    ASSERT_EQ(values.size(), head.size());
    const double fast_n = sides_.run.instants[rows].force_n().norm();
    const double reference_n = sides_.result.instants[rows].force_n().norm();
    EXPECT_EQ(std::stod(values[at("fast_force_n")]), fast_n);
    EXPECT_EQ(std::stod(values[at("reference_force_n")]), reference_n);
    EXPECT_EQ(std::stod(values[at("reference_force_uncertainty_n")]), sides_.result.instants[rows].force_uncertainty_n);
    EXPECT_NEAR(std::stod(values[at("error_force_n")]), std::abs(fast_n - reference_n), 1e-12);
    EXPECT_EQ(std::stod(values[at("reference_volume_change_rel")]), sides_.result.instants[rows].volume_change_rel);
  }
  EXPECT_EQ(rows, 4u);
}

TEST_F(WriteComparison, JudgesTheOtherModelsToo) {
  std::ifstream in(folder_.path() / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(in);
  for (const char* model : {"paper", "area_aware", "scene"}) {
    const std::string key = std::string("model.") + model + ".force.nrmse";
    ASSERT_TRUE(summary.contains(key));
    EXPECT_GT(summary.at(key).get<double>(), 0.0);
  }
  EXPECT_EQ(summary.at("model.scene.force.nrmse"), summary.at("force.nrmse")) << "the scene's own model";
  EXPECT_EQ(summary.at("model.spring.shape.rel_l2").get<double>(), 1.0) << "one that nobody here knows";
  EXPECT_GT(summary.at("model.spring.force.nrmse").get<double>(), 0.0);
  EXPECT_EQ(summary.at("reasons").at("model.broken.force.nrmse").get<std::string>(), "absent: it broke");
  EXPECT_NE(comparison_.text.find("area-aware, corrected"), std::string::npos) << comparison_.text;
  std::ifstream page(folder_.path() / "report.html");
  const std::string html{std::istreambuf_iterator<char>(page), {}};
  EXPECT_NE(html.find("<td>area-aware, corrected</td>"), std::string::npos);
}

TEST_F(WriteComparison, SummaryIsFlatWithAUnitForEveryKey) {
  std::ifstream in(folder_.path() / "summary.json");
  const nlohmann::json summary = nlohmann::json::parse(in);
  ASSERT_EQ(summary.size(), comparison_.figures.size() + 2) << "units and reasons";
  ASSERT_EQ(summary.at("units").size(), comparison_.figures.size());
  for (const scene::Figure& figure : comparison_.figures) {
    const nlohmann::json& value = summary.at(figure.key);
    if (figure.text.empty()) {
      EXPECT_EQ(value.get<double>(), figure.number) << figure.key;
    } else if (std::isnan(figure.number)) {
      EXPECT_TRUE(value.is_null()) << figure.key;
      EXPECT_EQ(summary.at("reasons").at(figure.key).get<std::string>(), figure.text) << figure.key;
    } else {
      EXPECT_EQ(value.get<std::string>(), figure.text) << figure.key;
    }
    EXPECT_EQ(summary.at("units").at(figure.key).get<std::string>(), figure.unit) << figure.key;
  }
}

TEST_F(WriteComparison, TellsTheVerdictInPlainText) {
  EXPECT_TRUE(comparison_.text.starts_with("The fast model's force at the deepest instant")) << comparison_.text;
  EXPECT_NE(comparison_.text.find("\n  touchstone compare meshes/scenes/ball-on-cube-press.toml"), std::string::npos)
      << comparison_.text;
}

}  // namespace
}  // namespace touchstone::compare
