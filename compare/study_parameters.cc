#include "compare/study_parameters.h"

#include "compare/text.h"
#include "scene/error.h"
#include "scene/files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string_view>

namespace touchstone::compare {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// "3.5 mm" as 3.5 and "mm"; nothing for a text that does not begin with a number.
struct Quantity {
  double number = 0.0;
  std::string unit;
};
std::optional<Quantity> quantity_of(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Quantity out;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out.number);
  if (error != std::errc()) return std::nullopt;
  out.unit = std::string(end, text.data() + text.size());
  if (out.unit.starts_with(' ')) out.unit.erase(0, 1);
  const bool word = out.unit.find_first_of(" =,;0123456789") == std::string::npos;
  return word ? std::optional(out) : std::nullopt;
}

/// The numbers and the unit, where all values are numbers of one unit.
void read_numbers(StudyParameter& parameter) {
  std::optional<std::string> unit;
  std::vector<double> numbers;
  for (const std::string& value : parameter.values) {
    const std::optional<Quantity> one = value.empty() ? Quantity{no_number, unit.value_or("")} : quantity_of(value);
    if (!one || (!value.empty() && unit && *unit != one->unit)) return;
    if (!value.empty()) unit = one->unit;
    numbers.push_back(one->number);
  }
  parameter.numbers = std::move(numbers);
  parameter.unit = unit.value_or("");
  std::vector<std::string> rounded;
  for (const double number : parameter.numbers) rounded.push_back(std::isnan(number) ? "" : number_text(number, 4));
  // Rounded only where that leaves different values different.
  if (std::set(rounded.begin(), rounded.end()).size() ==
      std::set(parameter.values.begin(), parameter.values.end()).size()) {
    parameter.values = std::move(rounded);
  }
}

/// A value as TOML without the quotes of a text.
std::string words_of(const std::string& toml) {
  const bool quoted = toml.size() >= 2 && (toml.front() == '"' || toml.front() == '\'') && toml.back() == toml.front();
  return quoted ? toml.substr(1, toml.size() - 2) : toml;
}

std::string label_on(const ManifestCase& one, const std::string& axis) {
  for (const auto& [name, label] : one.along) {
    if (name == axis) return label;
  }
  return "";
}

/// What the case sets a key to, last; else what its scene has.
std::string value_of(const StudyManifest& manifest, const ManifestCase& one, const std::string& key) {
  for (auto setting = one.settings.rbegin(); setting != one.settings.rend(); ++setting) {
    if (setting->first == key) return words_of(setting->second);
  }
  const std::filesystem::path file = manifest.scene_file(one);
  const std::optional<std::string> text = scene::read_file(file);
  if (!text) throw scene::InputError({{file.string(), 0, 0, "cannot be read; expected the scene of " + one.name}});
  return words_of(scene::value_in(*text, file, key).value_or(""));
}

}  // namespace

std::vector<std::string> StudyParameter::distinct() const {
  std::vector<std::string> out;
  for (const std::string& value : values) {
    if (!value.empty() && std::find(out.begin(), out.end(), value) == out.end()) out.push_back(value);
  }
  return out;
}

std::vector<StudyParameter> study_parameters(const StudyManifest& manifest) {
  std::vector<StudyParameter> found;
  std::set<std::string> known;
  const auto add = [&](StudyParameter parameter) {
    known.insert(parameter.name);
    if (std::set<std::string>(parameter.values.begin(), parameter.values.end()).size() < 2) return;
    parameter.written = parameter.values;
    read_numbers(parameter);
    found.push_back(std::move(parameter));
  };
  std::set<std::string> beside;  // keys that cases beside the axes set
  std::vector<std::string> in_order;
  for (const ManifestCase& one : manifest.cases) {
    if (!one.along.empty()) continue;
    for (const auto& [key, value] : one.settings) {
      if (beside.insert(key).second) in_order.push_back(key);
    }
  }
  for (const std::string& axis : manifest.axes) {
    StudyParameter parameter{axis, "", {}, {}, {}};
    for (const ManifestCase& one : manifest.cases) {
      const bool is_key = axis.find('.') != std::string::npos;
      parameter.values.push_back(!one.along.empty() ? label_on(one, axis)
                                 : is_key           ? value_of(manifest, one, axis)
                                                    : "");
    }
    add(std::move(parameter));
  }
  for (const std::string& key : in_order) {
    if (known.contains(key)) continue;
    StudyParameter parameter{key, "", {}, {}, {}};
    for (const ManifestCase& one : manifest.cases) parameter.values.push_back(value_of(manifest, one, key));
    add(std::move(parameter));
  }
  return found;
}

}  // namespace touchstone::compare
