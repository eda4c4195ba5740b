// Reads a finished result folder of a command, for pages and windows.
#pragma once

#include "scene/output/figures.h"
#include "scene/output/results.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace touchstone::compare {

struct ResultFolder {
  std::filesystem::path folder;
  std::string command;               ///< of the manifest, such as "touchstone compare"
  std::string scene_hash;            ///< "" where the manifest has none
  std::string title;                 ///< of the scene, or its name; "" where the manifest has none
  std::string resolved_scene;        ///< TOML with every value in force
  std::string version;               ///< of the program, with its commit
  std::string date;                  ///< when it was made
  scene::Figures figures;            ///< summary.json; a number that was not finite is NaN
  std::vector<scene::Column> curve;  ///< curve.csv

  /// The figure of this key, or null.
  [[nodiscard]] const scene::Figure* figure(std::string_view key) const;
  /// The values of this column of the curve, one per instant, or null.
  [[nodiscard]] const std::vector<double>* column(std::string_view name) const;
  /// The same for a column that must be there. @throws scene::InputError that names the file
  [[nodiscard]] const std::vector<double>& required_column(std::string_view name) const;
};

/// Reads manifest.json, summary.json and curve.csv.
/// @throws scene::InputError with every file that is missing or damaged, and the line where it is
[[nodiscard]] ResultFolder read_result_folder(const std::filesystem::path& folder);

/// Reads what scene::write_summary wrote. A number that was not finite is NaN, with the reason as its text.
/// @throws scene::InputError when the file is missing or damaged, and the line where it is
[[nodiscard]] scene::Figures read_figures(const std::filesystem::path& file);

/// Reads what scene::write_csv wrote. @param file  for messages
/// @throws scene::InputError with the line that has another number of values than the head, or no number
[[nodiscard]] std::vector<scene::Column> parse_csv(std::string_view text, const std::filesystem::path& file);

}  // namespace touchstone::compare
