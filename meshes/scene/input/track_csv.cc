#include "scene/input/track_csv.h"

#include "scene/base/csv.h"
#include "scene/base/text.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

namespace touchstone::scene {
namespace {

constexpr std::array<std::string_view, 9> column_names = {"time_s", "x_m", "y_m", "z_m",    "qw",
                                                          "qx",     "qy",  "qz",  "depth_m"};
constexpr std::size_t height_column = 3, depth_column = 8, orientation_column = 4;
constexpr std::string_view expected_header =
    "time_s,x_m,y_m,z_m, or depth_m in place of z_m, with or without ,qw,qx,qy,qz";

/// The key of a [[track]] row that holds a column's numbers.
const Field<TrackRow>& field_of(std::size_t column) {
  return track_field(column == 0                   ? "time_s"
                     : column == depth_column      ? "depth_m"
                     : column < orientation_column ? "position_m"
                                                   : "orientation_wxyz");
}

std::string_view without_blanks(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  return text.substr(0, text.find_last_not_of(" \t") + 1);
}

}  // namespace

std::vector<TrackRow> read_track_csv(std::string_view text, const std::string& name, std::vector<Fault>& faults,
                                     std::vector<int>& lines) {
  std::vector<TrackRow> track;
  std::array<Range, column_names.size()> ranges;
  for (std::size_t i = 0; i < ranges.size(); ++i) ranges[i] = field_of(i).range;
  std::vector<std::size_t> meaning;  // per column: index into column_names
  for (CsvRows rows(text); rows.next();) {
    if (rows.text().empty() || rows.text().starts_with('#')) continue;
    const int number = rows.line();
    std::vector<std::string_view> cells = rows.cells();
    for (std::string_view& cell : cells) cell = without_blanks(cell);
    if (meaning.empty()) {
      for (const std::string_view cell : cells) {
        const auto found = std::find(column_names.begin(), column_names.end(), cell);
        const auto index = static_cast<std::size_t>(found - column_names.begin());
        if (found == column_names.end() || std::find(meaning.begin(), meaning.end(), index) != meaning.end()) {
          faults.push_back(
              {name, number, rows.column(cell),
               "unknown or repeated column " + name_or_nothing(cell) + "; expected " + std::string(expected_header)});
          return track;
        }
        meaning.push_back(index);
      }
      const auto has = [&](std::size_t column) { return std::ranges::find(meaning, column) != meaning.end(); };
      const auto refuse = [&](const std::string& what) {
        faults.push_back({name, number, 1, what + "; expected " + std::string(expected_header)});
        return track;
      };
      if (has(height_column) && has(depth_column)) return refuse("the header has both z_m and depth_m");
      if (meaning.size() != 4 && meaning.size() != 8) return refuse("the header misses columns");
      if (!has(0) || !has(1) || !has(2) || !(has(height_column) || has(depth_column)))
        return refuse("the header misses time or position");
      continue;
    }
    if (cells.size() != meaning.size()) {
      faults.push_back(
          {name, number, 1,
           "expected " + std::to_string(meaning.size()) + " values, found " + std::to_string(cells.size())});
      continue;
    }
    std::array<double, 9> value = {0, 0, 0, 0, 1, 0, 0, 0, 0};
    bool good = true;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::optional<double> one = parsed<double>(cells[i]);
      value[meaning[i]] = one.value_or(0.0);
      if (!one || !ranges[meaning[i]].contains(*one)) {
        const std::string_view unit = field_of(meaning[i]).unit;
        faults.push_back({name, number, rows.column(cells[i]),
                          "\"" + shortened(cells[i], 40) + "\" for " + std::string(column_names[meaning[i]]) +
                              "; expected a number in " + ranges[meaning[i]].text() +
                              (unit.empty() ? "" : " " + std::string(unit))});
        good = false;
      }
    }
    if (!good) continue;
    const auto orientation = orientation_of(Eigen::Quaterniond(value[4], value[5], value[6], value[7]));
    if (!orientation) {
      faults.push_back({name, number, 1, "qw, qx, qy, qz; expected " + expected_text(field_of(orientation_column))});
      continue;
    }
    const bool by_depth = std::ranges::find(meaning, depth_column) != meaning.end();
    track.push_back({.time_s = value[0],
                     .position = {Vec3(value[1], value[2], value[3]), by_depth},
                     .depth_m = by_depth ? std::optional(value[depth_column]) : std::nullopt,
                     .direction = {},
                     .orientation = *orientation});
    lines.push_back(number);
  }
  if (meaning.empty()) faults.push_back({name, 0, 0, "the track is empty; expected " + std::string(expected_header)});
  return track;
}

}  // namespace touchstone::scene
