// The paper's experiments, Figs. 13 to 18: the shipped scenes run by the real-time model, in both formulations.
#pragma once

#include "fast/run/run.h"
#include "support/shipped_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace touchstone::test {

/// Parameter: the formulation.
class Experiment : public testing::TestWithParam<scene::Formulation> {
 protected:
  [[nodiscard]] static bool published() { return GetParam() == scene::Formulation::published; }
  [[nodiscard]] static scene::Scene scene(const std::string& name) { return shipped_scene(name, GetParam()); }
  /// The instants at which the tool presses on the body.
  [[nodiscard]] static std::vector<scene::InstantRecord> in_contact(const scene::Scene& scene) {
    std::vector<scene::InstantRecord> instants = fast::run(scene).instants;
    // First touch, whose depth is round-off, is not included.
    std::erase_if(instants, [](const scene::InstantRecord& instant) { return instant.depth_m < 1e-12; });
    return instants;
  }
  /// Writes a number for reports/experiments.md to the file of --gtest_output.
  static void record(const std::string& name, double number) { RecordProperty(name, std::to_string(number)); }
};

inline std::string formulation_name(const testing::TestParamInfo<scene::Formulation>& info) {
  return info.param == scene::Formulation::published ? "published" : "corrected";
}

inline const auto both_formulations = testing::Values(scene::Formulation::published, scene::Formulation::corrected);

}  // namespace touchstone::test
