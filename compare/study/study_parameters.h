// What varies from case to case in a study: its axes, and the keys that cases beside the axes set.
#pragma once

#include "compare/study/study.h"

#include <string>
#include <vector>

namespace touchstone::compare {

/// One thing that varies, with its value in every case, in the study's order.
struct StudyParameter {
  std::string name;                  ///< the axis, or the key
  std::string unit;                  ///< what every label ends in, such as "mm"; may be empty
  std::vector<std::string> values;   ///< as people write them; empty where a case has no place on the axis
  std::vector<std::string> written;  ///< the same to the last digit, as the study or the scene writes them
  std::vector<double> numbers;       ///< the same where all values are numbers, NaN for an empty one; empty otherwise
  bool axis = false;                 ///< of the study, not a key that cases beside the axes set
  std::string shown;                 ///< the name, of a key its last part where that is clear

  [[nodiscard]] bool numeric() const noexcept { return !numbers.empty(); }
  /// With its unit, for an axis of a plot or the head of a column.
  [[nodiscard]] std::string label() const { return unit.empty() ? shown : shown + " [" + unit + "]"; }
  /// Every value once, in the order of the cases; empty ones left out.
  [[nodiscard]] std::vector<std::string> distinct() const;
};

/// The axes first. What has the same value in every case is left out. A key that a case does not set has the value of
/// its scene.
/// @throws scene::InputError when a case's scene file cannot be read
[[nodiscard]] std::vector<StudyParameter> study_parameters(const StudyManifest& manifest);

}  // namespace touchstone::compare
