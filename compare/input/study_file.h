// Study files: one scene and the values to vary in it, as a list of independent cases. TOML:
//
//   title = "Depth and place"
//   scene = "../scenes/ball-on-cube-press.toml"   # relative to the study file
//   run   = "compare"                             # fast | reference | compare
//
//   [set]                                         # in every case; keys as for --set
//   reference.levels = 3
//
//   [[axis]]                                      # every value of an axis with every one of the others
//   key    = "body.material.poissons_ratio"
//   values = [0.3, 0.45, 0.5]
//
//   [[axis]]
//   key   = "body.material.youngs_modulus_pa"
//   range = { from = 1.0e5, to = 1.0e7, count = 3, spacing = "log" }
//
//   [[axis]]                                      # keys that change together
//   name   = "place"
//   zip    = { "track[0].position_m[0]" = [0.0, 0.01], "track[1].position_m[0]" = [0.0, 0.01] }
//   labels = ["middle", "10 mm off"]
//
//   [[case]]                                      # one more, beside the axes
//   name = "stiff"
//   set  = { body.material.youngs_modulus_pa = 1.0e9 }
#pragma once

#include "scene/base/error.h"
#include "scene/input/toml_reader.h"
#include "scene/model/scene.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace touchstone::compare {

struct StudyCase {
  std::string name;  ///< "place = middle, depth = 2 mm", or a case's own
  /// Axis and label of its value there, one for every axis; empty for a case beside the axes.
  std::vector<std::pair<std::string, std::string>> along;
  std::vector<scene::Setting> settings;  ///< applied in this order
};

struct Study {
  std::string name;  ///< file stem
  std::string title;
  std::filesystem::path scene_file;
  std::string run;  ///< "fast", "reference" or "compare"
  std::vector<std::string> axes;
  std::vector<StudyCase> cases;  ///< the last axis changes fastest, cases beside the axes at the end
};

inline constexpr std::size_t study_cases_max = 100'000;

/// @throws InputError with every fault of the file, each with line, column and what was expected
[[nodiscard]] Study load_study(const std::filesystem::path& file);

/// The value, as TOML, at a key of a scene file's text, spelt as for --set; nothing where it has none.
/// @param file  for messages. @throws InputError when the text is no TOML
[[nodiscard]] std::optional<std::string> value_in(std::string_view text, const std::filesystem::path& file,
                                                  const std::string& key);

/// The scene of every case.
/// @param check  more faults of one scene, such as what a solver cannot do; may be empty
/// @throws InputError with the faults of all cases, each once, where the study gives the value and with the first case
///         it occurs in
[[nodiscard]] std::vector<scene::Scene> load_cases(
    const Study& study, const std::function<std::vector<scene::Fault>(const scene::Scene&)>& check = {});

}  // namespace touchstone::compare
